//! Closes faces that are too small or too thin to hold elements.

use crate::cleanup::changes::Reason;
use crate::cleanup::graph::Graph;
use crate::cleanup::measure::distance;
use crate::cleanup::measure::to_segment;
use crate::cleanup::separate::gap_m;
use crate::cleanup::separate::join;
use crate::cleanup::separate::unite;
use crate::cleanup::steps::Step;
use crate::cleanup::wedges::angle_deg;
use crate::geometry::predicates::by_angle;
use crate::geometry::predicates::orient;

/// Which faces are closed, in shares of the local mesh size.
#[derive(Clone, Copy, Debug)]
pub(super) struct Thin {
    /// Faces whose 2 x area / perimeter is below this: the width of a strip, the inscribed radius
    /// of a round face.
    pub(super) width: f64,
    /// The same for triangles: the least that they can be meshed with is three quads and six sides.
    pub(super) triangle: f64,
    /// A line moves at most this far to close one.
    pub(super) reach: f64,
    /// How much of the tolerance may be used.
    pub(super) share: f64,
    /// May a small loop go that could not be closed?
    pub(super) drops_loops: bool,
}

/// A face's outer walk and how thin it is.
struct Face {
    width: f64,
    is_triangle: bool,
    /// Half-edges: edge and first node.
    walk: Vec<(u32, u32)>,
}

/// Faces with more edges than this are not thin in the sense of one place to close.
const WALK_MAX: usize = 64;

/// Triangles with more edges than this have their six sides anyway.
const SIX: usize = 6;

/// A turn by more than this is a corner.
const CORNER_DEG: f64 = 30.0;

/// Loops with a perimeter above this many mesh sizes are not small.
const LOOP_MAX: f64 = 4.0;

/// Closes thin faces at `nodes`, the thinnest first, one step a face.
pub(super) fn collapse_thin(graph: &mut Graph, thin: &Thin, nodes: &[u32]) {
    if !graph.measure.does(Step::Collapse) {
        return;
    }
    let mut faces = thin_faces(graph, thin, nodes);
    faces.sort_by(|a, b| {
        let place = |face: &Face| graph.point(face.walk[0].1);
        (a.width.total_cmp(&b.width)).then_with(|| place(a).cmp(&place(b)))
    });
    for face in faces {
        let is_there = (face.walk.iter()).all(|&(edge, _)| graph.edges[edge as usize].alive);
        if !is_there || (face.is_triangle && dissolve(graph, thin, &face)) {
            continue;
        }
        if face.width < thin.width && !close(graph, thin, &face) && thin.drops_loops {
            drop_loop(graph, &face);
        }
    }
}

/// All bounded faces inside the domain at `nodes` that are thin.
fn thin_faces(graph: &Graph, thin: &Thin, nodes: &[u32]) -> Vec<Face> {
    let mut seen = vec![[false; 2]; graph.edges.len()];
    let mut faces = Vec::new();
    let mut way = Vec::with_capacity(WALK_MAX);
    for &node in nodes {
        for &edge in &graph.star[node as usize] {
            let side = graph.edges[edge as usize].end_at(node);
            if !seen[edge as usize][side] {
                faces.extend(walk(graph, &mut seen, (edge, side), thin, &mut way));
            }
        }
    }
    faces
}

/// The face on the left of an edge, from one of its ends on, if it is thin. `walk`: scratch.
fn walk(
    graph: &Graph,
    seen: &mut [[bool; 2]],
    start: (u32, usize),
    thin: &Thin,
    walk: &mut Vec<(u32, u32)>,
) -> Option<Face> {
    let (mut edge, mut side) = start;
    // exact: the walk around a free line has no area, and is no face
    let (mut area_cells2, mut length, mut size) = (0_i128, 0.0, f64::INFINITY);
    walk.clear();
    if !graph.edges[edge as usize].inside[side] {
        return None;
    }
    let origin = graph.point(graph.edges[edge as usize].ends[side]);
    while !seen[edge as usize][side] {
        if walk.len() == WALK_MAX {
            return None;
        }
        seen[edge as usize][side] = true;
        let it = &graph.edges[edge as usize];
        let (a, b) = (it.ends[side], it.ends[1 - side]);
        area_cells2 += i128::from(orient(origin, graph.point(a), graph.point(b)));
        length += distance(graph.metres(a), graph.metres(b));
        size = size.min(it.size_m);
        walk.push((edge, it.ends[side]));
        let (leaves, at) = (leaving(graph, edge, it.ends[1 - side]), it.ends[1 - side]);
        side = graph.edges[leaves as usize].end_at(at);
        edge = leaves;
    }
    // else it came into a face that is too long
    let is_whole = (edge, side) == start;
    if !is_whole || area_cells2 <= 0 || !walk.iter().all(|&(edge, _)| graph.may_change(edge)) {
        return None;
    }
    let cell_m = graph.measure.grid().cell_m;
    let width = area_cells2 as f64 * cell_m * cell_m / length / size;
    let is_triangle =
        width < thin.triangle && walk.len() <= SIX && corners(graph, walk, CORNER_DEG) == 3;
    (is_triangle || width < thin.width).then_some(Face {
        width,
        is_triangle,
        walk: walk.clone(),
    })
}

/// The edge on which the walk of a face on the left goes on, having come to `node` along `edge`:
/// the next one clockwise.
pub(super) fn leaving(graph: &Graph, edge: u32, node: u32) -> u32 {
    if let [e, f] = graph.star[node as usize][..] {
        return if e == edge { f } else { e };
    }
    let turn = |e: u32, f: u32| by_angle(graph.heading(node, e), graph.heading(node, f));
    // the last before it, or the last of all
    let others = (graph.star[node as usize].iter().copied()).filter(|&it| it != edge);
    let next = others.max_by(|&e, &f| {
        let is_before = |it: u32| turn(it, edge).is_lt();
        is_before(e).cmp(&is_before(f)).then_with(|| turn(e, f))
    });
    next.unwrap_or(edge)
}

/// How many corners a walk has where it turns left, by more than this.
pub(super) fn corners(graph: &Graph, walk: &[(u32, u32)], above_deg: f64) -> usize {
    let n = walk.len();
    let node = |k: usize| walk[k % n].1;
    (0..n)
        .filter(|&k| {
            let (a, o, b) = (node(k + n - 1), node(k), node(k + 1));
            let turns_left = orient(graph.point(a), graph.point(o), graph.point(b)) > 0;
            turns_left && 180.0 - angle_deg(graph, o, a, b) > above_deg
        })
        .count()
}

/// Makes a triangle a line: contracts a side, or lays a corner on the side opposite, whatever moves
/// the lines least.
fn dissolve(graph: &mut Graph, thin: &Thin, face: &Face) -> bool {
    let mut ways = Vec::new();
    for &(edge, node) in &face.walk {
        let (a, b) = graph.ends_m(edge);
        ways.push((distance(a, b), node, edge));
        for &(_, corner) in &face.walk {
            ways.extend(gap_m(graph, corner, edge).map(|gap| (gap, corner, edge)));
        }
    }
    ways.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    ways.iter().any(|&(_, node, edge)| {
        let it = &graph.edges[edge as usize];
        if it.ends.contains(&node) {
            let other = it.other(node);
            unite(graph, node, other, thin.share, "dissolved").is_some()
        } else {
            join(graph, node, edge, 0.25, thin.share).is_some()
        }
    })
}

/// Joins the node and the edge of the face that are nearest to each other.
fn close(graph: &mut Graph, thin: &Thin, face: &Face) -> bool {
    let mut pairs = Vec::new();
    for &(_, node) in &face.walk {
        for &(edge, _) in &face.walk {
            let size = graph.edges[edge as usize].size_m;
            if let Some(gap) = gap_m(graph, node, edge).filter(|&gap| gap < thin.reach * size) {
                let (a, b) = graph.ends_m(edge);
                // prefers a foot in the middle of the edge to one at its end
                let t = to_segment(graph.metres(node), a, b).1;
                let aside = (t - 0.5).abs() * 0.1 * size;
                pairs.push((gap + aside, node, edge));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    pairs
        .iter()
        .any(|&(_, node, edge)| join(graph, node, edge, 0.25, thin.share).is_some())
}

/// Drops a loop that hangs on at most one junction.
fn drop_loop(graph: &mut Graph, face: &Face) -> bool {
    let junctions = face
        .walk
        .iter()
        .filter(|&&(_, node)| graph.degree(node) > 2)
        .count();
    let is_free =
        (face.walk.iter()).all(|&(edge, _)| graph.edges[edge as usize].inside == [true; 2]);
    let is_kept = (face.walk.iter())
        .flat_map(|&(edge, _)| &graph.pieces[edge as usize])
        .any(|piece| graph.measure.keeps_loops(piece.line));
    let length: f64 = (face.walk.iter())
        .map(|&(edge, _)| graph.ends_m(edge))
        .map(|(a, b)| distance(a, b))
        .sum();
    let size = graph.edges[face.walk[0].0 as usize].size_m;
    if junctions > 1 || !is_free || is_kept || length > LOOP_MAX * size {
        return false;
    }
    let at = graph.point(face.walk[0].1);
    for &(edge, _) in &face.walk {
        if graph.is_there(edge) {
            graph.delete(edge, Reason::SmallLoop);
        }
    }
    graph.note("dropped-loop", at, 0.0);
    true
}
