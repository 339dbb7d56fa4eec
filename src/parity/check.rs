//! The promises of `parity` as code. Trusts neither the matching nor HiGHS.

use crate::intervals::goals::Goals;
use crate::parity::balance::Balance;
use crate::parity::error::Error;
use crate::parity::programme::Programme;
use crate::parity::programme::cost_units;
use crate::parity::programme::free_rounding;
use crate::parity::programme::total_units;
use crate::parity::programme::units;
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
    let bound = bound_units(partition, goals, balance)?;
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
    Ok(())
}

/// The bound that the certificate proves, in whole cost units.
fn bound_units(partition: &Partition, goals: &Goals, balance: &Balance) -> Result<i64, String> {
    let said = |error: Error| error.to_string();
    let near = free_rounding(goals).map_err(said)?;
    let programme = Programme::new(partition, goals, &near, 0).map_err(said)?;
    let cuts = &balance.cuts;
    let sets = cuts.parent.len();
    if cuts.set_of.len() != programme.graph.odd.len() || cuts.value2.len() != sets {
        return Err("the certificate has arrays of other lengths".into());
    }
    let mut odd = vec![false; sets];
    for (node, &set) in cuts
        .set_of
        .iter()
        .enumerate()
        .filter(|(_, set)| **set != u32::MAX)
    {
        let set = (odd.get_mut(set as usize)).ok_or("a node in a set that is not there")?;
        *set ^= programme.graph.odd[node];
    }
    for set in (0..sets).rev() {
        let parent = cuts.parent[set];
        if !odd[set] || cuts.value2[set] <= 0 || (parent != u32::MAX && parent as usize >= set) {
            return Err(format!("set {set} of the certificate proves nothing"));
        }
        if parent != u32::MAX {
            odd[parent as usize] ^= true;
        }
    }
    match programme
        .graph
        .edges
        .iter()
        .find(|edge| cuts.slack2(edge) < 0)
    {
        Some(edge) => Err(format!("curve {} pays more than it costs", edge.label)),
        // Rounded up: costs are whole.
        None => Ok(total_units(goals, &near) + (cuts.bound2() + 1) / 2),
    }
}
