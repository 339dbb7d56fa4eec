//! Removes nodes that do not matter, the least deviation first.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::cleanup::graph::Graph;
use crate::cleanup::importance::turn_deg;
use crate::cleanup::measure::distance;
use crate::cleanup::measure::to_segment;
use crate::cleanup::steps::Step;
use crate::cleanup::wedges::angle_deg;
use crate::geometry::point::Point;

/// What simplification may do, in shares of the local mesh size.
#[derive(Clone, Copy, Debug)]
pub(super) struct Smooth {
    /// How far lines may be from the edge that replaces two.
    pub(super) deviation: f64,
    /// The same at corners, of which only those go that are nearer than the least edge to the node
    /// before or after: wiggles.
    pub(super) at_corners: f64,
    /// The same along the outline.
    pub(super) on_rim: f64,
    /// No node may come nearer than this to the new edge (unless it was as near before).
    pub(super) gap: f64,
    /// No angle at the ends of the new edge may fall below this, degrees.
    pub(super) angle_deg: f64,
    /// May the end of one line and the start of the next lose their node?
    pub(super) over_ends: bool,
}

/// Removes all nodes of degree two that `smooth` allows, of these and what they lead to.
pub(super) fn simplify(graph: &mut Graph, smooth: &Smooth, nodes: &[u32]) {
    if !graph.measure.does(Step::Simplify) {
        return;
    }
    let mut queue = BinaryHeap::new();
    for &node in nodes {
        push(graph, smooth, node, &mut queue);
    }
    while let Some(Reverse((key, _, _, node))) = queue.pop() {
        let Some(deviation) = deviation(graph, smooth, node) else {
            continue;
        };
        if deviation.to_bits() > key {
            push(graph, smooth, node, &mut queue);
            continue;
        }
        if !keeps_distance(graph, smooth, node) || !keeps_angles(graph, smooth, node) {
            continue;
        }
        let at = graph.point(node);
        if let Some(edge) = graph.straighten(node, 1.0, false) {
            graph.note(
                "simplified",
                at,
                deviation * graph.edges[edge as usize].size_m,
            );
            for end in graph.edges[edge as usize].ends {
                push(graph, smooth, end, &mut queue);
            }
        }
    }
}

type Queue = BinaryHeap<Reverse<(u64, u32, Point, u32)>>;

/// Ties (straight lines) are broken by a hash of the place: removal from one end would measure the
/// growing edge again and again.
fn push(graph: &Graph, smooth: &Smooth, node: u32, queue: &mut Queue) {
    if let Some(deviation) = deviation(graph, smooth, node) {
        let at = graph.point(node);
        queue.push(Reverse((deviation.to_bits(), scatter(at), at, node)));
    }
}

fn scatter(p: Point) -> u32 {
    let mixed = (p.x as u32).wrapping_mul(0x9E37_79B1) ^ (p.y as u32).wrapping_mul(0x85EB_CA77);
    (mixed ^ (mixed >> 15)).wrapping_mul(0xC2B2_AE35)
}

/// How far its lines would be from the edge without `node`, in mesh sizes; `None` if it must stay.
fn deviation(graph: &Graph, smooth: &Smooth, node: u32) -> Option<f64> {
    let star = &graph.star[node as usize];
    let &[e, f] = star.as_slice() else {
        return None;
    };
    let [a, b] = [e, f].map(|edge| graph.edges[edge as usize].other(node));
    let size = graph.size_at_m(node);
    let (p, q) = (graph.metres(a), graph.metres(b));
    let own = to_segment(graph.metres(node), p, q).0;
    // most nodes are told by this, and need no look at their lines
    let most = (smooth.deviation).max(smooth.at_corners).max(smooth.on_rim);
    if own > size * most || a == b || graph.find(a, b).is_some() {
        return None;
    }
    if !smooth.over_ends && !graph.all_pass(node) {
        return None;
    }
    let (_, _, pieces) = graph.passing(node)?;
    let turns = turns(graph, node);
    if turns && star.iter().all(|&edge| is_long(graph, edge)) {
        return None;
    }
    let is_rim = star.iter().any(|&edge| graph.edges[edge as usize].is_rim());
    let limit = size
        * match (is_rim, turns) {
            (true, _) => smooth.on_rim,
            (false, true) => smooth.at_corners,
            (false, false) => smooth.deviation,
        };
    if own > limit {
        return None;
    }
    let mut worst = own;
    for piece in &pieces {
        worst = worst.max(graph.measure.deviation_m(piece, p, q));
        if worst > limit {
            return None;
        }
    }
    Some(worst / size)
}

/// True at a corner: of the way over the node as it is now, or of a line as read. Without the
/// second, a corner would go whose neighbours went before.
fn turns(graph: &Graph, node: u32) -> bool {
    turn_deg(graph, node, |_| true).is_some_and(|turn| turn > graph.measure.corner_deg)
        || (graph.pieces_from(graph.star[node as usize][0], node).iter())
            .any(|piece| graph.measure.is_corner(piece.line, piece.from_m))
}

/// True if an edge may stay as it is.
fn is_long(graph: &Graph, edge: u32) -> bool {
    let (a, b) = graph.ends_m(edge);
    distance(a, b) >= graph.measure.min_edge * graph.edges[edge as usize].size_m
}

/// False if the new edge would come too near to a node, nearer than the old ones were.
fn keeps_distance(graph: &Graph, smooth: &Smooth, node: u32) -> bool {
    let near = graph.neighbours(node);
    let (a, b) = (near[0], near[1]);
    let [p, v, q] = [a, node, b].map(|it| graph.metres(it));
    let limit = smooth.gap * graph.size_at_m(node);
    let reach = limit / graph.measure.grid().cell_m;
    let (from, to) = (graph.point(a), graph.point(b));
    let comes_nearer = |it: u32, at: Point| {
        if it == a || it == b || it == node {
            return false;
        }
        let at = graph.measure.metres(at);
        let (gap, t) = to_segment(at, p, q);
        let is_beside = 0.0 < t && t < 1.0;
        gap < limit && is_beside && gap < to_segment(at, p, v).0.min(to_segment(at, v, q).0)
    };
    !(graph.index).any(from, to, reach, |held| {
        (0..2).any(|k| comes_nearer(held.ends[k], held.at()[k]))
    })
}

/// False if an angle at an end of the new edge would become too sharp, and sharper than before.
fn keeps_angles(graph: &Graph, smooth: &Smooth, node: u32) -> bool {
    let near = graph.neighbours(node);
    [(near[0], near[1]), (near[1], near[0])]
        .iter()
        .all(|&(end, far)| {
            graph
                .neighbours(end)
                .iter()
                .filter(|&&it| it != node)
                .all(|&it| {
                    let fresh = angle_deg(graph, end, it, far);
                    fresh >= smooth.angle_deg || fresh >= angle_deg(graph, end, it, node)
                })
        })
}
