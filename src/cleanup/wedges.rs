//! Zips acute wedges: two lines that leave a node side by side share their way until they are far
//! enough apart, and part there at a blunt angle.

use crate::cleanup::graph::Graph;
use crate::cleanup::measure::between_deg;
use crate::cleanup::measure::distance;
use crate::cleanup::measure::may_be_below;
use crate::cleanup::operate::Bend;
use crate::cleanup::separate::join;
use crate::cleanup::steps::Step;
use crate::geometry::point::Xy;
use crate::geometry::predicates::by_angle;
use crate::geometry::predicates::orient;
use smallvec::SmallVec;

/// What is zipped.
#[derive(Clone, Copy, Debug)]
pub(super) struct Zip {
    /// Wedges sharper than this, degrees.
    pub(super) below_deg: f64,
    /// How far apart two lines must be to part, in mesh sizes.
    pub(super) gap: f64,
    /// How much of the tolerance may be used.
    pub(super) share: f64,
}

/// Two edges `hub a` and `hub b` with nothing in between.
pub(super) struct Wedge {
    pub(super) angle_deg: f64,
    pub(super) hub: u32,
    pub(super) a: u32,
    pub(super) b: u32,
}

/// Zips the wedges at `nodes`, the sharpest first.
pub(super) fn zip_wedges(graph: &mut Graph, zip: &Zip, nodes: &[u32]) {
    for wedge in wedges(graph, zip.below_deg, nodes) {
        let is_there = [wedge.a, wedge.b]
            .iter()
            .all(|&it| graph.find(wedge.hub, it).is_some());
        if is_there && graph.measure.does(Step::Zip) && zip_one(graph, zip, &wedge) {
            graph.note("zipped", graph.point(wedge.hub), 0.0);
        } else if is_there {
            divide(graph, zip, &wedge);
        }
    }
}

/// Divides the long arms of all wedges at `nodes`.
pub(super) fn divide_wedges(graph: &mut Graph, zip: &Zip, nodes: &[u32]) {
    for wedge in wedges(graph, zip.below_deg, nodes) {
        divide(graph, zip, &wedge);
    }
}

/// Nodes that an arm is given at most.
const PARTS_MAX: f64 = 64.0;

/// Gives both arms nodes a mesh size apart, as far as the arms are too near to each other. A long
/// edge as a whole may be within tolerance neither here nor there, and nothing that looks at nodes
/// sees how narrow the wedge is between its ends.
fn divide(graph: &mut Graph, zip: &Zip, wedge: &Wedge) {
    if !graph.measure.does(Step::Divide) {
        return;
    }
    let size = graph.size_at_m(wedge.hub);
    let near = zip.gap * size / (2.0 * (wedge.angle_deg / 2.0).to_radians().sin());
    for end in [wedge.a, wedge.b] {
        let Some(mut rest) = graph.find(wedge.hub, end) else {
            return;
        };
        let (o, a) = (graph.metres(wedge.hub), graph.metres(end));
        let length = distance(o, a);
        let parts = (near.min(length - 0.5 * size) / size)
            .floor()
            .min(PARTS_MAX);
        // from the far end: what is left of the arm stays at the hub
        for k in (1..=parts as u32).rev() {
            let t = f64::from(k) * size / length;
            let place = [0, 1].map(|i| o[i] + t * (a[i] - o[i]));
            // the arm stays where it is, however much of the tolerance it has used
            let node = graph.bend(rest, Bend::At(graph.measure.on_grid(place)), 1.0);
            if let Some(inner) = node.and_then(|node| graph.find(wedge.hub, node)) {
                rest = inner;
            }
        }
    }
}

/// All wedges inside the domain below an angle, the sharpest first.
pub(super) fn wedges(graph: &Graph, below_deg: f64, nodes: &[u32]) -> Vec<Wedge> {
    assert!(below_deg < 90.0);
    let tangent = below_deg.to_radians().tan();
    let mut wedges = Vec::new();
    for &hub in nodes {
        let star = sorted_star(graph, hub);
        if star.len() < 2 {
            continue;
        }
        for k in 0..star.len() {
            let (e, f) = (star[k], star[(k + 1) % star.len()]);
            // counter-clockwise from e to f: the wedge is on the left of e
            if !graph.edges[e as usize].inside_from(hub)[0] {
                continue;
            }
            let [a, b] = [e, f].map(|edge| graph.edges[edge as usize].other(hub));
            let [o, a_m, b_m] = [hub, a, b].map(|node| graph.metres(node));
            if !may_be_below(o, a_m, b_m, tangent) {
                continue;
            }
            let angle_deg = angle_deg(graph, hub, a, b);
            let turns_left = orient(graph.point(hub), graph.point(a), graph.point(b)) > 0;
            if angle_deg < below_deg && turns_left {
                wedges.push(Wedge {
                    angle_deg,
                    hub,
                    a,
                    b,
                });
            }
        }
    }
    wedges.sort_by(|u, v| {
        (u.angle_deg.total_cmp(&v.angle_deg))
            .then_with(|| graph.point(u.hub).cmp(&graph.point(v.hub)))
            .then_with(|| graph.point(u.a).cmp(&graph.point(v.a)))
    });
    wedges
}

/// The edges of a node, counter-clockwise.
fn sorted_star(graph: &Graph, node: u32) -> SmallVec<[u32; 6]> {
    let mut star: SmallVec<[u32; 6]> = graph.star[node as usize].iter().copied().collect();
    if star.len() > 2 {
        star.sort_by(|&e, &f| by_angle(graph.heading(node, e), graph.heading(node, f)));
    }
    star
}

/// The angle between the directions from `hub` to `a` and to `b`, degrees, up to 180.
pub(super) fn angle_deg(graph: &Graph, hub: u32, a: u32, b: u32) -> f64 {
    let [o, a, b] = [hub, a, b].map(|node| graph.metres(node));
    between_deg(o, a, b)
}

fn zip_one(graph: &mut Graph, zip: &Zip, wedge: &Wedge) -> bool {
    let gap = zip.gap * graph.size_at_m(wedge.hub);
    let half = (wedge.angle_deg / 2.0).to_radians();
    let (a, b) = (
        Arm::new(graph, wedge.hub, wedge.a),
        Arm::new(graph, wedge.hub, wedge.b),
    );
    let (short, long) = if a.length_m <= b.length_m {
        (&a, &b)
    } else {
        (&b, &a)
    };
    if short.length_m * (2.0 * half).sin() < gap {
        let edge = graph.find(wedge.hub, long.end).expect("an arm is there");
        return join(graph, short.end, edge, 0.25, zip.share).is_some();
    }
    // the outline stays: the other line comes to it
    let (first, second) = if b.is_rim { (b, a) } else { (a, b) };
    if second.is_rim {
        return false;
    }
    let way = if first.is_rim {
        first.way
    } else {
        [
            (first.way[0] + second.way[0]) / 2.0,
            (first.way[1] + second.way[1]) / 2.0,
        ]
    };
    let reach = gap / (2.0 * half.sin());
    part(
        graph,
        zip,
        wedge.hub,
        [first, second],
        way,
        [reach, reach + gap],
    )
}

/// One side of a wedge.
struct Arm {
    end: u32,
    is_rim: bool,
    length_m: f64,
    /// Its direction, of length one.
    way: Xy,
}

impl Arm {
    fn new(graph: &Graph, hub: u32, end: u32) -> Arm {
        let (o, a) = (graph.metres(hub), graph.metres(end));
        let length_m = distance(o, a);
        let edge = graph.find(hub, end).expect("an arm is an edge");
        Arm {
            end,
            is_rim: graph.edges[edge as usize].is_rim(),
            length_m,
            way: [(a[0] - o[0]) / length_m, (a[1] - o[1]) / length_m],
        }
    }
}

/// Splits both arms at `at_m[1]` from the hub where they are long enough, then leads their inner
/// parts over the place `at_m[0]` along `way`.
fn part(graph: &mut Graph, zip: &Zip, hub: u32, arms: [Arm; 2], way: Xy, at_m: [f64; 2]) -> bool {
    let o = graph.metres(hub);
    let place =
        |graph: &Graph, way: Xy, at: f64| graph.measure.on_grid([0, 1].map(|k| o[k] + way[k] * at));
    let parted = graph.attempt(|graph| {
        let ends = arms.map(|arm| {
            let edge = graph.find(hub, arm.end).expect("an arm is an edge");
            let p = place(graph, arm.way, at_m[1]);
            // the rest of the arm should not be shorter than the way between the two places
            let is_long = arm.length_m > 2.0 * at_m[1] - at_m[0];
            let node = is_long
                .then(|| graph.bend(edge, Bend::At(p), zip.share))
                .flatten();
            node.unwrap_or(arm.end)
        });
        let first = graph.find(hub, ends[0]).expect("an arm is an edge");
        let parting = place(graph, way, at_m[0]);
        let node = graph.bend(first, Bend::At(parting), zip.share)?;
        let second = graph.find(hub, ends[1]).expect("an arm is an edge");
        graph.bend(second, Bend::To(node), zip.share)
    });
    parted.is_some()
}
