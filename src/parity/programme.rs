//! Goals -> free rounding and the dual graph: what remains to be decided is parity.

use crate::intervals::goals::Goals;
use crate::parity::error::Error;
use crate::parity::graph::Edge;
use crate::parity::graph::Graph;
use crate::parity::graph::OUTSIDE;
use crate::partition::subdomains;
use crate::partition::subdomains::Partition;

/// Costs are whole numbers of this part of one: bounds and proofs are then exact.
pub const COST_UNIT: f64 = 1e-6;

/// The programme after the exact reduction to parity.
pub struct Programme {
    /// The cheapest count of each curve.
    pub rounded: Vec<u32>,
    /// The cheapest count of the other parity; equal to `rounded` if there is none.
    pub other: Vec<u32>,
    /// What `rounded` costs, [`COST_UNIT`]s.
    pub base: i64,
    /// Odd sub-domains of `rounded`, and what changing each curve costs; labels are curves.
    pub graph: Graph,
}

/// What `n` intervals on `curve` cost, in whole [`COST_UNIT`]s.
pub fn cost_units(goals: &Goals, curve: usize, n: u32) -> i64 {
    (goals.cost(curve, n) / COST_UNIT).round() as i64
}

impl Programme {
    /// Reduces the programme of all counts to a choice of edges of the dual graph.
    pub fn new(partition: &Partition, goals: &Goals) -> Result<Programme, Error> {
        let n = partition.curves.len();
        let mut odd = vec![false; partition.subdomains.len()];
        let mut edges = Vec::new();
        let (mut rounded, mut other) = (Vec::with_capacity(n), Vec::with_capacity(n));
        let mut base = 0;
        for (id, curve) in partition.curves.iter().enumerate() {
            let (lower, upper) = (goals.lower[id], goals.upper[id]);
            if lower > upper || lower == 0 {
                return Err(Error::Bounds {
                    curve: id as u32,
                    lower,
                    upper,
                });
            }
            let count = cheapest(goals, id);
            let flipped = cheapest_neighbour(goals, id, count);
            base += cost_units(goals, id, count);
            rounded.push(count);
            other.push(flipped);
            let [a, b] = [curve.left, curve.right].map(|side| match side {
                subdomains::OUTSIDE => OUTSIDE,
                inside => inside,
            });
            // A free line counts twice in its sub-domain and never matters.
            if a == b {
                continue;
            }
            for side in [a, b] {
                if side != OUTSIDE {
                    odd[side as usize] ^= count % 2 == 1;
                }
            }
            if flipped != count {
                let weight = cost_units(goals, id, flipped) - cost_units(goals, id, count);
                edges.push(Edge {
                    a,
                    b,
                    weight,
                    label: id as u32,
                });
            }
        }
        let graph = Graph::new(odd, edges);
        match graph.hopeless() {
            Some((subdomain, members)) => Err(Error::Infeasible { subdomain, members }),
            None => Ok(Programme {
                rounded,
                other,
                base,
                graph,
            }),
        }
    }

    /// The counts that a choice of edges stands for.
    pub fn counts(&self, chosen: &[bool]) -> Vec<u32> {
        let mut counts = self.rounded.clone();
        for (edge, _) in self
            .graph
            .edges
            .iter()
            .zip(chosen)
            .filter(|(_, chosen)| **chosen)
        {
            counts[edge.label as usize] = self.other[edge.label as usize];
        }
        counts
    }
}

/// The cheapest count within bounds; the lower one of two. Costs are convex with their minimum at
/// the goal, so only its two neighbours count.
fn cheapest(goals: &Goals, curve: usize) -> u32 {
    let (lower, upper) = (goals.lower[curve], goals.upper[curve]);
    let below = (goals.goal[curve].floor() as u32).clamp(lower, upper);
    let above = (below + 1).min(upper);
    match cost_units(goals, curve, above) < cost_units(goals, curve, below) {
        true => above,
        false => below,
    }
}

/// The cheaper of the counts next to the cheapest one; by convexity the best of other parity.
fn cheapest_neighbour(goals: &Goals, curve: usize, count: u32) -> u32 {
    let less = (count > goals.lower[curve]).then(|| count - 1);
    let more = (count < goals.upper[curve]).then_some(count + 1);
    match (less, more) {
        (Some(less), Some(more)) => {
            match cost_units(goals, curve, less) <= cost_units(goals, curve, more) {
                true => less,
                false => more,
            }
        }
        (one, another) => one.or(another).unwrap_or(count),
    }
}
