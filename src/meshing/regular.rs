//! Fewer irregular nodes: convex windows filled again by the pattern of their counts.
//!
//! A 3-5 pair is a dislocation of the lattice, and two of them need no more than one pair with a
//! wider gap; none at all if they are opposite. So a window with four corners is a grid or needs one
//! pair, one with three or five corners needs one irregular node, however many it holds. Where it
//! holds more, its pattern takes its place, if the shapes are hardly worse.
//!
//! Connectivity editing (Peng, Zhang, Kobayashi, Wonka 2011) moves pairs by chains of flips,
//! collapses and splits until they meet; here the end is laid at once, and no chain can get stuck
//! half way. Patterns come from `patterns` (Tarini 2021), windows from `windows`.
//!
//! Measured: half to two thirds of the irregular nodes go where sub-domains have a thousand quads
//! (a synthetic city 3.25 > 1.27 %, muncie 1.92 > .68 %), a tenth to a quarter where lines are dense,
//! and mean and 1 % quantile of the shapes rise in all, since a lone pair bends what is around it.
//! Cost: about 30 us an irregular node, a twelfth of the whole where there are most; four of five
//! patterns that pass [`MARGIN`] are kept.

use crate::geometry::point::Xy;
use crate::meshing::contour::Contour;
use crate::meshing::edits::Edit;
use crate::meshing::improve::Cleaner;
use crate::meshing::improve::Shape;
use crate::meshing::improve::Verdict;
use crate::meshing::kernel::Kernel;
use crate::meshing::patterns;
use crate::meshing::sheet::Sheet;
use crate::meshing::windows::Growth;
use crate::meshing::windows::Window;
use crate::meshing::windows::is_irregular;
use rustc_hash::FxHashSet;

/// What an irregular node less may cost: as a sum of 1 - scaled Jacobian, and of its squares. The
/// `score` would pay 1 for it. Measured on two cities: .1 and .05 leave a tenth more irregular
/// nodes, 1 takes out a tenth more for .0006 of the mean shape and 1 % more quads.
const LOSS: f64 = 0.3;
const ENERGY: f64 = 0.1;

/// A worth that may fall to this: what is above does not make the worst hundredth. Measured on two
/// cities: .8 leaves a twelfth more irregular nodes, .6 none fewer.
const FLOOR: f64 = 0.7;

/// A pattern whose quads lose more than this an irregular node less, as laid, is not tried: four of
/// ten that would fail, and one in fifty that would be kept.
const MARGIN: f64 = 1.2;

/// A pattern for a window.
struct Filling {
    edit: Edit,
    /// How many irregular nodes fewer it has.
    fewer: usize,
    /// Sum of 1 - scaled Jacobian as laid.
    loss: f64,
}

/// Tries the windows of every irregular node; returns how many were filled again.
pub(crate) fn regularise(cleaner: &mut Cleaner) -> usize {
    let mut growth = Growth::default();
    // Several seeds lead to the same windows.
    let mut failed: FxHashSet<Vec<u32>> = FxHashSet::default();
    let mut kept = 0;
    for node in 0..cleaner.kernel.nodes.len() as u32 {
        if is_irregular(&cleaner.kernel, node) {
            let windows = growth.windows(&cleaner.kernel, node);
            kept += usize::from(fill_one(cleaner, windows, &mut failed));
        }
    }
    kept
}

/// Fills the first of the windows that gains from it.
fn fill_one(cleaner: &mut Cleaner, windows: Vec<Window>, failed: &mut FxHashSet<Vec<u32>>) -> bool {
    for window in windows {
        let Some(least) = needed(&window).filter(|&least| least < window.irregular) else {
            continue;
        };
        if failed.contains(&window.quads) {
            continue;
        }
        if let Some(filling) = fill(&cleaner.kernel, &window, window.irregular - least)
            && is_promising(&cleaner.kernel, &window, &filling)
            && cleaner.attempt(&filling.edit, |_, before, now| {
                judge(filling.fewer, before, now)
            })
        {
            return true;
        }
        failed.insert(window.quads);
    }
    false
}

/// How many irregular nodes the pattern of a window has.
fn needed(window: &Window) -> Option<usize> {
    patterns::irregular_nodes(&patterns::counts(window.outline.len(), &window.corners))
}

/// Lays the pattern of a window.
fn fill(kernel: &Kernel, window: &Window, fewer: usize) -> Option<Filling> {
    let n = window.outline.len();
    let place = |&node: &u32| -> Xy { kernel.nodes[node as usize] };
    let mut sheet = Sheet {
        nodes: window.outline.iter().map(place).collect(),
        quads: Vec::new(),
    };
    let contour = Contour::of(&sheet, (0..n as u32).collect());
    let shape = patterns::lay_over(&mut sheet, &contour, &window.corners)?;
    let first = kernel.nodes.len() as u32;
    let name = |node: u32| match window.outline.get(node as usize) {
        Some(&node) => node,
        None => first + node - n as u32,
    };
    Some(Filling {
        edit: Edit {
            old: window.quads.iter().copied().collect(),
            new: (sheet.quads.iter()).map(|quad| quad.map(name)).collect(),
            born: sheet.nodes[n..].iter().copied().collect(),
            moved: None,
        },
        fewer,
        loss: sheet.quads.len() as f64 * (1.0 - shape.mean()),
    })
}

fn is_promising(kernel: &Kernel, window: &Window, filling: &Filling) -> bool {
    let loss = |&quad: &u32| 1.0 - kernel.quality(quad);
    let before: f64 = window.quads.iter().map(loss).sum();
    filling.loss <= before + MARGIN * filling.fewer as f64
}

fn judge(fewer: usize, before: &Shape, now: &Shape) -> Verdict {
    let fewer = fewer as f64;
    let content = now.least >= before.least.min(FLOOR)
        && now.loss <= before.loss + LOSS * fewer
        && now.energy <= before.energy + ENERGY * fewer;
    if content {
        Verdict::Keep
    } else {
        Verdict::Smooth
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::edits::Operation;
    use crate::meshing::edits::candidates;
    use crate::meshing::edits::edit;
    use crate::meshing::kernel::grid;
    use crate::meshing::smooth::wish;
    use crate::meshing::triangulate::NONE;
    use proptest::prelude::*;

    /// A grid after some edits, whatever they do to valences; `picks` choose where and which.
    fn disturbed(columns: usize, rows: usize, picks: &[(usize, usize)]) -> Cleaner {
        let mut kernel = grid(columns, rows);
        wish(&mut kernel, 1.0);
        let mut cleaner = Cleaner::new(kernel, 1.0);
        for &(quad, which) in picks {
            let quad = (quad % cleaner.kernel.quads.len()) as u32;
            if !cleaner.kernel.lives(quad) {
                continue;
            }
            let found = candidates(&cleaner.kernel, quad, 20.0, false);
            if let Some(&(_, operation)) = found.get(which % found.len().max(1))
                && let Some(edit) = edit(&cleaner.kernel, operation)
            {
                cleaner.attempt(&edit, |_, _, now| match now.least > 0.2 {
                    true => Verdict::Keep,
                    false => Verdict::Smooth,
                });
            }
        }
        cleaner
    }

    fn irregular(kernel: &Kernel) -> usize {
        let nodes = 0..kernel.nodes.len() as u32;
        nodes.filter(|&node| is_irregular(kernel, node)).count()
    }

    fn alive(kernel: &Kernel) -> impl Iterator<Item = u32> {
        (0..kernel.quads.len() as u32).filter(|&quad| kernel.lives(quad))
    }

    /// Edges used once, sorted, with their places.
    fn rim(kernel: &Kernel) -> Vec<[u32; 2]> {
        let sides = alive(kernel).flat_map(|quad| 4 * quad..4 * quad + 4);
        let mut rim: Vec<[u32; 2]> = sides
            .filter(|&side| kernel.twin(side) == NONE)
            .map(|side| [kernel.start(side), kernel.end(side)])
            .collect();
        rim.sort_unstable();
        rim
    }

    /// The held nodes and where they are.
    fn outline(kernel: &Kernel) -> Vec<(usize, Xy)> {
        let nodes = 0..kernel.nodes.len();
        let held = nodes.filter(|&node| kernel.held[node]);
        held.map(|node| (node, kernel.nodes[node])).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]

        #[test]
        fn irregular_nodes_never_become_more_and_all_else_holds(
            picks in prop::collection::vec((0_usize..1000, 0_usize..40), 1..25),
        ) {
            let mut cleaner = disturbed(13, 10, &picks);
            let (before, rim_before) = (irregular(&cleaner.kernel), rim(&cleaner.kernel));
            let places = outline(&cleaner.kernel);
            let kept = regularise(&mut cleaner);
            let kernel = &cleaner.kernel;
            prop_assert!(irregular(kernel) + kept <= before);
            prop_assert_eq!(rim(kernel), rim_before);
            prop_assert_eq!(outline(kernel), places);
            let mut valence = vec![0; kernel.nodes.len()];
            for quad in alive(kernel) {
                prop_assert!(kernel.quality(quad) > 0.0);
                for side in 4 * quad..4 * quad + 4 {
                    valence[kernel.start(side) as usize] += 1;
                    let twin = kernel.twin(side);
                    prop_assert!(twin == NONE || kernel.twin(twin) == side);
                }
            }
            prop_assert_eq!(&valence, &kernel.valence);
            let mut again = disturbed(13, 10, &picks);
            regularise(&mut again);
            prop_assert_eq!(&again.kernel.quads, &kernel.quads);
            prop_assert_eq!(&again.kernel.nodes, &kernel.nodes);
        }
    }

    /// A turned edge makes two opposite pairs. When they have glided apart by more turns that leave
    /// the valences as they are, no operation sees both, but a window does.
    #[test]
    fn opposite_pairs_vanish_when_they_have_glided_apart() {
        let mut cleaner = disturbed(16, 12, &[]);
        for round in 0..4 {
            let glides = |&&(cost, operation): &&(f32, Operation)| {
                let turns = matches!(operation, Operation::Swap { .. });
                turns && (cost == 0.0) == (round > 0)
            };
            let operation = (16 * 5 + 5..16 * 12).find_map(|quad| {
                let found = candidates(&cleaner.kernel, quad, 20.0, false);
                found.iter().find(glides).map(|&(_, operation)| operation)
            });
            let edit = edit(&cleaner.kernel, operation.expect("one")).expect("inside");
            assert!(cleaner.attempt(&edit, |_, _, _| Verdict::Keep));
        }
        assert_eq!(irregular(&cleaner.kernel), 4);
        assert!(regularise(&mut cleaner) > 0);
        assert_eq!(irregular(&cleaner.kernel), 0);
    }
}
