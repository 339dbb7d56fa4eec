//! Loops with three to six sides: what their counts alone allow, in closed form.
//!
//! | sides | condition | pattern | irregular, by valence |
//! |---|---|---|---|
//! | 4 | opposite counts equal | grid | none |
//! | 3, 5, 6 | `count[i] = spoke[i-1] + spoke[i+1]`, spokes from 1 up | star | one of 3, 5, 6 |
//! | 4 | a line across a corner makes it two stars | pair | one of 3, one of 5 |
//!
//! Stars are in `spokes`, pairs in `pair`. Here corners are chosen: entries of the loop that turn,
//! in every subset that the counts allow, ranked by how far the angles are from those of a grid and
//! by the irregular nodes; the best few are laid, and the best shape wins. After Tarini (2021) and
//! Takayama and others (2014).
//!
//! Cost: of a grid, the square of the loop's length at worst; of the others, at most 2^8 subsets of
//! corners, each weighed in the length of the loop; of a pair, see its page.

use std::f64::consts::FRAC_PI_2;
use std::f64::consts::PI;

use crate::meshing::contour::Contour;
use crate::meshing::pair;
use crate::meshing::pair::Cut;
use crate::meshing::sheet::Mark;
use crate::meshing::sheet::Shape;
use crate::meshing::sheet::Sheet;
use crate::meshing::spokes::lay_star;
use crate::meshing::spokes::spokes;

/// Below this interior angle an entry must be a corner of the pattern.
const CORNER_MUST: f64 = 128.0 * PI / 180.0;
/// Below this one it may be.
const CORNER_MAY: f64 = 158.0 * PI / 180.0;
/// Above this one no pattern fits.
const REFLEX: f64 = 232.0 * PI / 180.0;
/// What one irregular node is worth in misfit, radians².
const IRREGULAR: f64 = 0.25;
/// Most corners that a few-sided loop may seem to have.
const MOST_CORNERS: usize = 8;
/// Plans that fit worse are not tried, radians².
const WORST_MISFIT: f64 = 2.5;
/// How many plans are tried, best first.
const TRIED: usize = 3;

/// A way to mesh a loop, and how badly its corners fit.
#[derive(Clone, Debug)]
struct Plan {
    misfit: f64,
    /// Entries that are corners, in order.
    corners: Vec<usize>,
    /// For a pair: the line that cuts corner 0 off.
    cut: Option<Cut>,
}

/// What the plans are for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Search {
    /// To be laid.
    Whole,
    /// Only to know how well they fit: of a pair, that it most likely exists.
    Promise,
}

/// Lays the best pattern for `contour` and returns its shape, or lays nothing. All its quads have
/// positive corner Jacobians.
pub(crate) fn lay(sheet: &mut Sheet, contour: &Contour) -> Option<Shape> {
    if contour.len() < 4 || contour.angle.iter().any(|&angle| angle > REFLEX) {
        return None;
    }
    let mark = sheet.mark();
    let mut best: Option<(f64, Plan)> = None;
    for plan in plans(contour, Search::Whole) {
        let price = 0.4 * plan.misfit;
        if best.as_ref().is_some_and(|(worth, _)| worth + price > 1.0) {
            continue;
        }
        let shape = lay_plan(sheet, contour, &plan);
        sheet.undo(mark);
        let worth = shape.mean().min(0.5 + shape.least) - price;
        if shape.least > 0.0 && best.as_ref().is_none_or(|(most, _)| worth > *most) {
            best = Some((worth, plan));
        }
    }
    best.map(|(_, plan)| lay_plan(sheet, contour, &plan))
}

/// Lays the pattern over these corners whatever the angles, or nothing if the counts allow none.
pub(crate) fn lay_over(sheet: &mut Sheet, contour: &Contour, corners: &[usize]) -> Option<Shape> {
    let counts = counts(contour.len(), corners);
    let plan = if counts.len() == 4 && !is_grid(&counts) {
        pair_plan(contour, corners, &counts, 0.0)?
    } else {
        if counts.len() != 4 {
            spokes(&counts)?;
        }
        Plan {
            misfit: 0.0,
            corners: corners.to_vec(),
            cut: None,
        }
    };
    Some(lay_plan(sheet, contour, &plan))
}

/// How well `contour` promises to fit a pattern, from 0 to 1, by its angles and counts alone.
pub(crate) fn promise(contour: &Contour) -> f64 {
    if contour.len() < 4 || contour.angle.iter().any(|&angle| angle > REFLEX) {
        return 0.0;
    }
    let plans = plans(contour, Search::Promise);
    plans
        .first()
        .map_or(0.0, |plan| (1.0 - plan.misfit).max(0.0))
}

/// The plans worth trying, best first.
fn plans(contour: &Contour, search: Search) -> Vec<Plan> {
    let mut plans = Vec::new();
    plans.extend(grid_plan(contour));
    let corners: Vec<usize> = (0..contour.len())
        .filter(|&i| contour.angle[i] < CORNER_MAY)
        .collect();
    // More would be no few-sided loop, and the subsets too many.
    if (3..=MOST_CORNERS).contains(&corners.len()) {
        let must = (0..corners.len()).filter(|&k| contour.angle[corners[k]] < CORNER_MUST);
        let must = must.fold(0_u32, |mask, k| mask | 1 << k);
        for mask in 0_u32..1 << corners.len() {
            if mask & must == must && (3..=6).contains(&mask.count_ones()) {
                let taken = (0..corners.len()).filter(|k| mask >> k & 1 == 1);
                let chosen: Vec<usize> = taken.map(|k| corners[k]).collect();
                plans.extend(plan_with_corners(contour, &chosen, search));
            }
        }
    }
    plans.sort_by(|p, q| p.misfit.total_cmp(&q.misfit));
    plans.truncate(TRIED);
    plans
}

/// What it adds to the misfit that an entry with this angle is a corner and not on a side.
fn corner_gain(angle: f64) -> f64 {
    (angle - FRAC_PI_2).powi(2) - (angle - PI).powi(2)
}

/// The misfit of a choice without corners.
fn misfit_without_corners(contour: &Contour) -> f64 {
    contour.angle.iter().map(|&a| (a - PI).powi(2)).sum()
}

/// The four corners with equal opposite counts that fit best: entries `i`, `i + m`, and the two
/// half a loop away. O(n²).
fn grid_plan(contour: &Contour) -> Option<Plan> {
    let n = contour.len();
    if n % 2 == 1 {
        return None;
    }
    let half = n / 2;
    let must = contour.angle.iter().filter(|&&a| a < CORNER_MUST).count();
    let musts_at = |i: usize| usize::from(contour.angle[i] < CORNER_MUST);
    let usable = |i: usize| contour.angle[i] < CORNER_MAY && contour.angle[i + half] < CORNER_MAY;
    let opposite: Vec<usize> = (0..half).filter(|&i| usable(i)).collect();
    let gain = |i: usize| corner_gain(contour.angle[i]) + corner_gain(contour.angle[i + half]);
    let mut best: Option<(f64, [usize; 4])> = None;
    for (k, &i) in opposite.iter().enumerate() {
        for &j in &opposite[k + 1..] {
            let corners = [i, j, i + half, j + half];
            let sum = gain(i) + gain(j);
            if corners.iter().map(|&c| musts_at(c)).sum::<usize>() == must
                && best.is_none_or(|(least, _)| sum < least)
            {
                best = Some((sum, corners));
            }
        }
    }
    let (sum, corners) = best?;
    Some(Plan {
        misfit: misfit_without_corners(contour) + sum,
        corners: corners.to_vec(),
        cut: None,
    })
}

/// The star or pair over these corners, if the counts allow it.
fn plan_with_corners(contour: &Contour, corners: &[usize], search: Search) -> Option<Plan> {
    let gain: f64 = corners.iter().map(|&i| corner_gain(contour.angle[i])).sum();
    let misfit = misfit_without_corners(contour) + gain;
    if misfit > WORST_MISFIT {
        return None;
    }
    let counts = counts(contour.len(), corners);
    if corners.len() == 4 {
        if is_grid(&counts) {
            return None;
        }
        let misfit = misfit + 2.0 * IRREGULAR;
        return match search {
            Search::Whole => pair_plan(contour, corners, &counts, misfit),
            Search::Promise => Some(Plan {
                misfit,
                corners: corners.to_vec(),
                cut: None,
            }),
        };
    }
    spokes(&counts)?;
    // A valence of 3 or 5 is one step from regular, 6 is two.
    let steps = corners.len().abs_diff(4) as f64;
    Some(Plan {
        misfit: misfit + steps * IRREGULAR,
        corners: corners.to_vec(),
        cut: None,
    })
}

/// The best pair over these corners: edges that differ from those of the loop are a misfit.
fn pair_plan(contour: &Contour, corners: &[usize], counts: &[usize], misfit: f64) -> Option<Plan> {
    let pair = pair::best(contour, corners, counts)?;
    Some(Plan {
        misfit: misfit + 0.5 * pair.stretch,
        corners: pair.corners,
        cut: Some(pair.cut),
    })
}

/// How many irregular nodes a pattern with these counts has (one of valence 6 counts for two), if
/// it has three to six sides.
pub(crate) fn irregular_nodes(counts: &[usize]) -> Option<usize> {
    match counts.len() {
        3 | 5 => Some(1),
        4 if is_grid(counts) => Some(0),
        4 | 6 => Some(2),
        _ => None,
    }
}

/// True if opposite sides of four have equal counts.
fn is_grid(counts: &[usize]) -> bool {
    counts.len() == 4 && counts[0] == counts[2] && counts[1] == counts[3]
}

/// Edges on each side, the first from corner 0 to corner 1.
pub(crate) fn counts(n: usize, corners: &[usize]) -> Vec<usize> {
    let k = corners.len();
    (0..k)
        .map(|s| (corners[(s + 1) % k] + n - corners[s] - 1) % n + 1)
        .collect()
}

/// Lays `plan` and smooths it if that makes its worst quad better.
fn lay_plan(sheet: &mut Sheet, contour: &Contour, plan: &Plan) -> Shape {
    let mark = sheet.mark();
    let sides = sides(contour, &plan.corners);
    match plan.cut {
        Some(cut) => pair::lay(sheet, &sides, cut),
        None if sides.len() == 4 => {
            let reversed = |side: &[u32]| side.iter().rev().copied().collect::<Vec<u32>>();
            let (north, west) = (reversed(&sides[2]), reversed(&sides[3]));
            sheet.grid(&sides[0], &sides[1], &north, &west);
        }
        None => lay_star(sheet, &sides),
    }
    // A grid is at its best as it is; the grids of a star do not know of each other.
    if plan.corners.len() != 4 || plan.cut.is_some() {
        sheet.relax(mark, 6);
    }
    relax_if_poor(sheet, mark)
}

/// Laplacian sweeps where transfinite interpolation folds.
fn relax_if_poor(sheet: &mut Sheet, mark: Mark) -> Shape {
    let shape = sheet.shape(mark);
    if shape.least > 0.2 {
        return shape;
    }
    sheet.relax(mark, 12);
    sheet.shape(mark)
}

/// Nodes of each side, both corners included.
fn sides(contour: &Contour, corners: &[usize]) -> Vec<Vec<u32>> {
    let n = contour.len();
    let counts = counts(n, corners);
    let side = |s: usize| {
        (0..=counts[s])
            .map(|k| contour.ids[(corners[s] + k) % n])
            .collect()
    };
    (0..corners.len()).map(side).collect()
}
