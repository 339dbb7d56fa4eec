//! Blunts the tips of strips and wedges: where two lines leave a node at an acute angle, the lesser
//! one goes along the other for a little, and then crosses over to its own way.
//!
//! A tip has three corners, so the quads behind it come in two rows, or in one whose first quad has
//! a flat corner. With an edge across it, about as long as the place is wide, it has four corners:
//! one row will do. If the lesser line may not go so far, the other one does; if neither may, one of them
//! turns a corner beside the tip, which moves it half as far.

use crate::cleanup::even::corner_beside;
use crate::cleanup::graph::Graph;
use crate::cleanup::measure::PRIORITY_RANK;
use crate::cleanup::measure::distance;
use crate::cleanup::measure::to_segment;
use crate::cleanup::operate::Bend;
use crate::cleanup::steps::Step;
use crate::cleanup::wedges::Wedge;
use crate::cleanup::wedges::wedges;
use crate::geometry::quad::cross;

/// Which tips are blunted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blunt {
    /// Those sharper than this, degrees. At 60 and above an edge across is no shorter than the sides.
    pub(super) below_deg: f64,
    /// Length of the edge across, in mesh sizes: wished where the sides are long, else between least
    /// and most.
    pub(super) across: f64,
    pub(super) least: f64,
    pub(super) most: f64,
    /// How far from the tip a side turns a corner instead, mesh sizes.
    pub(super) corner: f64,
    /// How much of the tolerance may be used: by the line of lower rank, by the other one, for a corner.
    pub(super) shares: [f64; 3],
}

/// A side more than so many times as long as it should be is given a node.
const LONG: f64 = 1.5;

/// A side longer than this, mesh sizes, is given a node where it turns; a shorter one turns at its end.
const BENT: f64 = 1.0;
/// But no nearer to the tip than this, mesh sizes,
const NEAREST: f64 = 0.3;
/// nor elsewhere than between these shares of the way to the node after it.
const MIDDLE: [f64; 2] = [0.2, 0.8];

/// Two sides of a tip by their ends: one that stays and one that moves.
#[derive(Clone, Copy)]
struct Sides {
    stays: u32,
    goes: u32,
}

/// Blunts the tips at `nodes`, the sharpest first.
pub(super) fn blunt_tips(graph: &mut Graph, blunt: &Blunt, nodes: &[u32]) {
    if !graph.measure.does(Step::Blunt) {
        return;
    }
    for tip in wedges(graph, blunt.below_deg, nodes) {
        blunt_one(graph, blunt, &tip);
    }
}

/// Blunts one tip in the first way that is allowed.
fn blunt_one(graph: &mut Graph, blunt: &Blunt, tip: &Wedge) -> Option<()> {
    let [a, b] = [tip.a, tip.b].map(|end| graph.find(tip.hub, end));
    let rank = [a?, b?].map(|edge| graph.edges[edge as usize].rank);
    let (stays, goes) = if rank[0] >= rank[1] {
        (tip.a, tip.b)
    } else {
        (tip.b, tip.a)
    };
    let usual = Sides { stays, goes };
    let swapped = Sides {
        stays: goes,
        goes: stays,
    };
    // outlines, held lines and those of higher priority stay
    let may_swap = (rank[0] - rank[1]).abs() < PRIORITY_RANK;
    let ways = if may_swap {
        &[usual, swapped][..]
    } else {
        &[usual]
    };
    let [lesser, other, corner] = blunt.shares;
    (ways.iter().zip([lesser, other]))
        .find_map(|(&sides, share)| cross_over(graph, blunt, tip, sides, share))
        .or_else(|| {
            ways.iter()
                .find_map(|&sides| turn_corner(graph, blunt, tip, sides, corner))
        })
}

/// Leads one side along the other one as far as both reach, and from there across.
fn cross_over(
    graph: &mut Graph,
    blunt: &Blunt,
    tip: &Wedge,
    sides: Sides,
    share: f64,
) -> Option<()> {
    let (hub, Sides { stays, goes }) = (tip.hub, sides);
    let size_m = graph.size_at_m(hub);
    let opening = 2.0 * (0.5 * tip.angle_deg).to_radians().sin();
    let (o, ends) = (graph.metres(hub), [stays, goes].map(|it| graph.metres(it)));
    let shorter_m = distance(o, ends[0]).min(distance(o, ends[1]));
    let wished_m = blunt.across * size_m / opening;
    let reach_m = if shorter_m > LONG * wished_m {
        wished_m
    } else {
        shorter_m
    };
    let across = opening * reach_m / size_m;
    if across < blunt.least || across > blunt.most {
        return None;
    }
    graph.attempt(|graph| {
        let stays = node_at(graph, hub, stays, reach_m)?;
        let goes = node_at(graph, hub, goes, reach_m)?;
        let edge = graph.find(hub, goes)?;
        graph.bend(edge, Bend::To(stays), share)
    })?;
    let moved_m = reach_m * tip.angle_deg.to_radians().sin();
    graph.note("blunted", graph.point(hub), moved_m);
    Some(())
}

/// The end of a side, or a new node on it if the side is much longer than `reach_m`.
fn node_at(graph: &mut Graph, hub: u32, end: u32, reach_m: f64) -> Option<u32> {
    let (o, a) = (graph.metres(hub), graph.metres(end));
    let length_m = distance(o, a);
    if length_m <= LONG * reach_m {
        return Some(end);
    }
    let t = reach_m / length_m;
    let place = [0, 1].map(|k| o[k] + t * (a[k] - o[k]));
    // the side stays where it is, however much of the tolerance it has used
    let edge = graph.find(hub, end)?;
    graph.bend(edge, Bend::At(graph.measure.on_grid(place)), 1.0)
}

/// Gives one side that is no outline a corner near the tip, away from the other side: at a new node, or at
/// its end if no third line meets it there.
fn turn_corner(
    graph: &mut Graph,
    blunt: &Blunt,
    tip: &Wedge,
    sides: Sides,
    share: f64,
) -> Option<()> {
    let (hub, end) = (tip.hub, sides.goes);
    let edge = graph.find(hub, end)?;
    // a tip of the domain would bulge out of it
    if graph.edges[edge as usize].is_rim() {
        return None;
    }
    let (o, a) = (graph.metres(hub), graph.metres(end));
    let length = distance(o, a) / graph.size_at_m(hub);
    let is_long = length > BENT;
    let (b, t) = if is_long {
        (a, (blunt.corner / length).min(0.5))
    } else {
        if graph.degree(end) != 2 || length < NEAREST {
            return None;
        }
        let beyond = (graph.neighbours(end).into_iter()).find(|&it| it != hub)?;
        let b = graph.metres(beyond);
        let t = to_segment(a, o, b).1;
        if !(MIDDLE[0]..=MIDDLE[1]).contains(&t) {
            return None;
        }
        (b, t)
    };
    let is_left = cross(o, a, graph.metres(sides.stays)) > 0.0;
    let p = if is_left {
        corner_beside(graph, o, b, t)?
    } else {
        corner_beside(graph, b, o, 1.0 - t)?
    };
    let place = graph.measure.metres(p);
    let moved_m = if is_long {
        graph.bend(edge, Bend::At(p), share)?;
        to_segment(place, o, b).0
    } else {
        graph.shift(end, p, share).then_some(distance(a, place))?
    };
    graph.note("cornered", p, moved_m);
    Some(())
}
