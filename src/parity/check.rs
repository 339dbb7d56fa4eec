//! The promises of `parity` as code. Trusts neither the matching nor HiGHS.

use crate::intervals::goals::Goals;
use crate::parity::balance::Balance;
use crate::parity::balance::Structure;
use crate::parity::draft::Draft;
use crate::parity::draft::Places;
use crate::parity::programme::Programme;
use crate::parity::programme::cost_units;
use crate::parity::programme::units;
use crate::parity::structure;
use crate::parity::tilts::Rules;
use crate::partition::subdomains::OUTSIDE;
use crate::partition::subdomains::Partition;

/// Checks all promises from the output alone; the bound is recomputed from its certificate in
/// whole numbers.
pub fn check(partition: &Partition, goals: &Goals, balance: &Balance) -> Result<(), String> {
    if balance.counts.len() != partition.curves.len() {
        return Err(format!("{} counts", balance.counts.len()));
    }
    let mut total = vec![0_u64; partition.subdomains.len()];
    let mut objective = 0;
    for (id, (curve, &count)) in partition.curves.iter().zip(&balance.counts).enumerate() {
        if count < goals.lower[id] || count > goals.upper[id] {
            let (lower, upper) = (goals.lower[id], goals.upper[id]);
            return Err(format!("curve {id}: {count} not in [{lower}, {upper}]"));
        }
        for side in [curve.left, curve.right] {
            if side != OUTSIDE {
                total[side as usize] += u64::from(count);
            }
        }
        objective += cost_units(goals, id, count);
    }
    if let Some(id) = total.iter().position(|total| total % 2 == 1) {
        return Err(format!("sub-domain {id}: {} intervals", total[id]));
    }
    let parity = Programme::new(partition, goals, None).map_err(|it| it.to_string())?;
    let bound = parity.base + balance.cuts.proven(&parity.graph)?;
    let [said, bound_said, optimum] =
        [balance.objective, balance.bound, balance.optimum].map(units);
    if said != objective || bound_said != bound {
        return Err(format!(
            "{said} and {bound_said} said, {objective} and {bound} found"
        ));
    }
    if bound > optimum || optimum > objective || balance.proven != (bound == optimum) {
        return Err(format!(
            "bound {bound}, optimum {optimum}, objective {objective}: proven {}",
            balance.proven
        ));
    }
    structure(partition, goals, balance)
}

/// What is said of cost and price of the blocks together.
fn structure(partition: &Partition, goals: &Goals, balance: &Balance) -> Result<(), String> {
    let made = &balance.structure;
    if made.multipliers.is_empty() {
        return Ok(());
    }
    let found = recount(partition, goals, &balance.counts, made)?;
    let said = (made.mapped, units(made.price), units(made.bound));
    match (found.mapped, found.price, found.bound) == said && found.bound <= found.total {
        true => Ok(()),
        false => Err(format!("structure: {said:?} said, {found:?} found")),
    }
}

/// What counts cost with the price of patterns, and what is proven of it; whole cost units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recount {
    /// Blocks whose counts fit a pattern.
    pub mapped: u32,
    /// Price of all blocks.
    pub price: i64,
    /// Cost and price.
    pub total: i64,
    /// What any even counts cost at least with their price, from multipliers and cuts alone.
    pub bound: i64,
}

/// Recounts from the counts, `made.worth` and the proof in `made`; trusts none of its other numbers.
pub fn recount(
    partition: &Partition,
    goals: &Goals,
    counts: &[u32],
    made: &Structure,
) -> Result<Recount, String> {
    let worth = units(made.worth);
    let (rules, places) = (Rules::of(goals, worth), Places::of(partition, goals));
    let draft = Draft::new(goals, &rules, &places, counts.to_vec());
    Ok(Recount {
        mapped: draft.mapped(),
        price: draft.price(),
        total: draft.total(),
        bound: structure::bound_units(partition, goals, worth, made)?,
    })
}

/// Which blocks `counts` let a pattern mesh.
pub fn fits(partition: &Partition, goals: &Goals, counts: &[u32]) -> Vec<bool> {
    let (rules, places) = (Rules::of(goals, 0), Places::of(partition, goals));
    let draft = Draft::new(goals, &rules, &places, counts.to_vec());
    let blocks = 0..goals.blocks.len();
    blocks.map(|block| draft.excess(block) == 0).collect()
}
