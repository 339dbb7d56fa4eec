//! The promises of `parity` as code. Trusts neither the matching nor HiGHS.

use crate::intervals::goals::Goals;
use crate::parity::balance::Balance;
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
    let worth = units(made.worth);
    let (rules, places) = (Rules::of(goals), Places::of(partition, goals));
    let draft = Draft::new(goals, &rules, &places, worth, balance.counts.clone());
    let bound = structure::bound_units(partition, goals, worth, made)?;
    let found = (draft.mapped(), draft.price(), bound);
    let said = (made.mapped, units(made.price), units(made.bound));
    match found == said && bound <= draft.total() {
        true => Ok(()),
        false => Err(format!("structure: {said:?} said, {found:?} found")),
    }
}
