//! Trial meshes on all cores, and the nodes that move for them: the end of phase B.

use crate::cleanup;
use crate::domain::finding::Finding;
use crate::partition;
use crate::pipeline::error::Error;
use crate::pipeline::job::Job;
use crate::pipeline::plan::Plan;
use crate::pipeline::progress::Stopwatch;
use crate::pipeline::tiles::ONE;
use crate::settling;
use crate::settling::LARGE_QUADS;
use crate::settling::Settled;
use crate::settling::Trial;
use rayon::iter::IndexedParallelIterator;
use rayon::iter::IntoParallelRefMutIterator;
use rayon::iter::ParallelIterator;

/// What clean-up left too short, too narrow or too sharp, while nodes may still move.
pub struct Unsettled {
    /// As findings.
    pub left: Vec<Finding>,
    /// False if clean-up was to change nothing.
    pub may_move: bool,
}

/// Moves the nodes of the plan's line work to better places, in as many rounds as the job says. A
/// plan that was parked has been settled before.
pub(super) fn settle(job: &Job, plan: &mut Plan, watch: &Stopwatch) -> Result<(), Error> {
    let Some(Unsettled { mut left, may_move }) = plan.unsettled.take() else {
        return Ok(());
    };
    let rounds = if may_move { job.settle } else { 0 };
    let subdomains = plan.city.partition.subdomains.len();
    let left = watch.stage("settling", u64::from(rounds) * subdomains as u64, |count| {
        let moves = settle_in_rounds(plan, rounds, count);
        if moves > 0 {
            left = cleanup::shifts::retell(
                &plan.domain,
                &plan.sizes,
                &plan.cleaning,
                &plan.city.arrangement,
                &mut plan.city.tally,
            );
        }
        Ok::<_, Error>((left, format!("{moves} moves of nodes to better places")))
    })?;
    plan.city.findings.extend(left);
    Ok(())
}

/// Returns how often nodes moved, each counted once a round.
fn settle_in_rounds(plan: &mut Plan, rounds: u32, count: &(dyn Fn(u64) + Sync)) -> usize {
    let mut trials = vec![Trial::default(); plan.city.partition.subdomains.len()];
    let mut moves = 0;
    let mut last: Option<Settled> = None;
    for _ in 0..rounds {
        try_out(plan, &mut trials, last.as_ref(), count);
        let settled = settle_once(plan, &mut trials);
        moves += settled.moves();
        last = Some(settled);
    }
    moves
}

/// Meshes sub-domains on trial: all of them, or those of moderate size at nodes that `last` moved.
fn try_out(
    plan: &Plan,
    trials: &mut [Trial],
    last: Option<&Settled>,
    count: &(dyn Fn(u64) + Sync),
) {
    let (city, sizes) = (&plan.city, &plan.sizes);
    let site = plan.site();
    let is_large = |subdomain: usize| {
        let quads = city.partition.subdomains[subdomain].area_m2 / sizes.default_m.powi(2);
        quads > LARGE_QUADS
    };
    let ids = trials.par_iter_mut().with_max_len(ONE).enumerate();
    ids.for_each(|(subdomain, trial)| {
        let is_wanted = last.is_none_or(|it| !is_large(subdomain) && trial.sees(&it.moved));
        if is_wanted {
            *trial = settling::trial(&site, subdomain as u32);
        }
        count(1);
    });
}

fn settle_once(plan: &mut Plan, trials: &mut [Trial]) -> Settled {
    let city = &mut plan.city;
    let settled = settling::settle(
        &plan.domain,
        &plan.sizes,
        &plan.cleaning,
        &mut city.arrangement,
        trials,
    );
    partition::remeasure(&plan.domain, &city.arrangement, &mut city.partition);
    settled
}
