//! A 3-5 pair: loops of four sides whose opposite counts differ, by one node of valence 3 and one
//! of valence 5.
//!
//! A line across one corner cuts the loop into a triangle and a pentagon, and each is a star (see
//! `spokes`). Which corner, where the line meets the two sides there, and how many edges it has are
//! free; of all lines for which both stars exist, the best is the one whose spokes, and the line
//! itself, have edges as long as those of the loop. If the triangle's spoke to the line has no edge,
//! its centre lies on the line, which then bends there.
//!
//! In a lattice a pair is a dislocation: rows that come in by one side of the loop do not leave by
//! the opposite one (Peng, Zhang, Kobayashi, Wonka 2011). The search over all such cuts is ours; the
//! stars are those of Tarini (2021).
//!
//! Cost: the two counts at the corner multiplied, times how far opposite counts differ; only as many
//! lines are weighed, and none in loops of more than [`LONGEST`] edges.

use crate::geometry::point::Xy;
use crate::meshing::contour::Contour;
use crate::meshing::sheet::Sheet;
use crate::meshing::spokes::centroid;
use crate::meshing::spokes::lay_star;
use crate::meshing::spokes::loose_spokes;
use crate::meshing::spokes::spokes;

/// Longest loop for which pairs are searched.
const LONGEST: usize = 800;

/// A line across corner 0 of a loop with four sides: `before` edges up to it, `after` edges past it
/// and `across` on the line itself make a triangle; the rest has five sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cut {
    before: usize,
    after: usize,
    across: usize,
}

/// The best pair over four corners.
pub(crate) struct Pair {
    /// The corners, that which is cut off first.
    pub corners: Vec<usize>,
    pub cut: Cut,
    /// How far its edges are from the length of those of the loop, see [`stretch`].
    pub stretch: f64,
}

/// The best line across any of the four corners; `counts` are the edges of the sides between them.
pub(crate) fn best(contour: &Contour, corners: &[usize], counts: &[usize]) -> Option<Pair> {
    if contour.len() > LONGEST {
        return None;
    }
    let size_m = contour.spacing_m.iter().sum::<f64>() / contour.len() as f64;
    let (mut corners, mut counts) = (corners.to_vec(), counts.to_vec());
    let mut best: Option<Pair> = None;
    for _ in 0..4 {
        for cut in cuts(&counts) {
            let Some(stretch) = stretch(contour, &corners, &counts, cut, size_m) else {
                continue;
            };
            if best.as_ref().is_none_or(|pair| stretch < pair.stretch) {
                best = Some(Pair {
                    corners: corners.clone(),
                    cut,
                    stretch,
                });
            }
        }
        corners.rotate_left(1);
        counts.rotate_left(1);
    }
    best
}

/// The lines across corner 0, whether or not both stars exist.
fn cuts(counts: &[usize]) -> impl Iterator<Item = Cut> {
    // The spokes of triangle and pentagon to the line have this many edges together.
    let excess = (counts[0] + counts[3]).saturating_sub(counts[1] + counts[2]) / 2;
    let ends =
        (1..counts[3]).flat_map(move |before| (1..counts[0]).map(move |after| (before, after)));
    ends.flat_map(move |(before, after)| {
        (0..excess.min(before).min(after)).map(move |spoke| Cut {
            before,
            after,
            across: before + after - 2 * spoke,
        })
    })
}

/// How far edges along the spokes and the line are from `size_m`, or `None` if the counts do not
/// fit: the mean of `(r - 1/r)² / 4` over the ratios r, near 1 the squared logarithm.
fn stretch(
    contour: &Contour,
    corners: &[usize],
    counts: &[usize],
    cut: Cut,
    size_m: f64,
) -> Option<f64> {
    let (triangle, pentagon) = counts_of_halves(counts, cut);
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
fn counts_of_halves(counts: &[usize], cut: Cut) -> ([usize; 3], [usize; 5]) {
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

/// A triangle at corner 0 and the pentagon left. Without a spoke to the line, the triangle is a
/// grid and its centre, still of valence 3, lies on the line.
pub(crate) fn lay(sheet: &mut Sheet, sides: &[Vec<u32>], cut: Cut) {
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
