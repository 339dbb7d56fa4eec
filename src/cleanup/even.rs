//! Makes small faces with an odd number of edges even, and small triangles four-sided.
//!
//! Each edge is one element side at least, so a face with five short edges gets six sides from parity, and
//! three quads where there is room for one; and its neighbour gets a side more too. So one of its edges
//! is contracted, where that harms nothing: on the other side lies another odd face, which becomes even
//! as well, or a large one, in which an edge more or less is a small matter, or the outside. A small triangle, which
//! would be three quads too, gets a fourth corner: the middle of a side moves out.
//!
//! A face is even or odd by its outer walk: holes and free lines inside are even, and small faces have none.

use smallvec::SmallVec;

use crate::cleanup::collapse::corners;
use crate::cleanup::collapse::leaving;
use crate::cleanup::graph::Graph;
use crate::cleanup::importance::is_rim_corner;
use crate::cleanup::measure::between_deg;
use crate::cleanup::measure::distance;
use crate::cleanup::measure::to_segment;
use crate::cleanup::operate::Bend;
use crate::cleanup::sharp::gaps_deg;
use crate::cleanup::steps::Step;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::geometry::quad::cross;
use crate::geometry::quad::measure;

/// Which faces are made even. Lengths in mesh sizes, along a face the least one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Even {
    /// Faces with a circumference up to this are small,
    pub(super) small: f64,
    /// those above this, or with more than [`EDGES_MAX`] edges, are large.
    pub(super) large: f64,
    /// Edges up to this long are contracted.
    pub(super) edge: f64,
    /// A triangle whose 2 x area / perimeter is below this gets a fourth corner.
    pub(super) triangle: f64,
    /// How much of the tolerance may be used.
    pub(super) share: f64,
}

const EDGES_MAX: usize = 12;

/// What a contraction may leave behind; worse only if it was so before. Angles between two edges,
/// degrees (what is sharper than 45 would be blunted next, by two edges more);
const ANGLE_DEG: f64 = 50.0;
/// the sine of the corners of a face with four edges;
const SINE: f64 = 0.6;
/// 4 x area / perimeter of such a face, mesh sizes;
const SIDE: f64 = 0.35;
/// the distance of a node from an edge across a face, mesh sizes;
const GAP: f64 = 0.4;
/// and edges, mesh sizes.
const EDGE: f64 = 0.25;

/// Where on an edge its ends may meet, as shares of its way.
const PLACES: [f64; 5] = [0.5, 0.25, 0.75, 0.0, 1.0];
/// What a whole mesh size of movement counts beside a sine.
const MOVEMENT: f64 = 0.3;
/// A fourth corner turns by so much more than what counts as a corner, degrees:
/// relaxation takes some of it back.
const MORE_DEG: f64 = 10.0;
/// Where corners are blunter than this, degrees, a face would have to bulge for one.
const CORNER_MAX_DEG: f64 = 45.0;
/// It lies between these shares of the way along its side.
const MIDDLE: [f64; 2] = [0.3, 0.7];

/// A face inside the domain that is not large, by its outer walk.
struct Face {
    /// Edge and first node, in order, the face on the left.
    walk: SmallVec<[(u32, u32); EDGES_MAX]>,
    /// Circumference, mesh sizes.
    length: f64,
    /// 2 x area / circumference, mesh sizes.
    width: f64,
    /// Least mesh size along it, metres.
    size_m: f64,
}

/// What lies on one side of an edge.
enum Beside {
    Face(Face),
    /// A large face, one around all of this, or the outside.
    Large,
    /// A face that is only seen in part.
    Unknown,
}

/// Makes small faces at `nodes` even, the thinnest first.
pub(super) fn make_even(graph: &mut Graph, even: &Even, nodes: &[u32]) {
    if !graph.measure.does(Step::Even) {
        return;
    }
    let mut starts: Vec<(f64, Point, u32, usize)> = Vec::new();
    let mut seen = vec![[false; 2]; graph.edges.len()];
    for &node in nodes {
        for &edge in &graph.star[node as usize] {
            let side = graph.edges[edge as usize].end_at(node);
            if seen[edge as usize][side] {
                continue;
            }
            // what is not small is not so from any of its edges
            let found = left_of(graph, even, edge, side, |edge, side| {
                seen[edge as usize][side] = true;
            });
            if let Some(face) = small(even, found) {
                let from = |it: &(u32, u32)| (graph.point(it.1), it.0, it.1);
                let first = face.walk.iter().map(from).min();
                let (at, edge, node) = first.expect("a walk has edges");
                let side = graph.edges[edge as usize].end_at(node);
                starts.push((face.width, at, edge, side));
            }
        }
    }
    starts.sort_by(|a, b| {
        let by_width = a.0.total_cmp(&b.0);
        by_width.then_with(|| (a.1, a.2, a.3).cmp(&(b.1, b.2, b.3)))
    });
    for (_, _, edge, side) in starts {
        if graph.is_there(edge)
            && let Some(face) = small_face(graph, even, edge, side)
        {
            match face.walk.len() {
                3 => bend_side(graph, even, &face),
                4 => raise_node(graph, even, &face),
                n if n % 2 == 1 => contract_edge(graph, even, &face),
                _ => None,
            };
        }
    }
}

fn small_face(graph: &Graph, even: &Even, edge: u32, side: usize) -> Option<Face> {
    small(even, beside(graph, even, edge, side))
}

fn small(even: &Even, found: Beside) -> Option<Face> {
    match found {
        Beside::Face(face) if face.length <= even.small => Some(face),
        _ => None,
    }
}

/// What lies on the left of an edge, seen from its end `side`.
fn beside(graph: &Graph, even: &Even, edge: u32, side: usize) -> Beside {
    left_of(graph, even, edge, side, |_, _| ())
}

/// The same; tells of the half-edges that it passes there.
fn left_of(
    graph: &Graph,
    even: &Even,
    edge: u32,
    side: usize,
    mut tell: impl FnMut(u32, usize),
) -> Beside {
    let start = (edge, side);
    if !graph.edges[edge as usize].inside[side] {
        return Beside::Large;
    }
    let origin = graph.metres(graph.edges[edge as usize].ends[side]);
    let (mut edge, mut side) = start;
    let mut walk = SmallVec::new();
    let (mut length_m, mut area2_m2, mut size_m) = (0.0, 0.0, f64::INFINITY);
    loop {
        let it = &graph.edges[edge as usize];
        let (from, to) = (it.ends[side], it.ends[1 - side]);
        if !graph.is_free(from) {
            return Beside::Unknown;
        }
        let (a, b) = (graph.metres(from), graph.metres(to));
        length_m += distance(a, b);
        area2_m2 += cross(origin, a, b);
        size_m = it.size_m.min(size_m);
        if walk.len() == EDGES_MAX || length_m > even.large * size_m {
            return Beside::Large;
        }
        walk.push((edge, from));
        tell(edge, side);
        edge = leaving(graph, edge, to);
        side = graph.edges[edge as usize].end_at(to);
        if (edge, side) == start {
            break;
        }
    }
    // around the outside of a part: the face around it is larger
    if area2_m2 <= 0.0 {
        return Beside::Large;
    }
    Beside::Face(Face {
        walk,
        length: length_m / size_m,
        width: area2_m2 / length_m / size_m,
        size_m,
    })
}

/// What lies beyond an edge of a face, which starts at `from` there.
fn beyond(graph: &Graph, even: &Even, edge: u32, from: u32) -> Beside {
    let side = 1 - graph.edges[edge as usize].end_at(from);
    beside(graph, even, edge, side)
}

/// True if what lies beyond an edge of a face, which starts at `from` there, may become even or odd
/// with it: large, or another odd face with at least so many edges.
fn bears(graph: &Graph, even: &Even, edge: u32, from: u32, least: usize) -> bool {
    match beyond(graph, even, edge, from) {
        Beside::Large => true,
        Beside::Face(other) => {
            let (n, is_same) = (other.walk.len(), other.walk.contains(&(edge, from)));
            n % 2 == 1 && n >= least && !is_same
        }
        Beside::Unknown => false,
    }
}

/// A way to contract an edge: its ends meet in `place`.
struct Way {
    worth: f64,
    keep: u32,
    give: u32,
    place: Xy,
}

/// Contracts the edge of a face that leaves the best shapes.
fn contract_edge(graph: &mut Graph, even: &Even, face: &Face) -> Option<()> {
    for way in ways(graph, even, face) {
        let p = graph.measure.on_grid(way.place);
        let moved = [way.keep, way.give].map(|it| distance(graph.metres(it), way.place));
        let done = graph.attempt(|graph| {
            let is_there = graph.point(way.keep) == p || graph.shift(way.keep, p, even.share);
            (is_there && graph.merge(way.give, way.keep, even.share)).then_some(())
        });
        if done.is_some() {
            graph.note("made-even", p, moved[0].max(moved[1]));
            return done;
        }
    }
    None
}

/// All ways to contract an edge that leave shapes as they may be, the best first.
fn ways(graph: &Graph, even: &Even, face: &Face) -> Vec<Way> {
    let mut ways: Vec<Way> = Vec::new();
    for &(edge, from) in &face.walk {
        let to = graph.edges[edge as usize].other(from);
        let (a, b) = (graph.metres(from), graph.metres(to));
        let length = distance(a, b) / face.size_m;
        // what has three edges would be flat
        if length > even.edge || !bears(graph, even, edge, from, 5) {
            continue;
        }
        for t in PLACES {
            let place = [0, 1].map(|k| a[k] + t * (b[k] - a[k]));
            let may_go = |node: u32, is_there: bool| is_there || !is_rim_corner(graph, node);
            if !may_go(from, t == 0.0) || !may_go(to, t == 1.0) {
                continue;
            }
            if let Some(worst) = worst_shape(graph, even, [from, to], place) {
                let (keep, give) = if t > 0.5 { (to, from) } else { (from, to) };
                ways.push(Way {
                    worth: worst - MOVEMENT * length * t.max(1.0 - t),
                    keep,
                    give,
                    place,
                });
            }
        }
    }
    ways.sort_by(|a, b| b.worth.total_cmp(&a.worth));
    ways
}

/// The worst shape of the faces around two nodes that become one (or are one) at `place`; none if something gets
/// worse than it may.
fn worst_shape(graph: &Graph, even: &Even, pair: [u32; 2], place: Xy) -> Option<f64> {
    if !stays_open(graph, pair, place) {
        return None;
    }
    let mut worst = 1.0_f64;
    for node in pair {
        for &edge in &graph.star[node as usize] {
            let it = &graph.edges[edge as usize];
            let end = graph.metres(it.other(node));
            let [was, now] = [graph.metres(node), place].map(|at| distance(end, at) / it.size_m);
            if !pair.contains(&it.other(node)) && now < EDGE.min(was) {
                return None;
            }
            let side = it.end_at(node);
            let face = match beside(graph, even, edge, side) {
                Beside::Face(face) => face,
                Beside::Large => continue,
                Beside::Unknown => return None,
            };
            let nodes = face.walk.iter().map(|&(_, it)| it);
            let before: SmallVec<[Xy; EDGES_MAX]> =
                nodes.clone().map(|it| graph.metres(it)).collect();
            let mut after: SmallVec<[Xy; EDGES_MAX]> = nodes
                .map(|it| {
                    if pair.contains(&it) {
                        place
                    } else {
                        graph.metres(it)
                    }
                })
                .collect();
            after.dedup();
            if after.first() == after.last() {
                after.pop();
            }
            let (was, now) = (shape(&before, it.size_m), shape(&after, it.size_m));
            if now.is_worse_than(&was) {
                return None;
            }
            worst = worst.min(now.sine).min(now.side);
        }
    }
    Some(worst)
}

/// How good a face is, as far as it is known: 1 otherwise.
struct Shape {
    /// Least sine of the corners: of all if there are four, else of those below 90 degrees.
    sine: f64,
    /// 4 x area / perimeter, mesh sizes, if there are four.
    side: f64,
    /// Least distance of a corner from a side that is not its own, mesh sizes.
    gap: f64,
}

impl Shape {
    /// True if something is worse than it may be, and than it was.
    fn is_worse_than(&self, was: &Shape) -> bool {
        self.sine < SINE.min(was.sine)
            || self.side < SIDE.min(was.side)
            || self.gap < GAP.min(was.gap)
    }
}

fn shape(polygon: &[Xy], size_m: f64) -> Shape {
    let n = polygon.len();
    let (mut sine, mut gap_m) = (1.0_f64, f64::INFINITY);
    for k in 0..n {
        let (a, o, b) = (polygon[(k + n - 1) % n], polygon[k], polygon[(k + 1) % n]);
        let is_below_90 = (a[0] - o[0]) * (b[0] - o[0]) + (a[1] - o[1]) * (b[1] - o[1]) > 0.0;
        let turn = cross(a, o, b);
        if is_below_90 && turn > 0.0 {
            sine = sine.min(turn / (distance(a, o) * distance(o, b)));
        }
        for other in (k + 2)..(k + n) {
            gap_m = gap_m.min(to_segment(polygon[other % n], o, b).0);
        }
    }
    let (mut side, gap) = (1.0, gap_m / size_m);
    if let Ok(quad) = <&[Xy; 4]>::try_from(polygon) {
        let measured = measure(quad);
        (sine, side) = (measured.scaled_jacobian, measured.hydraulic_size_m / size_m);
    }
    Shape { sine, side, gap }
}

/// False if an angle between two edges at or around a pair of nodes that become one at `place` gets
/// sharper than it may.
fn stays_open(graph: &Graph, pair: [u32; 2], place: Xy) -> bool {
    let near = pair.map(|it| graph.neighbours(it));
    let mut ends: SmallVec<[u32; 12]> = near.concat().into();
    ends.retain(|it| !pair.contains(it));
    ends.sort_unstable();
    ends.dedup();
    let at = |nodes: &[u32]| -> SmallVec<[Xy; 12]> {
        let all = nodes.iter();
        all.map(|&it| graph.metres(it)).collect()
    };
    let was_deg = || {
        let each = [0, 1].map(|k| sharpest_deg(graph.metres(pair[k]), &at(&near[k])));
        each[0].min(each[1])
    };
    if !is_open(sharpest_deg(place, &at(&ends)), was_deg) {
        return false;
    }
    ends.iter().all(|&end| {
        let mut after = graph.neighbours(end);
        after.retain(|it| !pair.contains(it));
        let mut after = at(&after);
        after.push(place);
        let hub = graph.metres(end);
        let was_deg = || sharpest_deg(hub, &at(&graph.neighbours(end)));
        is_open(sharpest_deg(hub, &after), was_deg)
    })
}

/// True if an angle is not sharp, or no sharper than it was; most are not, whatever they were.
fn is_open(now_deg: f64, was_deg: impl FnOnce() -> f64) -> bool {
    now_deg >= ANGLE_DEG || now_deg >= was_deg()
}

/// The least angle between neighbouring directions from `hub`, degrees.
fn sharpest_deg(hub: Xy, ends: &[Xy]) -> f64 {
    let bearings = ends.iter().map(|it| (it[1] - hub[1]).atan2(it[0] - hub[0]));
    let mut bearings: SmallVec<[f64; 12]> = bearings.map(f64::to_degrees).collect();
    gaps_deg(&mut bearings).fold(360.0, f64::min)
}

/// Gives a thin triangle with three edges a corner in the middle of a side, the longest that may have
/// one.
fn bend_side(graph: &mut Graph, even: &Even, face: &Face) -> Option<()> {
    if face.width > even.triangle {
        return None;
    }
    let mut sides: SmallVec<[(f64, u32, u32); 3]> = SmallVec::new();
    for &(edge, from) in &face.walk {
        let is_rim = graph.edges[edge as usize].is_rim();
        if !is_rim && bears(graph, even, edge, from, 3) {
            let (a, b) = graph.ends_m(edge);
            sides.push((distance(a, b), edge, from));
        }
    }
    sides.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    sides.into_iter().find_map(|(length_m, edge, from)| {
        let to = graph.edges[edge as usize].other(from);
        let p = corner_beside(graph, graph.metres(from), graph.metres(to), 0.5)?;
        if !leaves_room(graph, even, edge, from, p) {
            return None;
        }
        graph.bend(edge, Bend::At(p), even.share)?;
        graph.note("cornered", p, 0.5 * length_m * half_turn(graph).tan());
        Some(())
    })
}

/// True if what lies beyond an edge of a face, which starts at `from` there, bears that the edge bends
/// into it to `p`.
fn leaves_room(graph: &Graph, even: &Even, edge: u32, from: u32, p: Point) -> bool {
    let face = match beyond(graph, even, edge, from) {
        Beside::Face(face) => face,
        Beside::Large => return true,
        Beside::Unknown => return false,
    };
    // from the other end of the edge on
    let nodes = face.walk.iter().map(|&(_, it)| graph.metres(it));
    let before: SmallVec<[Xy; EDGES_MAX]> = nodes.collect();
    let mut after = before.clone();
    after.insert(1, graph.measure.metres(p));
    !shape(&after, face.size_m).is_worse_than(&shape(&before, face.size_m))
}

/// Makes the one node of a thin triangle with four edges that is no corner one, by moving it out.
fn raise_node(graph: &mut Graph, even: &Even, face: &Face) -> Option<()> {
    let corner_deg = graph.measure.corner_deg;
    if face.width > even.triangle || corners(graph, &face.walk, corner_deg) != 3 {
        return None;
    }
    let at = |k: usize| graph.metres(face.walk[k % 4].1);
    let turn_deg = |k: usize| 180.0 - between_deg(at(k), at(k + 3), at(k + 1));
    let flat = (0..4).find(|&k| turn_deg(k) <= corner_deg)?;
    let node = face.walk[flat].1;
    if graph.is_on_rim(node) {
        return None;
    }
    let (a, o, b) = (at(flat + 3), at(flat), at(flat + 1));
    let t = to_segment(o, a, b).1;
    let p = corner_beside(graph, a, b, t.clamp(MIDDLE[0], MIDDLE[1]))?;
    let place = graph.measure.metres(p);
    worst_shape(graph, even, [node, node], place)?;
    if !graph.shift(node, p, even.share) {
        return None;
    }
    graph.note("cornered", p, distance(o, place));
    Some(())
}

/// The place to the right of the way from `a` to `b`, at `t` of it, over which a walk turns at a corner;
/// none where corners are too blunt.
pub(super) fn corner_beside(graph: &Graph, a: Xy, b: Xy, t: f64) -> Option<Point> {
    if graph.measure.corner_deg > CORNER_MAX_DEG {
        return None;
    }
    // at a height h over a side of length 1: atan(h / t) + atan(h / (1 - t)) = turn
    let tan = (2.0 * half_turn(graph)).tan();
    let height = ((1.0 + 4.0 * tan * tan * t * (1.0 - t)).sqrt() - 1.0) / (2.0 * tan);
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let place = [a[0] + t * dx + height * dy, a[1] + t * dy - height * dx];
    Some(graph.measure.on_grid(place))
}

/// Half of the turn of a fourth corner, radians.
fn half_turn(graph: &Graph) -> f64 {
    (0.5 * (graph.measure.corner_deg + MORE_DEG)).to_radians()
}
