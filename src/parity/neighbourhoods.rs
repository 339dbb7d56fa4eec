//! Better counts, a neighbourhood at a time: where cost and price exceed what the bound accounts
//! for, HiGHS solves the sub-domains around exactly while all others stay.

use crate::intervals::goals::Goals;
use crate::parity::around::Around;
use crate::parity::draft::Draft;
use crate::parity::programme::cost_units;
use crate::parity::solver_rules;
use crate::parity::solver_rules::Neighbourhood;
use crate::parity::tilts::Rules;
use crate::parity::tilts::Tilts;
use crate::partition::subdomains::OUTSIDE;
use crate::partition::subdomains::Partition;
use std::collections::BTreeSet;

/// Sub-domains of a neighbourhood: more take HiGHS much longer, fewer leave it little to choose.
const SUBDOMAINS: usize = 40;

/// Branches of HiGHS in each.
const NODES: i32 = 200;

/// Improves `best` at the worst places until its total is `enough`, at most at `most` of them; how many
/// got better.
pub fn improve(
    partition: &Partition,
    goals: &Goals,
    rules: &Rules,
    best: &mut Draft,
    multipliers: &[i64],
    most: u32,
    enough: impl Fn(i64) -> bool,
) -> u32 {
    if enough(best.total()) {
        return 0;
    }
    let crosses = |id: usize| partition.curves[id].left != partition.curves[id].right;
    let around = Around::of(partition, crosses);
    let mut done = vec![false; partition.subdomains.len()];
    let mut improved = 0;
    let mut solved = 0;
    for (_, block) in losses(goals, rules, best, multipliers) {
        let centre = goals.blocks[block as usize].subdomain;
        if done[centre as usize] {
            continue;
        }
        if solved == most || enough(best.total()) {
            break;
        }
        solved += 1;
        let place = neighbourhood(partition, goals, &around, centre);
        // Its rim was held: only the inner half counts as seen to.
        for &id in &place.subdomains[..place.subdomains.len() / 2] {
            done[id as usize] = true;
        }
        let found = solver_rules::counts(partition, goals, rules, best, &place, NODES);
        improved += u32::from(found.is_some_and(|found| accept(partition, best, &place, &found)));
    }
    improved
}

/// What each block and its curves cost beyond what the multipliers account for, the worst first.
fn losses(goals: &Goals, rules: &Rules, draft: &Draft, multipliers: &[i64]) -> Vec<(i64, u32)> {
    let tilts = Tilts::of(goals, rules, multipliers);
    let of_curve = |curve: u32| {
        let id = curve as usize;
        let (now, slope) = (draft.counts[id], tilts.slope[id]);
        let cost = |n: u32| cost_units(goals, id, n) + slope * i64::from(n);
        let near = now.saturating_sub(3).max(goals.lower[id])..=(now + 3).min(goals.upper[id]);
        cost(now) - near.map(cost).min().unwrap_or(cost(now))
    };
    let mut losses = Vec::new();
    for (k, block) in goals.blocks.iter().enumerate() {
        let rows = &multipliers[rules.rows(k)];
        let accounted: i64 = (rules.with_sides(block.sides.len()).iter().zip(rows))
            .map(|(rule, u)| u * rule.excess(draft.totals(k)))
            .sum();
        let curves: i64 = block
            .sides
            .iter()
            .flatten()
            .map(|&curve| of_curve(curve))
            .sum();
        let loss = rules.worth[k] * draft.excess(k) - accounted + curves;
        if loss > 0 {
            losses.push((loss, k as u32));
        }
    }
    losses.sort_unstable_by_key(|&(loss, block)| (std::cmp::Reverse(loss), block));
    losses
}

/// The sub-domains nearest to `centre`, in order of distance, with what lies between them.
fn neighbourhood(
    partition: &Partition,
    goals: &Goals,
    around: &Around,
    centre: u32,
) -> Neighbourhood {
    let mut inside = BTreeSet::from([centre]);
    let mut subdomains = vec![centre];
    let mut next = 0;
    while next < subdomains.len() && subdomains.len() < SUBDOMAINS {
        let id = subdomains[next];
        for curve in around.curves(id) {
            let curve = &partition.curves[curve as usize];
            let other = if curve.left == id {
                curve.right
            } else {
                curve.left
            };
            if other != OUTSIDE && subdomains.len() < SUBDOMAINS && inside.insert(other) {
                subdomains.push(other);
            }
        }
        next += 1;
    }
    let within = |side: u32| side == OUTSIDE || inside.contains(&side);
    let mut curves: Vec<u32> = (subdomains.iter())
        .flat_map(|&id| around.curves(id))
        .filter(|&curve| {
            let curve = &partition.curves[curve as usize];
            within(curve.left) && within(curve.right)
        })
        .collect();
    curves.sort_unstable();
    curves.dedup();
    let blocks = (inside.iter())
        .filter_map(|id| {
            goals
                .blocks
                .binary_search_by_key(id, |block| block.subdomain)
                .ok()
        })
        .map(|block| block as u32)
        .collect();
    Neighbourhood {
        curves,
        subdomains,
        blocks,
    }
}

/// Takes the counts found if they are even and better.
fn accept(partition: &Partition, best: &mut Draft, place: &Neighbourhood, found: &[u32]) -> bool {
    let mut odd = BTreeSet::new();
    for (&curve, &n) in place.curves.iter().zip(found) {
        if (n + best.counts[curve as usize]) % 2 == 1 {
            let curve = &partition.curves[curve as usize];
            for side in [curve.left, curve.right] {
                if side != OUTSIDE && !odd.insert(side) {
                    odd.remove(&side);
                }
            }
        }
    }
    odd.is_empty() && best.set_if_cheaper(&place.curves, found, 0)
}
