//! Closes what is too narrow for the mesh: short edges are contracted, nodes that nearly touch an
//! edge are joined to it. The narrowest first, until nothing is left that may be closed.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::cleanup::graph::Graph;
use crate::cleanup::importance::Importance;
use crate::cleanup::importance::is_rim_corner;
use crate::cleanup::measure::RIM_RANK;
use crate::cleanup::measure::distance;
use crate::cleanup::measure::to_segment;
use crate::cleanup::operate::Bend;
use crate::cleanup::steps::Step;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::geometry::predicates::orient;
use smallvec::SmallVec;

/// What counts as too narrow, in shares of the local mesh size.
#[derive(Clone, Copy, Debug)]
pub(super) struct Narrow {
    /// Edges shorter than this are contracted.
    pub(super) edge: f64,
    /// Nodes nearer than this to an edge that is not theirs are joined to it.
    pub(super) gap: f64,
    /// The same for ends of lines.
    pub(super) end: f64,
    /// How much of the tolerance may be used.
    pub(super) share: f64,
}

impl Narrow {
    /// How near an edge may be to a node that is not its own.
    fn of(&self, graph: &Graph, node: u32) -> f64 {
        match graph.degree(node) {
            1 => self.end,
            _ => self.gap,
        }
    }
}

/// Edges within tolerance of several ways around could be bent to and fro without end; this many
/// steps at one node are enough for all honest work.
const TRIES_MAX: u8 = 16;

/// Where a node and an edge are farther apart than this share of the mesh size, both move.
const MEET_EDGE: f64 = 0.2;
/// The same for two nodes.
const MEET_NODES: f64 = 0.26;

/// A node too near to something.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Conflict {
    /// Distance over what it should be, below one.
    ratio: f64,
    with: With,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum With {
    /// The other end of one of its edges, too short.
    Neighbour(u32),
    /// An edge that is not its own.
    Edge(u32),
}

/// Nodes by the narrowest of their conflicts, as far as known; ties by place.
struct Queue {
    heap: BinaryHeap<Reverse<(u64, Point, u32)>>,
    /// The key under which each node waits; all other entries of it are stale.
    key: Vec<u64>,
}

const NOT_WAITING: u64 = u64::MAX;

impl Queue {
    fn push(&mut self, graph: &Graph, node: u32, ratio: f64) {
        self.key.resize(graph.at.len(), NOT_WAITING);
        // ratios are positive: their bits are in their order
        let key = ratio.to_bits();
        if key < self.key[node as usize] {
            self.key[node as usize] = key;
            self.heap.push(Reverse((key, graph.point(node), node)));
        }
    }

    fn pop(&mut self) -> Option<(f64, u32)> {
        while let Some(Reverse((key, _, node))) = self.heap.pop() {
            if self.key[node as usize] == key {
                self.key[node as usize] = NOT_WAITING;
                return Some((f64::from_bits(key), node));
            }
        }
        None
    }
}

/// Closes all that is too narrow around `nodes`, and may be closed.
pub(super) fn separate(graph: &mut Graph, narrow: &Narrow, nodes: &[u32]) {
    if !graph.measure.does(Step::Separate) {
        return;
    }
    let mut queue = Queue {
        heap: BinaryHeap::new(),
        key: Vec::new(),
    };
    for &node in nodes {
        push(graph, narrow, node, &mut queue);
    }
    // of all nodes each one sees its own conflicts
    if nodes.len() < graph.at.len() / 2 {
        let stars = nodes.iter().flat_map(|&node| &graph.star[node as usize]);
        let mut edges: Vec<u32> = stars.copied().collect();
        edges.sort_unstable();
        edges.dedup();
        for edge in edges {
            push_beside(graph, narrow, edge, &mut queue);
        }
    }
    let mut tries = vec![0_u8; graph.at.len()];
    while let Some((ratio, node)) = queue.pop() {
        if tries[node as usize] == TRIES_MAX {
            continue;
        }
        let conflicts = conflicts(graph, narrow, node);
        let Some(first) = conflicts.first() else {
            continue;
        };
        if first.ratio > ratio {
            queue.push(graph, node, first.ratio);
            continue;
        }
        let mark = graph.changed.len();
        let resolved = (conflicts.iter()).find_map(|it| resolve(graph, narrow, node, it.with));
        if let Some(centre) = resolved {
            tries.resize(graph.at.len(), 0);
            let tried = tries[node as usize].max(tries[centre as usize]) + 1;
            (tries[node as usize], tries[centre as usize]) = (tried, tried);
            push(graph, narrow, centre, &mut queue);
            push_beside_changed(graph, narrow, mark, &mut queue);
        }
    }
}

fn push(graph: &Graph, narrow: &Narrow, node: u32, queue: &mut Queue) {
    let mut least = f64::INFINITY;
    each_conflict(graph, narrow, node, |it| least = least.min(it.ratio));
    if least < f64::INFINITY {
        queue.push(graph, node, least);
    }
}

/// Queues all nodes beside edges that changed since `changed` had this length. Beside the other
/// edges of the same nodes all is as it was, and what failed there would nearly always fail again.
fn push_beside_changed(graph: &Graph, narrow: &Narrow, mark: usize, queue: &mut Queue) {
    let mut edges: SmallVec<[u32; 16]> = graph.changed[mark..].into();
    edges.sort_unstable();
    edges.dedup();
    for edge in edges {
        if graph.is_there(edge) {
            push_beside(graph, narrow, edge, queue);
        }
    }
}

/// Queues the ends of an edge if it is too short, and all nodes that it is too near to.
fn push_beside(graph: &Graph, narrow: &Narrow, edge: u32, queue: &mut Queue) {
    let it = &graph.edges[edge as usize];
    let (a_m, b_m) = graph.ends_m(edge);
    let ratio = distance(a_m, b_m) / (narrow.edge * it.size_m);
    if ratio < 1.0 {
        it.ends
            .iter()
            .for_each(|&end| queue.push(graph, end, ratio));
    }
    let reach = narrow.gap.max(narrow.end) * it.size_m;
    let reach = reach / graph.measure.grid().cell_m;
    let [a, b] = it.ends.map(|node| graph.point(node));
    graph.index.each_node_near(a, b, reach, |node| {
        if !it.ends.contains(&node)
            && let Some(ratio) = gap_ratio(graph, narrow, node, edge)
        {
            queue.push(graph, node, ratio);
        }
    });
}

/// How narrow the gap between a node and an edge that is not its own is, if it is too narrow.
fn gap_ratio(graph: &Graph, narrow: &Narrow, node: u32, edge: u32) -> Option<f64> {
    let size_m = graph.size_at_m(node);
    let limit = narrow.of(graph, node) * size_m.min(graph.edges[edge as usize].size_m);
    gap_below_m(graph, node, edge, limit)
        .map(|(gap, _)| gap / limit)
        .filter(|&ratio| ratio < 1.0)
}

/// All conflicts of a node, the narrowest first.
fn conflicts(graph: &Graph, narrow: &Narrow, node: u32) -> SmallVec<[Conflict; 4]> {
    let mut conflicts: SmallVec<[Conflict; 4]> = SmallVec::new();
    each_conflict(graph, narrow, node, |it| conflicts.push(it));
    // neighbours tie in the order of the star, edges in that of their ids
    let tie = |it: &Conflict| match it.with {
        With::Neighbour(_) => 0,
        With::Edge(edge) => edge + 1,
    };
    conflicts.sort_by(|a, b| (a.ratio.total_cmp(&b.ratio)).then(tie(a).cmp(&tie(b))));
    conflicts.dedup();
    conflicts
}

/// Tells of all conflicts of a node, in no order that means anything but that of the neighbours, and
/// of some twice.
fn each_conflict(graph: &Graph, narrow: &Narrow, node: u32, mut tell: impl FnMut(Conflict)) {
    if graph.degree(node) == 0 {
        return;
    }
    let at = graph.metres(node);
    for &edge in &graph.star[node as usize] {
        let other = graph.edges[edge as usize].other(node);
        let limit = narrow.edge * graph.edges[edge as usize].size_m;
        let length = distance(at, graph.metres(other));
        if length < limit {
            tell(Conflict {
                ratio: length / limit,
                with: With::Neighbour(other),
            });
        }
    }
    let reach = narrow.of(graph, node) * graph.size_at_m(node);
    let reach = reach / graph.measure.grid().cell_m;
    graph
        .index
        .each_edge_near(node, graph.point(node), reach, |held| {
            if let Some(ratio) = gap_ratio(graph, narrow, node, held.edge) {
                let with = With::Edge(held.edge);
                tell(Conflict { ratio, with });
            }
        });
}

/// Distance from a node to an edge that is not its own, if the domain lies between them; `None`
/// also if the nearest place of the edge is a neighbour of the node.
pub(super) fn gap_m(graph: &Graph, node: u32, edge: u32) -> Option<f64> {
    gap_below_m(graph, node, edge, f64::INFINITY).map(|it| it.0)
}

/// [`gap_m`] if it is below the limit, and where the nearest place lies on the edge, in 0..1; what is far is told so by
/// its bounding box.
#[inline]
pub(super) fn gap_below_m(graph: &Graph, node: u32, edge: u32, limit_m: f64) -> Option<(f64, f64)> {
    let it = &graph.edges[edge as usize];
    let at = graph.metres(node);
    let (a, b) = graph.ends_m(edge);
    if it.ends.contains(&node) || !is_beside(at, a, b, limit_m) {
        return None;
    }
    let (gap, t) = to_segment(at, a, b);
    if gap >= limit_m {
        return None;
    }
    let [p, q] = it.ends.map(|end| graph.point(end));
    let side = orient(p, q, graph.point(node));
    if (side > 0 && !it.inside[0]) || (side < 0 && !it.inside[1]) {
        return None;
    }
    let end = if t <= 0.0 {
        it.ends[0]
    } else if t >= 1.0 {
        it.ends[1]
    } else {
        return Some((gap, t));
    };
    graph.find(node, end).is_none().then_some((gap, t))
}

/// True if `p` is in the bounding box of the segment `a b`, wider by `reach` on all sides.
#[inline]
pub(super) fn is_beside(p: Xy, a: Xy, b: Xy, reach: f64) -> bool {
    // one branch for all four
    let is_between = |k: usize| (a[k].min(b[k]) - reach <= p[k]) & (p[k] <= a[k].max(b[k]) + reach);
    is_between(0) & is_between(1)
}

/// Closes one conflict; returns the node in the middle of what changed.
fn resolve(graph: &mut Graph, narrow: &Narrow, node: u32, with: With) -> Option<u32> {
    match with {
        With::Neighbour(other) => unite(graph, node, other, narrow.share, "short-edge"),
        With::Edge(edge) => join(graph, node, edge, narrow.edge, narrow.share),
    }
}

/// Makes one node of two: the less important one moves, or else the other, or else both.
pub(super) fn unite(
    graph: &mut Graph,
    u: u32,
    v: u32,
    share: f64,
    what: &'static str,
) -> Option<u32> {
    let (keep, give) = if Importance::of(graph, u) < Importance::of(graph, v) {
        (v, u)
    } else {
        (u, v)
    };
    // a corner of the outline only gives way to another one
    if is_rim_corner(graph, give) && !is_rim_corner(graph, keep) {
        return None;
    }
    let moved = distance(graph.metres(u), graph.metres(v));
    let wide = moved > MEET_NODES * graph.size_at_m(keep);
    if wide && let Some(met) = meet(graph, keep, give, share) {
        graph.note(what, graph.point(met), 0.5 * moved);
        return Some(met);
    }
    if graph.merge(give, keep, share) {
        graph.note(what, graph.point(keep), moved);
        return Some(keep);
    }
    if is_rim_corner(graph, keep) && !is_rim_corner(graph, give) {
        return None;
    }
    if graph.merge(keep, give, share) {
        graph.note(what, graph.point(give), moved);
        return Some(give);
    }
    if !wide && let Some(met) = meet(graph, keep, give, share) {
        graph.note(what, graph.point(met), 0.5 * moved);
        return Some(met);
    }
    None
}

/// Makes one node of two, half way between them.
fn meet(graph: &mut Graph, keep: u32, give: u32, share: f64) -> Option<u32> {
    let place = middle(graph.point(keep), graph.point(give));
    if is_rim_corner(graph, keep) {
        return None;
    }
    graph.attempt(|graph| {
        let is_met = graph.shift(keep, place, share) && graph.merge(give, keep, share);
        is_met.then_some(keep)
    })
}

fn middle(a: Point, b: Point) -> Point {
    let half = |u: i32, v: i32| ((i64::from(u) + i64::from(v)).div_euclid(2)) as i32;
    Point::new(half(a.x, b.x), half(a.y, b.y))
}

/// Joins a node to an edge that passes it: with the nearer end if that is near, else the node moves
/// to its foot, or the edge bends to the node, whichever is the less important.
pub(super) fn join(graph: &mut Graph, node: u32, edge: u32, near: f64, share: f64) -> Option<u32> {
    if !graph.is_there(edge) {
        return None;
    }
    let it = &graph.edges[edge as usize];
    let (ends, rank, size_m) = (it.ends, it.rank, it.size_m);
    let (a, b) = graph.ends_m(edge);
    let at = graph.metres(node);
    let (gap, t) = to_segment(at, a, b);
    let length = distance(a, b);
    let (end, beside) = if t < 0.5 {
        (ends[0], t * length)
    } else {
        (ends[1], (1.0 - t) * length)
    };
    let what = if graph.degree(node) == 1 {
        "joined-end"
    } else {
        "closed-gap"
    };
    if beside < near * size_m
        && let Some(united) = unite(graph, node, end, share, what)
    {
        return Some(united);
    }
    if t <= 0.0 || t >= 1.0 {
        return None;
    }
    let foot = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
    let place = graph.point(node);
    let moves = !is_rim_corner(graph, node);
    if moves && gap > MEET_EDGE * size_m && graph.degree(node) > 1 && rank < RIM_RANK {
        let half_way = [0.5 * (at[0] + foot[0]), 0.5 * (at[1] + foot[1])];
        if let Some(landed) = land(graph, node, edge, half_way, share) {
            graph.note(what, place, 0.5 * gap);
            return Some(landed);
        }
    }
    let bends = !moves || Importance::of(graph, node).rank > rank;
    if bends && graph.bend(edge, Bend::To(node), share).is_some() {
        graph.note(what, place, gap);
        return Some(node);
    }
    if moves && let Some(landed) = land(graph, node, edge, foot, share) {
        graph.note(what, place, gap);
        return Some(landed);
    }
    if moves && !bends && graph.bend(edge, Bend::To(node), share).is_some() {
        graph.note(what, place, gap);
        return Some(node);
    }
    None
}

/// Moves a node to `place`, and the edge too.
fn land(graph: &mut Graph, node: u32, edge: u32, place: Xy, share: f64) -> Option<u32> {
    let p = graph.measure.on_grid(place);
    // else the edge would be bent in vain
    if !graph.would_fit(node, p, share) {
        return None;
    }
    graph.attempt(|graph| {
        let there = graph.bend(edge, Bend::At(p), share)?;
        graph.merge(node, there, share).then_some(there)
    })
}
