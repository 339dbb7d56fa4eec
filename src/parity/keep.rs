//! The counts of an earlier city, kept where others are hardly better.
//!
//! The optimum is one of the whole city, so a line that moves can change counts far away for next to
//! nothing. Given earlier counts, each curve keeps its own or takes the best one, and a change has a
//! small price: where both differ in parity that is again a minimum-weight T-join, exact for parity
//! alone. With patterns, whose price is no sum over curves, it only makes the earlier counts even; moves
//! mend the patterns around what changed. What still differs then falls into islands, no two at one
//! sub-domain, and each is taken over as a whole if that gains its price: all is, if the cities differ.

use crate::intervals::goals::Goals;
use crate::parity::around::Around;
use crate::parity::draft::Draft;
use crate::parity::draft::Places;
use crate::parity::graph::Edge;
use crate::parity::graph::Graph;
use crate::parity::minimum_join;
use crate::parity::programme::COST_UNIT;
use crate::parity::programme::cost_units;
use crate::parity::programme::node_of;
use crate::parity::tilts::Rules;
use crate::partition::subdomains::OUTSIDE;
use crate::partition::subdomains::Partition;

/// What a change of a count must gain: an edge at 1.01 times its wished length costs as much.
const WORTH_A_CHANGE: i64 = (0.02 / COST_UNIT) as i64;

/// Rounds of moves around what changed.
const MEND_ROUNDS: u32 = 5;

/// The counts `best`, but those of `previous` wherever they do nearly as well; all sub-domains stay even.
pub fn keep(
    partition: &Partition,
    goals: &Goals,
    worth: i64,
    best: &[u32],
    previous: &[Option<u32>],
) -> Vec<u32> {
    let within = |curve: usize, n: u32| goals.lower[curve] <= n && n <= goals.upper[curve];
    let mut kept: Vec<u32> = (previous.iter().zip(best).enumerate())
        .map(|(id, (old, &best))| old.filter(|&n| within(id, n)).unwrap_or(best))
        .collect();
    change(partition, goals, worth == 0, best, &mut kept);
    let (rules, places) = (Rules::of(goals, worth), Places::of(partition, goals));
    let mut draft = Draft::new(goals, &rules, &places, kept);
    draft.hurdle = WORTH_A_CHANGE;
    draft.descend(MEND_ROUNDS);
    for island in islands(partition, &draft.counts, best) {
        let counts: Vec<u32> = island.iter().map(|&curve| best[curve as usize]).collect();
        draft.set_if_cheaper(&island, &counts, WORTH_A_CHANGE * island.len() as i64);
    }
    draft.counts
}

/// Takes the `best` count of those curves where that is cheapest, a change priced, or, unless
/// `for_gain`, of as few as parity asks for; all sub-domains are even afterwards, as they would be with
/// all of them.
fn change(partition: &Partition, goals: &Goals, for_gain: bool, best: &[u32], kept: &mut [u32]) {
    let mut odd = vec![false; partition.subdomains.len()];
    let mut edges = Vec::new();
    let earlier = kept.to_vec();
    for (id, curve) in partition.curves.iter().enumerate() {
        let saved = cost_units(goals, id, kept[id]) - cost_units(goals, id, best[id]);
        let gain = if for_gain { saved } else { saved.min(0) } - WORTH_A_CHANGE;
        let old = kept[id];
        // Taken at once if it gains; what the sub-domains ask for then may undo it.
        if old != best[id] && gain > 0 {
            kept[id] = best[id];
        }
        if curve.left == curve.right {
            continue;
        }
        let ends = [curve.left, curve.right].map(node_of);
        for side in ends.into_iter().filter(|&side| side != OUTSIDE) {
            odd[side as usize] ^= kept[id] % 2 == 1;
        }
        if (old + best[id]) % 2 == 1 {
            edges.push(Edge {
                a: ends[0],
                b: ends[1],
                weight: gain.abs(),
                label: id as u32,
            });
        }
    }
    let graph = Graph::new(odd, edges);
    let join = minimum_join(&graph, u64::MAX);
    for (edge, _) in (graph.edges.iter().zip(&join.chosen)).filter(|(_, chosen)| **chosen) {
        let id = edge.label as usize;
        kept[id] = match kept[id] == best[id] {
            true => earlier[id],
            false => best[id],
        };
    }
}

/// The curves whose counts differ, those around one sub-domain together; each island sorted.
fn islands(partition: &Partition, kept: &[u32], best: &[u32]) -> Vec<Vec<u32>> {
    let differs = |id: usize| kept[id] != best[id];
    let around = Around::of(partition, differs);
    let mut seen = vec![false; kept.len()];
    let mut islands = Vec::new();
    for seed in (0..kept.len()).filter(|&id| differs(id)) {
        if std::mem::replace(&mut seen[seed], true) {
            continue;
        }
        let (mut island, mut next) = (vec![seed as u32], 0);
        while next < island.len() {
            let curve = &partition.curves[island[next] as usize];
            next += 1;
            for side in [curve.left, curve.right] {
                for near in around.curves(side) {
                    if !std::mem::replace(&mut seen[near as usize], true) {
                        island.push(near);
                    }
                }
            }
        }
        island.sort_unstable();
        islands.push(island);
    }
    islands
}
