//! Goals -> free rounding and the dual graph: what remains to be decided is parity.

use crate::intervals::goals::Goals;
use crate::intervals::goals::has_halves;
use crate::parity::error::Error;
use crate::parity::graph::Edge;
use crate::parity::graph::Graph;
use crate::parity::graph::OUTSIDE;
use crate::parity::tilts::Tilts;
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
    /// What `rounded` costs, with the tilt and its constant, units.
    pub base: i64,
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

/// Refuses bounds that no count satisfies.
pub fn expect_bounds(goals: &Goals) -> Result<(), Error> {
    let conflict = |&curve: &usize| goals.lower[curve].max(1) > goals.upper[curve];
    match (0..goals.goal.len()).find(conflict) {
        None => Ok(()),
        Some(id) => Err(Error::Bounds {
            curve: id as u32,
            lower: goals.lower[id],
            upper: goals.upper[id],
        }),
    }
}

/// The best count of each parity: (count, cost with tilt), the cheaper first; no second one if the
/// count is fixed.
fn choice(goals: &Goals, curve: usize, tilt: i64) -> ((u32, i64), Option<(u32, i64)>) {
    let (lower, upper) = (goals.lower[curve], goals.upper[curve]);
    let start = goals.cheapest(curve, tilt as f64 * COST_UNIT) as u32;
    let mut best: [Option<(i64, u32)>; 2] = [None, None];
    // Costs are convex but for half a unit of rounding each: where one exceeds that of a count met
    // before, of the same parity, by more than two, nothing beyond is cheaper.
    let mut look = |n: u32| {
        let cost = cost_units(goals, curve, n) + tilt * i64::from(n);
        let slot = &mut best[(n % 2) as usize];
        let is_beyond = slot.is_some_and(|least| cost > least.0 + 2);
        if slot.is_none_or(|least| (cost, n) < least) {
            *slot = Some((cost, n));
        }
        !is_beyond
    };
    let _up = (start..=upper).take_while(|&n| look(n)).count();
    let _down = (lower..start).rev().take_while(|&n| look(n)).count();
    let named = |(cost, n): (i64, u32)| (n, cost);
    match best {
        [Some(even), Some(odd)] => (named(even.min(odd)), Some(named(even.max(odd)))),
        [one, another] => (
            named(one.or(another).expect("bounds were compared before")),
            None,
        ),
    }
}

impl Programme {
    /// The choice between the best counts of either parity, which loses nothing as to parity. With
    /// `tilts`, blocks are halved where their sides ask for it; without, they are like any other
    /// sub-domains.
    pub fn new(
        partition: &Partition,
        goals: &Goals,
        tilts: Option<&Tilts>,
    ) -> Result<Programme, Error> {
        expect_bounds(goals)?;
        let halves = Halves::of(partition, goals, tilts);
        let mut odd = vec![false; halves.nodes];
        let mut edges = Vec::new();
        let (mut rounded, mut other) = (Vec::new(), Vec::new());
        let mut base = tilts.map_or(0, |tilts| tilts.constant);
        for (id, &[a, b]) in halves.ends.iter().enumerate() {
            let tilt = tilts.map_or(0, |tilts| tilts.slope[id]);
            let (mine, next) = choice(goals, id, tilt);
            base += mine.1;
            rounded.push(mine.0);
            other.push(next.map_or(mine.0, |next| next.0));
            // A free line counts twice in its sub-domain and never matters.
            if a == b {
                continue;
            }
            for node in [a, b] {
                if node != OUTSIDE {
                    odd[node as usize] ^= mine.0 % 2 == 1;
                }
            }
            if let Some(next) = next {
                edges.push(Edge {
                    a,
                    b,
                    weight: next.1 - mine.1,
                    label: id as u32,
                });
            }
        }
        edges.extend(&halves.bridges);
        let graph = Graph::new(odd, edges);
        match graph.hopeless() {
            Some(nodes) => Err(infeasible(partition, nodes)),
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

/// The error of a group of nodes that cannot be even.
fn infeasible(partition: &Partition, nodes: Vec<u32>) -> Error {
    let mut subdomains = nodes;
    // Beyond come the second halves of blocks.
    subdomains.retain(|&node| (node as usize) < partition.subdomains.len());
    let within = |side: u32| subdomains.binary_search(&side).is_ok();
    let around = (partition.curves.iter().enumerate())
        .filter(|(_, curve)| within(curve.left) != within(curve.right));
    let fixed = around.map(|(id, _)| id as u32).collect();
    Error::Infeasible { subdomains, fixed }
}

/// The nodes of the graph: a sub-domain is one, a block of four or six sides two, for its sides of
/// even and odd number.
///
/// The halves of a block are joined by a bridge. Both even: the pattern is possible. Both odd: the
/// bridge is taken and its price paid. One odd: the block is odd, which cannot be. So the wish for
/// a pattern is, as far as parity sees it, an edge of the same T-join.
struct Halves {
    nodes: usize,
    /// The nodes on the two sides of each curve.
    ends: Vec<[u32; 2]>,
    /// Between the two halves of each block that has them.
    bridges: Vec<Edge>,
}

impl Halves {
    fn of(partition: &Partition, goals: &Goals, tilts: Option<&Tilts>) -> Halves {
        let subdomains = partition.subdomains.len();
        let mut halves = Halves {
            nodes: subdomains,
            ends: (partition.curves.iter())
                .map(|curve| [curve.left, curve.right].map(node_of))
                .collect(),
            bridges: Vec::new(),
        };
        let Some(tilts) = tilts else {
            return halves;
        };
        for (k, block) in goals.blocks.iter().enumerate() {
            if !has_halves(block.sides.len()) {
                continue;
            }
            let second = halves.nodes as u32;
            halves.nodes += 1;
            for &curve in block.sides.iter().skip(1).step_by(2).flatten() {
                for end in &mut halves.ends[curve as usize] {
                    if *end == block.subdomain {
                        *end = second;
                    }
                }
            }
            halves.bridges.push(Edge {
                a: block.subdomain,
                b: second,
                weight: tilts.bridge[k],
                label: (partition.curves.len() + k) as u32,
            });
        }
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

#[cfg(test)]
mod tests {
    use super::choice;
    use super::cost_units;
    use crate::intervals::goals::Goals;
    use proptest::prelude::*;

    proptest! {
        /// The walk from the real optimum finds what a look at all counts finds.
        #[test]
        fn choice_is_the_best_of_all(
            goal in 0.3_f64..400.0,
            weight in 1.0_f64..30.0,
            tilt in -3_000_000_i64..3_000_000,
            lower in 1_u32..6,
            wide in 0_u32..600,
            flat in any::<bool>(),
        ) {
            let goals = Goals {
                goal: vec![goal],
                lower: vec![lower],
                upper: vec![lower + wide],
                weight: vec![weight],
                blocks: Vec::new(),
            };
            // Costs that are nearly flat: rounding to units is then what decides.
            let tilt = if flat { tilt / 100_000 } else { tilt };
            let cost = |n: u32| cost_units(&goals, 0, n) + tilt * i64::from(n);
            let best = |parity: u32| {
                let all = (lower..=lower + wide).filter(|n| n % 2 == parity);
                all.map(|n| (cost(n), n)).min()
            };
            let (mine, other) = choice(&goals, 0, tilt);
            let mut expected: Vec<(i64, u32)> = [best(0), best(1)].into_iter().flatten().collect();
            expected.sort_unstable();
            prop_assert_eq!((mine.1, mine.0), expected[0]);
            prop_assert_eq!(other.map(|it| (it.1, it.0)), expected.get(1).copied());
        }
    }
}
