//! Draft -> Patch: clean-up and smoothing, one node a place again, and the promises checked.

use crate::meshing::cavity;
use crate::meshing::check::check;
use crate::meshing::draft::Draft;
use crate::meshing::improve::Cleaner;
use crate::meshing::improve::Pass;
use crate::meshing::kernel::Kernel;
use crate::meshing::level::level_across;
use crate::meshing::level::level_worst;
use crate::meshing::lift::lift_last;
use crate::meshing::lift::lift_worst;
use crate::meshing::patch::Loops;
use crate::meshing::patch::Method;
use crate::meshing::patch::Patch;
use crate::meshing::regular::regularise;
use crate::meshing::score::Score;
use crate::meshing::smooth::smooth_all;
use crate::meshing::smooth::untangle;
use crate::meshing::smooth::wish;
use crate::meshing::triangulate::NONE;
use crate::meshing::visits::Visits;

/// How much work the finish does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Effort {
    /// As it is: only the promises are checked.
    Check,
    /// Smoothing: the connections stay.
    Smooth,
    /// Clean-up and smoothing.
    Clean,
}

/// Below this scaled Jacobian a quad may cost its neighbours some shape.
const POOR: f64 = 0.3;

/// Below these worths a quad is rescued: first, and after the valences around it have settled.
const RESCUED_FIRST: f64 = 0.45;
const RESCUED: f64 = 0.5;

/// Moves below these shares of the wished edge length do not matter while the topology still
/// changes, and at the end. Measured: half of either changes the mean shape by less than .0005.
const ROUGHLY: f32 = 0.04;
const FINELY: f32 = 0.01;

/// Finishes a draft: the draft as it is then, and its patch; `None` if the result would break a promise.
pub(crate) fn finish(
    mut draft: Draft,
    visits: &Visits,
    loops: &Loops,
    effort: Effort,
) -> Option<(Draft, Patch)> {
    let mut refilled = 0;
    if effort == Effort::Smooth {
        smooth_only(&mut draft, visits, loops.size_m);
    }
    if effort == Effort::Clean {
        improve(&mut draft, visits, loops.size_m);
        refilled = cavity::refill(&mut draft, visits, loops.size_m);
        if refilled > 0 {
            smooth_only(&mut draft, visits, loops.size_m);
        }
    }
    let patch = merge_visits(&draft, visits, loops, refilled);
    check(loops, &patch).is_ok().then_some((draft, patch))
}

/// The last pass over the patch that has won: lifts nearly all quads, and levels areas with those across the outline
/// too. Connections stay. (It comes after the contest since it serves no choice, and costs a tenth of all processor
/// time.)
pub(crate) fn polish(
    (mut draft, patch, score): (Draft, Patch, Score),
    visits: &Visits,
    loops: &Loops,
) -> (Patch, Score) {
    let mut kernel = Kernel::of(&draft, visits);
    kernel.look_across(visits);
    wish(&mut kernel, loops.size_m);
    lift_last(&mut kernel, loops.size_m);
    level_across(&mut kernel, loops.size_m);
    kernel.store(&mut draft);
    let refilled = patch.last_resort_quads as usize;
    let polished = merge_visits(&draft, visits, loops, refilled);
    if check(loops, &polished).is_err() {
        return (patch, score);
    }
    let score = Score::of(&polished, visits, loops);
    (polished, score)
}

/// Works on all quads that are not settled.
///
/// Windows are filled twice: when the valences have settled, which spares the later passes much of
/// their work, and at the end. (Measured on two cities: two sweeps in the first place leave 5.12 and
/// 1.29 % irregular nodes, one in either 4.99 and 1.27 % for the same time.)
pub(crate) fn improve(draft: &mut Draft, visits: &Visits, size_m: f64) {
    let mut kernel = Kernel::of(draft, visits);
    wish(&mut kernel, size_m);
    let mut cleaner = Cleaner::new(kernel, size_m);
    smooth(&mut cleaner, 10, ROUGHLY);
    cleaner.run(Pass::Valence, 6);
    cleaner.run(Pass::Rescue(RESCUED_FIRST), 3);
    smooth(&mut cleaner, 10, ROUGHLY);
    regularise(&mut cleaner);
    cleaner.forget();
    cleaner.run(Pass::Valence, 3);
    cleaner.run(Pass::Rescue(RESCUED), 3);
    for _ in 0..2 {
        smooth(&mut cleaner, 6, ROUGHLY);
        cleaner.forget();
        let kept = cleaner.run(Pass::Energy, 1) + cleaner.run(Pass::Valence, 2);
        if kept == 0 {
            break;
        }
    }
    cleaner.run(Pass::Rescue(RESCUED), 3);
    regularise(&mut cleaner);
    settle(cleaner, draft, size_m);
}

/// The last step of [`improve`] alone: the topology stays.
fn smooth_only(draft: &mut Draft, visits: &Visits, size_m: f64) {
    let mut kernel = Kernel::of(draft, visits);
    wish(&mut kernel, size_m);
    settle(Cleaner::new(kernel, size_m), draft, size_m);
}

fn settle(mut cleaner: Cleaner, draft: &mut Draft, size_m: f64) {
    smooth(&mut cleaner, 30, FINELY);
    lift_worst(&mut cleaner.kernel, size_m);
    level_worst(&mut cleaner.kernel, size_m);
    cleaner.kernel.store(draft);
}

fn smooth(cleaner: &mut Cleaner, sweeps: usize, rest: f32) {
    untangle(&mut cleaner.kernel, POOR, 6, rest);
    smooth_all(&mut cleaner.kernel, sweeps, rest);
}

/// Visits at one place become one node; unused nodes go.
fn merge_visits(draft: &Draft, visits: &Visits, loops: &Loops, refilled: usize) -> Patch {
    let by_last_resort = match draft.method {
        Method::LastResort => draft.quads.len(),
        _ => refilled,
    };
    let mut number = vec![NONE; draft.nodes.len()];
    number[..draft.visits].copy_from_slice(&visits.unique);
    let mut nodes = loops.nodes.clone();
    let mut quads = draft.quads.clone();
    for node in quads.iter_mut().flatten() {
        let old = *node as usize;
        if number[old] == NONE {
            number[old] = nodes.len() as u32;
            nodes.push(draft.nodes[old]);
        }
        *node = number[old];
    }
    Patch {
        nodes,
        quads,
        method: draft.method,
        last_resort_quads: by_last_resort as u32,
    }
}
