//! Matched pairs -> the edges that change parity (the T-join).

use crate::parity::cuts::Cuts;
use crate::parity::flood::Touch;
use crate::parity::graph::Edge;
use crate::parity::graph::Graph;
use crate::parity::graph::OUTSIDE;
use crate::parity::groups::Groups;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Shortest paths between all pairs of a finished matching, an edge on two of them on none.
///
/// They run along edges without slack (complementary slackness), so only those are searched.
pub fn along_pairs(graph: &Graph, cuts: &Cuts, pairs: &[Touch]) -> Vec<bool> {
    let tight = part_of(graph, |id| cuts.slack2(&graph.edges[id]) == 0);
    let nowhere = Seen {
        stamp: 0,
        distance: 0,
        edge: 0,
    };
    let mut search = Search {
        seen: vec![nowhere; 2 * graph.odd.len()],
        stamp: 0,
        heap: BinaryHeap::new(),
    };
    let mut chosen = vec![false; tight.edges.len()];
    for pair in pairs {
        search.flip_path(&tight, *pair, &mut chosen);
    }
    in_whole(graph, &tight, chosen)
}

#[derive(Clone, Copy)]
struct Seen {
    stamp: u32,
    distance: i64,
    edge: u32,
}

/// Dijkstra from both ends at once; the arrays are kept from pair to pair.
struct Search {
    /// At `2 * node + side`.
    seen: Vec<Seen>,
    stamp: u32,
    /// (distance, node, side).
    heap: BinaryHeap<Reverse<(i64, u32, u32)>>,
}

impl Search {
    fn flip_path(&mut self, graph: &Graph, pair: Touch, chosen: &mut [bool]) {
        self.stamp += 1;
        self.heap.clear();
        self.reach(pair.from, 0, 0, u32::MAX);
        if pair.to != OUTSIDE {
            self.reach(pair.to, 1, 0, u32::MAX);
        }
        // (length, node on side 0, edge, node on side 1 or OUTSIDE)
        let mut best: Option<(i64, u32, u32, u32)> = None;
        while let Some(Reverse((distance, node, side))) = self.heap.pop() {
            let done_at = if pair.to == OUTSIDE {
                distance
            } else {
                2 * distance
            };
            if best.is_some_and(|(length, ..)| done_at >= length) {
                break;
            }
            if self.seen[(2 * node + side) as usize].distance < distance {
                continue;
            }
            for next in graph.neighbours(node) {
                let there = distance + next.weight2;
                if next.node == OUTSIDE {
                    if pair.to == OUTSIDE && best.is_none_or(|(length, ..)| there < length) {
                        best = Some((there, node, next.edge, OUTSIDE));
                    }
                    continue;
                }
                let other = self.seen[(2 * next.node + 1 - side) as usize];
                let length = there + other.distance;
                if other.stamp == self.stamp && best.is_none_or(|(least, ..)| length < least) {
                    let ends = if side == 0 {
                        [node, next.node]
                    } else {
                        [next.node, node]
                    };
                    best = Some((length, ends[0], next.edge, ends[1]));
                }
                self.reach(next.node, side, there, next.edge);
            }
        }
        let (_, left, edge, right) = best.expect("matched nodes are connected");
        chosen[edge as usize] ^= true;
        self.flip_back(graph, left, 0, chosen);
        if right != OUTSIDE {
            self.flip_back(graph, right, 1, chosen);
        }
    }

    fn reach(&mut self, node: u32, side: u32, distance: i64, edge: u32) {
        let seen = &mut self.seen[(2 * node + side) as usize];
        if seen.stamp != self.stamp || distance < seen.distance {
            *seen = Seen {
                stamp: self.stamp,
                distance,
                edge,
            };
            self.heap.push(Reverse((distance, node, side)));
        }
    }

    fn flip_back(&self, graph: &Graph, mut node: u32, side: u32, chosen: &mut [bool]) {
        loop {
            let edge = self.seen[(2 * node + side) as usize].edge;
            if edge == u32::MAX {
                return;
            }
            chosen[edge as usize] ^= true;
            let edge = &graph.edges[edge as usize];
            node = if edge.a == node { edge.b } else { edge.a };
        }
    }
}

/// The choice that makes all nodes even along a forest of the edges `taken`; `None` if they do not
/// join the odd nodes. Of a choice that is even already and has no ring, that is all.
pub fn within(graph: &Graph, cuts: &Cuts, taken: &[bool]) -> Option<Vec<bool>> {
    let part = part_of(graph, |id| taken[id]);
    if part.hopeless().is_some() {
        return None;
    }
    let chosen = along_forest(&part, cuts);
    Some(in_whole(graph, &part, chosen))
}

/// The graph with some of its edges; labels are their ids.
fn part_of(graph: &Graph, is_in: impl Fn(usize) -> bool) -> Graph {
    let edges = graph.edges.iter().enumerate();
    let edges = edges.filter(|(id, _)| is_in(*id)).map(|(id, edge)| Edge {
        label: id as u32,
        ..*edge
    });
    Graph::new(graph.odd.clone(), edges.collect())
}

/// A choice in a part of the graph, by edges of the graph.
fn in_whole(graph: &Graph, part: &Graph, chosen: Vec<bool>) -> Vec<bool> {
    let mut all = vec![false; graph.edges.len()];
    for (edge, chosen) in part.edges.iter().zip(chosen) {
        all[edge.label as usize] = chosen;
    }
    all
}

/// The choice within a spanning forest that prefers edges with little slack: what is left to do
/// when the matching ran into its limit of work.
pub fn along_forest(graph: &Graph, cuts: &Cuts) -> Vec<bool> {
    let n = graph.odd.len();
    let mut order: Vec<u32> = (0..graph.edges.len() as u32).collect();
    order.sort_by_cached_key(|&id| {
        let edge = &graph.edges[id as usize];
        (cuts.slack2(edge), edge.weight, id)
    });
    let node = |id: u32| if id == OUTSIDE { n } else { id as usize };
    let mut groups = Groups::new(n + 1);
    let mut tree: Vec<Vec<(usize, u32)>> = vec![Vec::new(); n + 1];
    for id in order {
        let edge = &graph.edges[id as usize];
        let (a, b) = (node(edge.a), node(edge.b));
        if groups.join(a as u32, b as u32) {
            tree[a].push((b, id));
            tree[b].push((a, id));
        }
    }
    // From the outside and then from the least node of each other component; leaves first.
    let mut parent: Vec<Option<(usize, u32)>> = vec![None; n + 1];
    let mut seen = vec![false; n + 1];
    let mut visited = Vec::with_capacity(n + 1);
    for root in std::iter::once(n).chain(0..n) {
        if !std::mem::replace(&mut seen[root], true) {
            let mut next = visited.len();
            visited.push(root);
            while next < visited.len() {
                for &(child, edge) in &tree[visited[next]] {
                    if !std::mem::replace(&mut seen[child], true) {
                        parent[child] = Some((visited[next], edge));
                        visited.push(child);
                    }
                }
                next += 1;
            }
        }
    }
    let mut odd: Vec<bool> = graph.odd.iter().copied().chain([false]).collect();
    let mut chosen = vec![false; graph.edges.len()];
    for &node in visited.iter().rev() {
        if let (true, Some((above, edge))) = (odd[node], parent[node]) {
            chosen[edge as usize] = true;
            odd[above] ^= true;
        }
    }
    chosen
}
