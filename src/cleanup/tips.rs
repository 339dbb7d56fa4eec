//! Blunts the tips of strips and wedges: where two lines leave a node at an acute angle, the lesser
//! one goes along the other for a little, and then crosses over to its own way.
//!
//! A tip has three corners, so the quads behind it come in two rows, or in one whose first quad has
//! a flat corner. With an edge across it, about as long as the place is wide, it has four corners:
//! one row will do.

use crate::cleanup::graph::Graph;
use crate::cleanup::measure::distance;
use crate::cleanup::operate::Bend;
use crate::cleanup::steps::Step;
use crate::cleanup::wedges::Wedge;
use crate::cleanup::wedges::wedges;

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
    /// How much of the tolerance may be used.
    pub(super) share: f64,
}

/// A side more than so many times as long as it should be is given a node.
const LONG: f64 = 1.5;

/// Blunts the tips at `nodes`, the sharpest first.
pub(super) fn blunt_tips(graph: &mut Graph, blunt: &Blunt, nodes: &[u32]) {
    if !graph.measure.does(Step::Blunt) {
        return;
    }
    for tip in wedges(graph, blunt.below_deg, nodes) {
        blunt_one(graph, blunt, &tip);
    }
}

/// Leads the side of lower rank along the other one as far as both reach, and from there across.
fn blunt_one(graph: &mut Graph, blunt: &Blunt, tip: &Wedge) -> Option<()> {
    let hub = tip.hub;
    let sides = [graph.find(hub, tip.a)?, graph.find(hub, tip.b)?];
    let rank = sides.map(|edge| graph.edges[edge as usize].rank);
    let (stays, goes) = if rank[0] >= rank[1] {
        (tip.a, tip.b)
    } else {
        (tip.b, tip.a)
    };
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
        graph.bend(edge, Bend::To(stays), blunt.share)
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
