//! Triangles -> quads: a pairing of small total weight, by greedy choice, augmenting walks and
//! alternating cycles.
//!
//! Not an exact minimum (a blossom algorithm would be), but what is lost lies in long alternating
//! cycles, and the clean-up afterwards changes far more than they would. Where a perfect pairing
//! does not exist, or the walk that would make it hits itself, some triangles end with three pairs
//! and are cut at their centroids (see [`Join`]), so the result is always all quads.

use crate::geometry::quad::corner_angles_deg;
use crate::meshing::draft::Draft;
use crate::meshing::join::Join;
use crate::meshing::join::Side;
use crate::meshing::patch::Method;
use crate::meshing::triangulate::NONE;
use crate::meshing::triangulate::Triangles;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// What a triangle with three pairs costs, in the units of [`weight`] (whose range is 0 to 18).
/// Measured: 60 beats 300, which avoids them at any cost in shape.
const THREE: f64 = 60.0;

/// Most pairs changed by one alternating cycle. Eight covers the fans around any node of a
/// Delaunay triangulation of even density.
const LONGEST_CYCLE: usize = 8;

/// Pairs the triangles. Nodes below `fixed` lie on the walks for good.
pub(crate) fn pair(triangles: &Triangles, fixed: usize) -> Draft {
    join(triangles, fixed).draft(Method::Indirect)
}

/// The join behind [`pair`]. The number of triangles must be even.
pub(crate) fn join(triangles: &Triangles, fixed: usize) -> Join<'_> {
    let mut pairing = Pairing::greedy(triangles, fixed);
    pairing.augment();
    pairing.exchange();
    pairing.join
}

/// How much a quad is worth avoiding: 0 for a rectangle, 4 with a corner of 0 or 180 degrees, more
/// if it is flat at all or flat at a walk node, where smoothing cannot help.
pub(crate) fn weight(triangles: &Triangles, quad: [u32; 4], fixed: usize) -> f64 {
    let angles = corner_angles_deg(&quad.map(|node| triangles.nodes[node as usize]));
    let worst = angles
        .iter()
        .fold(0.0_f64, |worst, angle| worst.max((angle - 90.0).abs()));
    let widest = angles
        .iter()
        .fold(0.0_f64, |widest, &angle| widest.max(angle));
    let flat_on_walk = (0..4).filter(|&k| (quad[k] as usize) < fixed && angles[k] > 155.0);
    4.0 * (worst / 90.0).min(1.0).powi(2)
        + if widest > 172.0 { 6.0 } else { 0.0 }
        + 4.0 * flat_on_walk.count() as f64
}

struct Pairing<'a> {
    join: Join<'a>,
    /// Weight of the quad across each edge of each triangle.
    weights: Vec<[f64; 3]>,
}

impl<'a> Pairing<'a> {
    /// Takes the best pairs first, each if both triangles are still free.
    fn greedy(triangles: &'a Triangles, fixed: usize) -> Pairing<'a> {
        let join = Join::empty(triangles);
        let mut weights = vec![[0.0; 3]; triangles.corners.len()];
        let mut sides: Vec<(f64, Side)> = Vec::new();
        for t in 0..triangles.corners.len() as u32 {
            for k in 0..3 {
                let other = triangles.neighbours[t as usize][k];
                if other != NONE && t < other {
                    let (other, j) = join.twin((t, k));
                    let quad = Join::quad(triangles, (t, k), (other, j));
                    let w = weight(triangles, quad, fixed);
                    weights[t as usize][k] = w;
                    weights[other as usize][j] = w;
                    sides.push((w, (t, k)));
                }
            }
        }
        sides.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut pairing = Pairing { join, weights };
        for (_, side) in sides {
            let other = triangles.neighbours[side.0 as usize][side.1];
            if pairing.join.degree(side.0) == 0 && pairing.join.degree(other) == 0 {
                pairing.join.toggle(side);
            }
        }
        pairing
    }

    /// Joins the free triangles two by two along cheapest walks. Toggling a walk keeps the parity
    /// of every triangle on its way, even if it visits one twice: that is why no blossoms are
    /// needed for a valid result.
    fn augment(&mut self) {
        let count = self.join.triangles.corners.len();
        let mut reached = vec![Reached::NOT; 2 * count];
        let mut touched = Vec::new();
        for t in 0..count as u32 {
            if self.join.degree(t) == 0 {
                let last = self.walk(t, &mut reached, &mut touched);
                let mut state = last;
                while let Some(side) = reached[state].by {
                    self.join.toggle(side);
                    state = reached[state].before;
                }
                for state in touched.drain(..) {
                    reached[state] = Reached::NOT;
                }
            }
        }
    }

    /// Dijkstra from the free triangle `start` to the nearest other one. A state is
    /// `triangle << 1 | the edge it was entered by is in the join`.
    fn walk(&self, start: u32, reached: &mut [Reached], touched: &mut Vec<usize>) -> usize {
        let mut heap = BinaryHeap::new();
        let first = (start as usize) << 1;
        reached[first] = Reached {
            cost: 0.0,
            by: None,
            before: first,
        };
        touched.push(first);
        heap.push(Reverse((Cost(0.0), first)));
        while let Some(Reverse((Cost(cost), state))) = heap.pop() {
            if cost > reached[state].cost {
                continue;
            }
            let t = (state >> 1) as u32;
            let degree = self.join.degree(t);
            if degree == 0 && t != start {
                return state;
            }
            let entry = reached[state].by.map(|side| self.join.twin(side).1);
            for k in (0..3).filter(|&k| Some(k) != entry) {
                let next = self.join.triangles.neighbours[t as usize][k];
                if next == NONE {
                    continue;
                }
                let leaves_join = self.join.joined[t as usize][k];
                let both_added = entry.is_some() && state & 1 == 0 && !leaves_join && degree == 1;
                let step = if leaves_join {
                    0.0
                } else {
                    1.0 + self.weights[t as usize][k]
                };
                let total = cost + step + if both_added { THREE } else { 0.0 };
                let to = (next as usize) << 1 | usize::from(leaves_join);
                if total < reached[to].cost && next != start {
                    if reached[to].cost.is_infinite() {
                        touched.push(to);
                    }
                    reached[to] = Reached {
                        cost: total,
                        by: Some((t, k)),
                        before: state,
                    };
                    heap.push(Reverse((Cost(total), to)));
                }
            }
        }
        unreachable!("an even number of triangles in one connected sub-domain");
    }

    /// Toggles alternating cycles that lower the weight, until none of at most [`LONGEST_CYCLE`]
    /// pairs does (or four rounds are over: the gains of a fifth were below 0.1 %).
    fn exchange(&mut self) {
        for _ in 0..4 {
            let mut improved = false;
            for t in 0..self.join.triangles.corners.len() as u32 {
                if let Some(partner) = self.partner(t) {
                    let gain = self.weights[t as usize][partner];
                    let mut cycle = vec![(t, partner)];
                    let beyond = self.join.triangles.neighbours[t as usize][partner];
                    if self.partner(beyond).is_some() && self.close(t, beyond, gain, &mut cycle) {
                        for side in cycle {
                            self.join.toggle(side);
                        }
                        improved = true;
                    }
                }
            }
            if !improved {
                break;
            }
        }
    }

    /// The edge of `t` in the join, if it is the only one.
    fn partner(&self, t: u32) -> Option<usize> {
        let joined = self.join.joined[t as usize];
        let single = self.join.degree(t) == 1;
        single.then(|| (0..3).find(|&k| joined[k]).expect("one"))
    }

    /// Depth-first search for a closing of the alternating path `first .. last` whose total gain
    /// is positive. Every positive cycle has a rotation with positive partial gains, so paths that
    /// have lost all gain are dropped.
    fn close(&self, first: u32, last: u32, gain: f64, cycle: &mut Vec<Side>) -> bool {
        for k in (0..3).filter(|&k| !self.join.joined[last as usize][k]) {
            let next = self.join.triangles.neighbours[last as usize][k];
            let left = gain - self.weights[last as usize][k];
            if next == NONE || left <= 1e-9 {
                continue;
            }
            cycle.push((last, k));
            if next == first {
                return true;
            }
            let passed = |&(t, _): &Side| t == next;
            if cycle.len() < 2 * LONGEST_CYCLE
                && !cycle.iter().any(passed)
                && let Some(partner) = self.partner(next)
            {
                let beyond = self.join.triangles.neighbours[next as usize][partner];
                if self.partner(beyond).is_some() && beyond != first {
                    cycle.push((next, partner));
                    let regained = left + self.weights[next as usize][partner];
                    if self.close(first, beyond, regained, cycle) {
                        return true;
                    }
                    cycle.pop();
                }
            }
            cycle.pop();
        }
        false
    }
}

/// How Dijkstra came to a state.
#[derive(Clone, Copy)]
struct Reached {
    cost: f64,
    /// The edge crossed, seen from the triangle before.
    by: Option<Side>,
    before: usize,
}

impl Reached {
    const NOT: Reached = Reached {
        cost: f64::INFINITY,
        by: None,
        before: 0,
    };
}

/// A cost in a heap. Costs are never NaN.
#[derive(Clone, Copy, PartialEq)]
struct Cost(f64);

impl Eq for Cost {}

impl PartialOrd for Cost {
    fn partial_cmp(&self, other: &Cost) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cost {
    fn cmp(&self, other: &Cost) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::patch::Loops;
    use crate::meshing::triangulate::triangulate;
    use crate::meshing::visits::Visits;

    /// A square of `n` by `n` cells of side 1 whose inner nodes are shifted by a fixed pattern.
    fn shaken(n: u32, seed: u64) -> Triangles {
        let mut walk = Vec::new();
        for k in 0..n {
            walk.push([f64::from(k), 0.0]);
        }
        for k in 0..n {
            walk.push([f64::from(n), f64::from(k)]);
        }
        for k in 0..n {
            walk.push([f64::from(n - k), f64::from(n)]);
        }
        for k in 0..n {
            walk.push([0.0, f64::from(n - k)]);
        }
        let mut state = seed;
        let mut shift = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            ((state >> 40) as f64 / (1_u64 << 24) as f64 - 0.5) * 0.9
        };
        let inner: Vec<_> = (0..(n - 1) * (n - 1))
            .map(|k| {
                let (x, y) = (k % (n - 1) + 1, k / (n - 1) + 1);
                [f64::from(x) + shift(), f64::from(y) + shift()]
            })
            .collect();
        let count = walk.len();
        let loops = Loops {
            nodes: walk,
            walks: vec![(0..count as u32).collect()],
            size_m: 1.0,
            lattice_origin: None,
            on_seam: vec![vec![false; count]],
            across_m: Vec::new(),
        };
        triangulate(&Visits::of(&loops), &inner).expect("a square is planar")
    }

    /// The slow twin: the least weight over all joins, by trying both answers for every edge.
    fn least(join: &mut Join, weights: &[[f64; 3]], from: u32, so_far: f64, best: &mut f64) {
        if so_far >= *best {
            return;
        }
        let triangles = join.triangles;
        let all = 0..triangles.corners.len() as u32;
        // Edges are decided at their lower triangle, so a triangle is complete once passed.
        let Some(t) = all.clone().find(|&t| t >= from) else {
            if all.clone().all(|t| join.degree(t) % 2 == 1) {
                *best = so_far;
            }
            return;
        };
        let up: Vec<usize> = (0..3)
            .filter(|&k| {
                let other = triangles.neighbours[t as usize][k];
                other != NONE && other > t
            })
            .collect();
        for choice in 0..1_u32 << up.len() {
            let taken = || {
                up.iter()
                    .enumerate()
                    .filter(|(bit, _)| choice >> bit & 1 == 1)
            };
            for (_, &k) in taken() {
                join.toggle((t, k));
            }
            if join.degree(t) % 2 == 1 {
                let edges: f64 = taken().map(|(_, &k)| weights[t as usize][k]).sum();
                let three = if join.degree(t) == 3 { THREE } else { 0.0 };
                least(join, weights, t + 1, so_far + edges + three, best);
            }
            for (_, &k) in taken() {
                join.toggle((t, k));
            }
        }
    }

    fn total(join: &Join, weights: &[[f64; 3]]) -> f64 {
        let mut sum = 0.0;
        for t in 0..join.joined.len() {
            assert_eq!(
                join.degree(t as u32) % 2,
                1,
                "every triangle has one or three"
            );
            let edges = (0..3).filter(|&k| join.joined[t][k]);
            sum += edges.map(|k| 0.5 * weights[t][k]).sum::<f64>();
            sum += if join.degree(t as u32) == 3 {
                THREE
            } else {
                0.0
            };
        }
        sum
    }

    #[test]
    fn pairing_is_close_to_the_slow_twin() {
        for seed in 0..12 {
            let triangles = shaken(4, seed);
            let weights = Pairing::greedy(&triangles, triangles.visits).weights;
            let ours = total(&join(&triangles, triangles.visits), &weights);
            let mut best = f64::INFINITY;
            least(&mut Join::empty(&triangles), &weights, 0, 0.0, &mut best);
            assert!(
                ours >= best - 1e-9 && ours < 1.02 * best + 0.5,
                "{ours} against {best}"
            );
        }
    }

    #[test]
    fn tree_join_exists_for_any_even_number_of_triangles() {
        for seed in 0..5 {
            let triangles = shaken(9, seed);
            let join = Join::along_tree(&triangles);
            for t in 0..triangles.corners.len() as u32 {
                assert_eq!(join.degree(t) % 2, 1);
            }
        }
    }
}
