//! Goals -> free rounding and the dual graph: what remains to be decided is parity.

use crate::intervals::goals::Goals;
use crate::parity::error::Error;
use crate::parity::graph::Edge;
use crate::parity::graph::Graph;
use crate::parity::graph::OUTSIDE;
use crate::partition::subdomains;
use crate::partition::subdomains::Partition;
use crate::partition::subdomains::SubdomainId;

/// Costs are whole numbers of this part of one: bounds and proofs are then exact.
pub const COST_UNIT: f64 = 1e-6;

/// The programme after the reduction to a choice of edges.
pub struct Programme {
    /// The cheaper of two counts of each curve.
    pub rounded: Vec<u32>,
    /// The other one, of other parity; equal to `rounded` if the count is fixed.
    pub other: Vec<u32>,
    /// Odd nodes of `rounded`, and what changing each curve costs; labels are curves, from
    /// `rounded.len()` on blocks.
    pub graph: Graph,
}

/// What `n` intervals on `curve` cost, in whole [`COST_UNIT`]s.
pub fn cost_units(goals: &Goals, curve: usize, n: u32) -> i64 {
    units(goals.cost(curve, n))
}

/// A cost in whole [`COST_UNIT`]s.
pub fn units(cost: f64) -> i64 {
    (cost / COST_UNIT).round() as i64
}

/// What `counts` cost, in whole [`COST_UNIT`]s.
pub fn total_units(goals: &Goals, counts: &[u32]) -> i64 {
    let curves = counts.iter().enumerate();
    curves.map(|(curve, &n)| cost_units(goals, curve, n)).sum()
}

/// The cheapest count of each curve by itself.
pub fn free_rounding(goals: &Goals) -> Result<Vec<u32>, Error> {
    let conflict = |&curve: &usize| goals.lower[curve].max(1) > goals.upper[curve];
    if let Some(id) = (0..goals.goal.len()).find(conflict) {
        let (curve, lower, upper) = (id as u32, goals.lower[id], goals.upper[id]);
        return Err(Error::Bounds {
            curve,
            lower,
            upper,
        });
    }
    Ok((0..goals.goal.len())
        .map(|curve| cheapest(goals, curve))
        .collect())
}

impl Programme {
    /// The choice between the counts `near` and, for each curve, the cheaper of the two next to
    /// it. For the [`free_rounding`] this loses nothing as to parity: costs are convex.
    ///
    /// `worth` is the price of a block whose opposite sides differ in parity, in units; at 0 blocks
    /// are like any other sub-domains.
    pub fn new(
        partition: &Partition,
        goals: &Goals,
        near: &[u32],
        worth: i64,
    ) -> Result<Programme, Error> {
        let halves = Halves::of(partition, goals, worth > 0);
        let mut odd = vec![false; halves.nodes];
        let mut edges = Vec::new();
        let (mut rounded, mut other) = (Vec::new(), Vec::new());
        for (id, &count) in near.iter().enumerate() {
            let next = cheapest_neighbour(goals, id, count);
            let costs = [count, next].map(|n| cost_units(goals, id, n));
            let swap = costs[1] < costs[0];
            let (count, next) = if swap { (next, count) } else { (count, next) };
            rounded.push(count);
            other.push(next);
            // A free line counts twice in its sub-domain and never matters.
            let [a, b] = halves.ends[id];
            if a == b {
                continue;
            }
            for node in [a, b] {
                if node != OUTSIDE {
                    odd[node as usize] ^= count % 2 == 1;
                }
            }
            if next != count {
                let weight = costs[0].abs_diff(costs[1]) as i64;
                let label = id as u32;
                edges.push(Edge {
                    a,
                    b,
                    weight,
                    label,
                });
            }
        }
        for (k, &[a, b]) in halves.bridges.iter().enumerate() {
            let label = (near.len() + k) as u32;
            edges.push(Edge {
                a,
                b,
                weight: worth,
                label,
            });
        }
        let graph = Graph::new(odd, edges);
        match graph.hopeless(partition.subdomains.len() as u32) {
            Some((subdomain, members)) => Err(Error::Infeasible { subdomain, members }),
            None => Ok(Programme {
                rounded,
                other,
                graph,
            }),
        }
    }

    /// The counts that a choice of edges stands for.
    pub fn counts(&self, chosen: &[bool]) -> Vec<u32> {
        let mut counts = self.rounded.clone();
        let edges = self.graph.edges.iter().zip(chosen);
        for (edge, _) in edges.filter(|(_, chosen)| **chosen) {
            let curve = edge.label as usize;
            if curve < counts.len() {
                counts[curve] = self.other[curve];
            }
        }
        counts
    }
}

/// The nodes of the graph: a sub-domain is one, a block two, for its two pairs of opposite sides.
///
/// The halves of a block are joined by a bridge. Both even: opposite sides agree in parity. Both
/// odd: the bridge is taken and its price paid. One odd: the block is odd, which cannot be. So the
/// wish for equal opposite sides is, as far as parity sees it, an edge of the same T-join.
struct Halves {
    nodes: usize,
    /// The nodes on the two sides of each curve.
    ends: Vec<[u32; 2]>,
    /// The two halves of each block.
    bridges: Vec<[u32; 2]>,
}

impl Halves {
    fn of(partition: &Partition, goals: &Goals, split: bool) -> Halves {
        let subdomains = partition.subdomains.len();
        let mut halves = Halves {
            nodes: subdomains,
            ends: (partition.curves.iter())
                .map(|curve| [curve.left, curve.right].map(node_of))
                .collect(),
            bridges: Vec::new(),
        };
        if !split {
            return halves;
        }
        for (k, block) in goals.blocks.iter().enumerate() {
            let second = (subdomains + k) as u32;
            for &curve in block.sides[1].iter().chain(&block.sides[3]) {
                for end in &mut halves.ends[curve as usize] {
                    if *end == block.subdomain {
                        *end = second;
                    }
                }
            }
            halves.bridges.push([block.subdomain, second]);
        }
        halves.nodes += halves.bridges.len();
        halves
    }
}

fn node_of(side: SubdomainId) -> u32 {
    if side == subdomains::OUTSIDE {
        OUTSIDE
    } else {
        side
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

/// The cheaper of the counts next to `count`; `count` itself if it is fixed.
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
