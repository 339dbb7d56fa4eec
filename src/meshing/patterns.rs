//! Loops with three to six sides: what their counts alone allow, in closed form.
//!
//! | sides | condition | pattern | irregular, by valence |
//! |---|---|---|---|
//! | 4 | opposite counts equal | grid | none |
//! | 3, 5, 6 | `count[i] = spoke[i-1] + spoke[i+1]`, spokes from 1 up | star | one of 3, 5, 6 |
//! | 4 | a line across a corner makes it two stars | pair | one of 3, one of 5 |
//!
//! A star joins a centre to a point on each side, which leaves a grid at each corner (Tarini 2021;
//! Takayama and others 2014). For 3 and 5 sides the spokes follow from the counts; for 6 sides the
//! equations split into two independent triples.

use std::f64::consts::FRAC_PI_2;
use std::f64::consts::PI;

use crate::geometry::point::Xy;
use crate::meshing::contour::Contour;
use crate::meshing::sheet::Mark;
use crate::meshing::sheet::Shape;
use crate::meshing::sheet::Sheet;

/// Below this interior angle an entry must be a corner of the pattern.
const CORNER_MUST: f64 = 128.0 * PI / 180.0;
/// Below this one it may be.
const CORNER_MAY: f64 = 158.0 * PI / 180.0;
/// Above this one no pattern fits.
const REFLEX: f64 = 232.0 * PI / 180.0;
/// What one irregular node is worth in misfit, radians².
const IRREGULAR: f64 = 0.25;
/// Longest loop for which pairs are searched.
const PAIR_LONGEST: usize = 800;
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

/// A line across corner 0 of a loop with four sides: `before` edges up to it, `after` edges past it
/// and `across` on the line itself make a triangle; the rest has five sides.
#[derive(Clone, Copy, Debug)]
struct Cut {
    before: usize,
    after: usize,
    across: usize,
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
        pair_plan(contour, corners, 0.0)?
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
            Search::Whole => pair_plan(contour, corners, misfit),
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

/// Solves `count[i] = spoke[i-1] + spoke[i+1]` for whole spokes of at least 1, for 3, 5 or 6 sides;
/// entries past the last side are 0.
fn spokes(counts: &[usize]) -> Option<[usize; 6]> {
    let spokes = loose_spokes(counts)?;
    (spokes[..counts.len()].iter().all(|&spoke| spoke > 0)).then_some(spokes)
}

/// The same for spokes of at least 0.
fn loose_spokes(counts: &[usize]) -> Option<[usize; 6]> {
    let spokes = signed_spokes(counts)?;
    (spokes.iter().all(|&spoke| spoke >= 0)).then(|| spokes.map(|spoke| spoke as usize))
}

/// The same for spokes of any sign: one side farther out makes its spoke longer by one, and changes
/// no other.
pub(crate) fn signed_spokes(counts: &[usize]) -> Option<[i64; 6]> {
    let n = counts.len();
    // Following steps of two from spoke i, the counts between them come with alternating sign.
    let terms = match n {
        3 | 6 => 3,
        5 => 5,
        _ => return None,
    };
    let mut spokes = [0; 6];
    for i in 0..n {
        let mut twice = 0;
        for k in 0..terms {
            let count = counts[(i + 2 * k + 1) % n] as i64;
            twice += if k % 2 == 0 { count } else { -count };
        }
        if twice % 2 != 0 {
            return None;
        }
        spokes[i] = twice / 2;
    }
    Some(spokes)
}

/// The best line across any of the four corners: each spoke and the line itself should have
/// edges as long as those of the loop. O(count² x mismatch).
fn pair_plan(contour: &Contour, corners: &[usize], misfit: f64) -> Option<Plan> {
    if contour.len() > PAIR_LONGEST {
        return None;
    }
    let size_m = contour.spacing_m.iter().sum::<f64>() / contour.len() as f64;
    let mut best: Option<(f64, usize, Cut)> = None;
    for turn in 0..4 {
        let mut turned = corners.to_vec();
        turned.rotate_left(turn);
        let counts = counts(contour.len(), &turned);
        // The spokes of triangle and pentagon to the line have this many edges together.
        let excess = (counts[0] + counts[3]).saturating_sub(counts[1] + counts[2]) / 2;
        for before in 1..counts[3] {
            for after in 1..counts[0] {
                for spoke in 0..excess.min(before).min(after) {
                    let cut = Cut {
                        before,
                        after,
                        across: before + after - 2 * spoke,
                    };
                    let Some(stretch) = pair_stretch(contour, &turned, &counts, cut, size_m) else {
                        continue;
                    };
                    if best.is_none_or(|(least, _, _)| stretch < least) {
                        best = Some((stretch, turn, cut));
                    }
                }
            }
        }
    }
    let (stretch, turn, cut) = best?;
    let mut turned = corners.to_vec();
    turned.rotate_left(turn);
    Some(Plan {
        misfit: misfit + 0.5 * stretch,
        corners: turned,
        cut: Some(cut),
    })
}

/// How far edges along the spokes and the line are from `size_m`, or `None` if the counts do not
/// fit: the mean of `(r - 1/r)² / 4` over the ratios r, near 1 the squared logarithm.
fn pair_stretch(
    contour: &Contour,
    corners: &[usize],
    counts: &[usize],
    cut: Cut,
    size_m: f64,
) -> Option<f64> {
    let (triangle, pentagon) = pair_counts(counts, cut);
    let (three, five) = (loose_spokes(&triangle)?, spokes(&pentagon)?);
    let n = contour.len();
    let at = |entry: usize| contour.at[entry % n];
    let (before, after) = (corners[0] + n - cut.before, corners[0] + cut.after);
    let (p, q) = (at(before), at(after));
    let far = [corners[1], corners[2], corners[3]].map(at);
    let mut sum = 0.0;
    let mut weigh = |a: Xy, b: Xy, count: usize| {
        let wished = count as f64 * size_m;
        let ratio2 = ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)) / (wished * wished);
        sum += 0.25 * (ratio2 + 1.0 / ratio2 - 2.0);
    };
    let near = at(corners[0]);
    if three[1] == 0 {
        let bend = bend(near, p, q);
        weigh(q, bend, three[0]);
        weigh(bend, p, three[2]);
    } else {
        weigh(p, q, cut.across);
        let centre = centroid(&[near, p, q]);
        for (side, (a, b)) in [(near, q), (q, p), (p, near)].into_iter().enumerate() {
            weigh(centre, middle(a, b), three[side]);
        }
    }
    let ring = [q, far[0], far[1], far[2], p];
    let centre = centroid(&ring);
    for side in 0..5 {
        let foot = middle(ring[side], ring[(side + 1) % 5]);
        weigh(centre, foot, five[side]);
    }
    Some(sum / 9.0)
}

/// Counts of the triangle (from corner 0 on) and of the pentagon (from the line's end past it).
fn pair_counts(counts: &[usize], cut: Cut) -> ([usize; 3], [usize; 5]) {
    (
        [cut.after, cut.across, cut.before],
        [
            counts[0] - cut.after,
            counts[1],
            counts[2],
            counts[3] - cut.before,
            cut.across,
        ],
    )
}

/// Where the line across `near` bends if the triangle is a mere grid: between the fourth corner of
/// a parallelogram, which the grid would like, and a straight line, which the pentagon would.
fn bend(near: Xy, p: Xy, q: Xy) -> Xy {
    std::array::from_fn(|axis| 0.8 * (p[axis] + q[axis]) - 0.6 * near[axis])
}

fn middle(a: Xy, b: Xy) -> Xy {
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
}

fn centroid(points: &[Xy]) -> Xy {
    let n = points.len() as f64;
    std::array::from_fn(|axis| points.iter().map(|p| p[axis]).sum::<f64>() / n)
}

/// Lays `plan` and smooths it if that makes its worst quad better.
fn lay_plan(sheet: &mut Sheet, contour: &Contour, plan: &Plan) -> Shape {
    let mark = sheet.mark();
    let sides = sides(contour, &plan.corners);
    match plan.cut {
        Some(cut) => lay_pair(sheet, &sides, cut),
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

/// A star over sides whose counts have spokes.
fn lay_star(sheet: &mut Sheet, sides: &[Vec<u32>]) {
    let n = sides.len();
    let counts: Vec<usize> = sides.iter().map(|side| side.len() - 1).collect();
    let spokes = spokes(&counts).expect("a plan is made only if the counts fit");
    // Side i: spoke[i - 1] edges up to its foot, spoke[i + 1] after it.
    let split = |i: usize| spokes[(i + n - 1) % n];
    let feet: Vec<Xy> = (0..n)
        .map(|i| sheet.nodes[sides[i][split(i)] as usize])
        .collect();
    let centre = sheet.node(centroid(&feet));
    let lines: Vec<Vec<u32>> = (0..n)
        .map(|i| sheet.line(sides[i][split(i)], centre, spokes[i]))
        .collect();
    for i in 0..n {
        let before = (i + n - 1) % n;
        // The grid at corner i: along side i, up its spoke, and back along that of the side before.
        let south = &sides[i][..=split(i)];
        let west: Vec<u32> = sides[before][split(before)..]
            .iter()
            .rev()
            .copied()
            .collect();
        sheet.grid(south, &lines[i], &lines[before], &west);
    }
}

/// A triangle at corner 0 and the pentagon left. Without a spoke to the line, the triangle is a
/// grid and its centre, still of valence 3, lies on the line.
fn lay_pair(sheet: &mut Sheet, sides: &[Vec<u32>], cut: Cut) {
    let (up, past) = (&sides[3], &sides[0]);
    let split = up.len() - 1 - cut.before;
    let (p, q) = (up[split], past[cut.after]);
    let near = [past[..=cut.after].to_vec(), up[split..].to_vec()];
    let line = if cut.across == cut.before + cut.after {
        let [a, b, c] = [past[0], p, q].map(|node| sheet.nodes[node as usize]);
        let centre = sheet.node(bend(a, b, c));
        let (east, north) = (
            sheet.line(q, centre, cut.before),
            sheet.line(p, centre, cut.after),
        );
        let west: Vec<u32> = near[1].iter().rev().copied().collect();
        sheet.grid(&near[0], &east, &north, &west);
        let rest = north[..cut.after].iter().rev();
        east.iter().chain(rest).copied().collect()
    } else {
        let line = sheet.line(q, p, cut.across);
        let [after, before] = near;
        lay_star(sheet, &[after, line.clone(), before]);
        line
    };
    let five = [
        past[cut.after..].to_vec(),
        sides[1].clone(),
        sides[2].clone(),
        up[..=split].to_vec(),
        line.iter().rev().copied().collect(),
    ];
    lay_star(sheet, &five);
}
