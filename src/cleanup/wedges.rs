//! Zips acute wedges: two lines that leave a node side by side share their way until they are far
//! enough apart, and part there at a blunt angle.

use crate::cleanup::graph::Graph;
use crate::cleanup::measure::distance;
use crate::cleanup::operate::Bend;
use crate::cleanup::separate::join;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::geometry::predicates::by_angle;
use crate::geometry::predicates::orient;

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
struct Wedge {
    angle_deg: f64,
    hub: u32,
    a: u32,
    b: u32,
}

/// Zips all wedges, the sharpest first; returns how many.
pub(super) fn zip_wedges(graph: &mut Graph, zip: &Zip) -> usize {
    let mut wedges = wedges(graph, zip.below_deg);
    wedges.sort_by(|u, v| {
        (u.angle_deg.total_cmp(&v.angle_deg))
            .then_with(|| graph.point(u.hub).cmp(&graph.point(v.hub)))
            .then_with(|| graph.point(u.a).cmp(&graph.point(v.a)))
    });
    let mut zipped = 0;
    for wedge in wedges {
        let is_there = [wedge.a, wedge.b]
            .iter()
            .all(|&it| graph.find(wedge.hub, it).is_some());
        if is_there && zip_one(graph, zip, &wedge) {
            graph.note("zipped", graph.point(wedge.hub), 0.0);
            zipped += 1;
        }
    }
    zipped
}

/// All wedges inside the domain below an angle, unsorted.
fn wedges(graph: &Graph, below_deg: f64) -> Vec<Wedge> {
    let mut wedges = Vec::new();
    for hub in 0..graph.at.len() as u32 {
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
    wedges
}

/// The edges of a node, counter-clockwise.
pub(super) fn sorted_star(graph: &Graph, node: u32) -> Vec<u32> {
    let at = graph.point(node);
    let away = |edge: u32| {
        let end = graph.point(graph.edges[edge as usize].other(node));
        (
            i64::from(end.x) - i64::from(at.x),
            i64::from(end.y) - i64::from(at.y),
        )
    };
    let mut star = graph.star[node as usize].to_vec();
    star.sort_by(|&e, &f| by_angle(away(e), away(f)));
    star
}

/// The angle between the directions from `hub` to `a` and to `b`, degrees, up to 180.
pub(super) fn angle_deg(graph: &Graph, hub: u32, a: u32, b: u32) -> f64 {
    let [o, a, b] = [hub, a, b].map(|node| graph.metres(node));
    let (u, v) = ([a[0] - o[0], a[1] - o[1]], [b[0] - o[0], b[1] - o[1]]);
    let (cross, dot) = (u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]);
    cross.abs().atan2(dot).to_degrees()
}

fn zip_one(graph: &mut Graph, zip: &Zip, wedge: &Wedge) -> bool {
    let Wedge { hub, a, b, .. } = *wedge;
    let half = (angle_deg(graph, hub, a, b) / 2.0).to_radians();
    let size = graph.size_at_m(hub);
    let gap = zip.gap * size;
    let (o, a_at, b_at) = (graph.metres(hub), graph.metres(a), graph.metres(b));
    let (la, lb) = (distance(o, a_at), distance(o, b_at));
    let (short, long) = if la <= lb { (a, b) } else { (b, a) };
    if la.min(lb) * (2.0 * half).sin() < gap {
        let edge = graph.find(hub, long).expect("the wedge was there");
        return join(graph, short, edge, 0.25, zip.share).is_some();
    }
    let reach = gap / (2.0 * half.sin());
    let (u, v) = (towards(o, a_at, 1.0 / la), towards(o, b_at, 1.0 / lb));
    // the outline stays: the other line comes to it
    let is_rim = [a, b].map(|it| {
        graph
            .find(hub, it)
            .is_some_and(|e| graph.edges[e as usize].is_rim())
    });
    let way = match is_rim {
        [true, false] => u,
        [false, true] => v,
        [true, true] => return false,
        [false, false] => [(u[0] + v[0]) / 2.0, (u[1] + v[1]) / 2.0],
    };
    let parting = [o[0] + way[0] * reach, o[1] + way[1] * reach];
    part(
        graph,
        zip,
        wedge,
        parting,
        [u, v],
        [la, lb],
        reach + gap,
        gap,
    )
}

fn towards(o: Xy, a: Xy, scale: f64) -> Xy {
    [(a[0] - o[0]) * scale, (a[1] - o[1]) * scale]
}

/// Splits both arms at `at_m` from the hub where they are long enough, then leads the inner parts
/// over `parting`.
#[allow(clippy::too_many_arguments)]
fn part(
    graph: &mut Graph,
    zip: &Zip,
    wedge: &Wedge,
    parting: Xy,
    along: [Xy; 2],
    length: [f64; 2],
    at_m: f64,
    gap: f64,
) -> bool {
    let o = graph.metres(wedge.hub);
    let mut arms = [wedge.a, wedge.b];
    let mut added = Vec::new();
    for k in 0..2 {
        if length[k] > at_m + gap {
            let edge = graph.find(wedge.hub, arms[k]).expect("an arm");
            let p = [o[0] + along[k][0] * at_m, o[1] + along[k][1] * at_m];
            let Some(node) = graph.bend(edge, Bend::At(cell(graph, p)), zip.share) else {
                continue;
            };
            added.push(node);
            arms[k] = node;
        }
    }
    if graph
        .find(wedge.hub, arms[1])
        .is_some_and(|e| graph.edges[e as usize].is_rim())
    {
        arms.swap(0, 1);
    }
    let first = graph.find(wedge.hub, arms[0]).expect("an arm");
    let middle = graph.bend(first, Bend::At(cell(graph, parting)), zip.share);
    let done = middle.is_some_and(|node| {
        let second = graph.find(wedge.hub, arms[1]).expect("an arm");
        graph.bend(second, Bend::To(node), zip.share).is_some() || {
            graph.straighten(node, f64::INFINITY, false);
            false
        }
    });
    if !done {
        for node in added {
            graph.straighten(node, f64::INFINITY, false);
        }
    }
    done
}

fn cell(graph: &Graph, p: Xy) -> Point {
    let cell_m = graph.measure.grid().cell_m;
    Point::new(
        (p[0] / cell_m).round() as i32,
        (p[1] / cell_m).round() as i32,
    )
}
