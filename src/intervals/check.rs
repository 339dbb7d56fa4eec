//! The promises of `intervals` as code.

use crate::intervals::goals::Goals;
use crate::partition::subdomains::Partition;

/// Checks promises 1 and 3 (totals) on the output alone.
pub fn check(partition: &Partition, goals: &Goals) -> Result<(), String> {
    let n = partition.curves.len();
    let lengths = [
        goals.goal.len(),
        goals.lower.len(),
        goals.upper.len(),
        goals.weight.len(),
    ];
    if lengths != [n; 4] {
        return Err(format!("{n} curves, but arrays of {lengths:?}"));
    }
    for (id, curve) in partition.curves.iter().enumerate() {
        let (lower, upper) = (goals.lower[id], goals.upper[id]);
        if lower < curve.edges.len() as u32 || upper < lower {
            return Err(format!(
                "curve {id}: {} edges in [{lower}, {upper}]",
                curve.edges.len()
            ));
        }
        if !(goals.goal[id] > 0.0 && goals.goal[id].is_finite() && goals.weight[id] > 0.0) {
            return Err(format!("curve {id}: goal {}", goals.goal[id]));
        }
    }
    for (id, subdomain) in partition.subdomains.iter().enumerate() {
        let halves = subdomain.walks.iter().flatten();
        let total: u32 = halves.map(|half| goals.lower[(half >> 1) as usize]).sum();
        let all_fixed = (subdomain.walks.iter().flatten())
            .all(|half| goals.lower[(half >> 1) as usize] == goals.upper[(half >> 1) as usize]);
        if total < 4 && !all_fixed {
            return Err(format!(
                "sub-domain {id}: at least {total} intervals in all"
            ));
        }
    }
    Ok(())
}
