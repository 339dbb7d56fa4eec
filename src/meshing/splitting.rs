//! The best line to split a loop in two.
//!
//! Cost of a line after Talbert and Parkinson 1990: the angles at both ends, its length, how badly
//! whole edges fit on it; with a structuring index and a term for symmetry, as Sarrate and Huerta
//! 2000 have them: here how well the halves fit a pattern and how much their lengths differ; and
//! (ours) how near it passes other nodes. Where we depart: an angle part is measured against the
//! nearest multiple of 90 degrees, not against 90, and what the corner lacked before the split is
//! not charged to it.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::FRAC_PI_2;
use std::f64::consts::PI;
use std::f64::consts::TAU;

use crate::geometry::point::Xy;
use crate::geometry::quad::cross;
use crate::geometry::quad::distance;
use crate::meshing::contour::Contour;
use crate::meshing::patterns;
use crate::meshing::sheet::Sheet;

/// Weights of angles, length, fit of whole edges, nearness, structure, symmetry. Those of the paper
/// (.5, .3 and .2 for the first three) give 5 % more irregular nodes in five cities. Halves of like
/// length are worth little for shape, but keep the recursion of long loops shallow.
const ANGLES: f64 = 1.0;
const LENGTH: f64 = 0.3;
const FIT: f64 = 0.1;
const NEARNESS: f64 = 0.3;
const STRUCTURE: f64 = 0.1;
const SYMMETRY: f64 = 0.1;
/// A node nearer to a line than this many times its spacing is near.
const NEAR: f64 = 0.8;
/// No part of an interior angle may be smaller, radians.
const SHARPEST: f64 = 8.0 * PI / 180.0;
/// From here on an interior angle is the tip of a slit: where a line leaves it hardly matters.
const TIP: f64 = 315.0 * PI / 180.0;
/// All lines of loops up to this length are compared; of longer ones those from reflex corners, and
/// a share of the others: shifted by an entry or two, most are as good.
const ALL_COMPARED: usize = 120;
/// From here on a corner is reflex, radians.
const REFLEX: f64 = 225.0 * PI / 180.0;
/// Visible lines that are compared with nearness and structure.
const COMPARED: usize = 6;
/// Longest loop whose lines are compared for structure: the halves of longer ones are seldom
/// patterns, and finding out is square in their length.
const STRUCTURE_LONGEST: usize = 300;

/// A line between two entries of a loop, `from < to`, in `count` edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Split {
    pub from: usize,
    pub to: usize,
    pub count: usize,
    pub cost: f64,
}

/// Up to `most` lines inside the loop, cheapest first. Both sub-loops are even, have at least four
/// entries and fewer than the loop.
pub(crate) fn best(sheet: &mut Sheet, contour: &Contour, size_m: f64, most: usize) -> Vec<Split> {
    let mut heap = all(contour, size_m);
    let mut found: Vec<Split> = Vec::new();
    while let Some(Reverse((cost, from, to, count))) = heap.pop() {
        let (from, to) = (from as usize, to as usize);
        if let Some(clearance) = contour.clearance(contour.at[from], contour.at[to]) {
            found.push(Split {
                from,
                to,
                count: count as usize,
                cost: f64::from_bits(cost) + NEARNESS * (NEAR - clearance).max(0.0),
            });
            if found.len() == most.max(COMPARED) {
                break;
            }
        }
    }
    reward_structure(sheet, contour, size_m, &mut found);
    found.sort_by(|p, q| p.cost.total_cmp(&q.cost));
    found.truncate(most);
    found
}

/// Makes lines cheaper whose halves promise to be patterns.
fn reward_structure(sheet: &mut Sheet, contour: &Contour, size_m: f64, splits: &mut [Split]) {
    if !(9..=STRUCTURE_LONGEST).contains(&contour.len()) {
        return;
    }
    let mark = sheet.mark();
    for split in splits {
        for ids in halves(sheet, contour, *split, size_m) {
            if ids.len() > 4 {
                let half = Contour::of(sheet, ids);
                split.cost -= STRUCTURE * patterns::promise(&half);
            }
        }
        sheet.undo(mark);
    }
}

/// A line before it is known to be visible: bits of its (positive) cost, ends, count.
type Candidate = Reverse<(u64, u32, u32, u32)>;

/// All lines that parity, lengths and angles allow. O(n²).
fn all(contour: &Contour, size_m: f64) -> BinaryHeap<Candidate> {
    let n = contour.len();
    let diagonal_m = diagonal_m(&contour.at);
    let stride = n.div_ceil(ALL_COMPARED);
    let mut lines = Vec::new();
    for from in 0..n {
        for to in from + 2..n.min(from + n - 1) {
            let reflex = contour.angle[from].max(contour.angle[to]) > REFLEX;
            if !reflex && (from + to) % stride != 0 {
                continue;
            }
            let Some(angles) = angle_error(contour, from, to) else {
                continue;
            };
            let length = distance(contour.at[from], contour.at[to]);
            let ends = [contour.spacing_m[from], contour.spacing_m[to]];
            let ideal = ideal_count(length, ends, size_m);
            let Some(count) = best_count(ideal, to - from, n) else {
                continue;
            };
            let fit = misfit(count, ideal);
            // Splitting can gain up to two right angles in all; the cost stays positive.
            let shorter = (to - from).min(n - to + from);
            let cost = ANGLES * (0.5 + angles / TAU)
                + LENGTH * length / diagonal_m
                + FIT * fit
                + SYMMETRY * (1.0 - 2.0 * shorter as f64 / n as f64);
            lines.push(Reverse((
                cost.max(0.0).to_bits(),
                from as u32,
                to as u32,
                count as u32,
            )));
        }
    }
    BinaryHeap::from(lines)
}

/// How much worse the four angles at the ends of the line are than the two before, radians; `None`
/// if the line does not leave both ends into the area.
fn angle_error(contour: &Contour, from: usize, to: usize) -> Option<f64> {
    let (a, b) = (contour.at[from], contour.at[to]);
    if a == b || looks_out(contour, from, b) || looks_out(contour, to, a) {
        return None;
    }
    let direction = (b[1] - a[1]).atan2(b[0] - a[0]);
    let there = end_error(contour.opening(from, direction), contour.angle[from])?;
    let back = end_error(contour.opening(to, direction + PI), contour.angle[to])?;
    Some(there + back)
}

/// True if the line from `entry` to `p` leaves the area at once: without an arc tangent, what the
/// openings would say. Near the sides, where rounding could matter, both refuse.
fn looks_out(contour: &Contour, entry: usize, p: Xy) -> bool {
    let n = contour.len();
    let at = contour.at[entry];
    let after = contour.at[if entry + 1 == n { 0 } else { entry + 1 }];
    let before = contour.at[if entry == 0 { n - 1 } else { entry - 1 }];
    let (right_of_next, left_of_last) = (cross(at, after, p) < 0.0, cross(at, before, p) > 0.0);
    match contour.angle[entry] > PI {
        true => right_of_next && left_of_last,
        false => right_of_next || left_of_last,
    }
}

/// The error that a line adds which splits `angle` at `opening` from its first side.
pub(crate) fn end_error(opening: f64, angle: f64) -> Option<f64> {
    let rest = angle - opening;
    if opening < SHARPEST || rest < SHARPEST {
        return None;
    }
    let error = from_right(opening) + from_right(rest) - from_right(angle);
    Some(if angle > TIP { 0.5 * error } else { error })
}

/// Distance of an angle from the nearest multiple of 90 degrees that is not zero.
fn from_right(angle: f64) -> f64 {
    let right_angles = (angle / FRAC_PI_2 + 0.5) as u32;
    (angle - f64::from(right_angles.max(1)) * FRAC_PI_2).abs()
}

/// Wished edge length at `along_m` on a line of `length_m`: linear between its ends, and with the
/// distance from them more and more the size of the interior.
fn wished_m(along_m: f64, length_m: f64, ends_m: [f64; 2], size_m: f64) -> f64 {
    let linear = ends_m[0] + (ends_m[1] - ends_m[0]) * along_m / length_m;
    let far = along_m.min(length_m - along_m);
    linear + (size_m - linear) * far / (far + 2.0 * size_m)
}

/// Real number of edges that the sizes ask for: the integral of ds / h by Simpson's rule.
pub(crate) fn ideal_count(length_m: f64, ends_m: [f64; 2], size_m: f64) -> f64 {
    let middle = wished_m(0.5 * length_m, length_m, ends_m, size_m);
    length_m * (1.0 / ends_m[0] + 4.0 / middle + 1.0 / ends_m[1]) / 6.0
}

/// The count nearest to `ideal` (in ratio) that leaves two even loops, each shorter than the whole
/// and of four entries or more, for a line that skips `skip` edges of `n`.
fn best_count(ideal: f64, skip: usize, n: usize) -> Option<usize> {
    // n is even, so both ways round skip an even or both an odd number. A count equal to the edges
    // that it replaces would not shorten the loop.
    let most = skip.min(n - skip).checked_sub(2)?;
    let least = 2 - skip % 2;
    if most < least {
        return None;
    }
    let below = (ideal.max(1.0) as usize).clamp(least, most);
    let below = below - (below - least) % 2;
    let above = (below + 2).min(most);
    let above_fits = misfit(above, ideal) < misfit(below, ideal);
    Some(if above_fits { above } else { below })
}

/// How far a count is from the ideal one: near it the logarithm of their ratio.
fn misfit(count: usize, ideal: f64) -> f64 {
    let ratio = count as f64 / ideal;
    0.5 * (ratio - 1.0 / ratio).abs()
}

fn diagonal_m(at: &[Xy]) -> f64 {
    let (mut low, mut high) = (at[0], at[0]);
    for p in at {
        low = [low[0].min(p[0]), low[1].min(p[1])];
        high = [high[0].max(p[0]), high[1].max(p[1])];
    }
    distance(low, high)
}

/// Lays the nodes of a line, both ends included, spaced as the sizes wish.
pub(crate) fn lay_line(
    sheet: &mut Sheet,
    ends: [u32; 2],
    ends_m: [f64; 2],
    size_m: f64,
    count: usize,
) -> Vec<u32> {
    let [a, b] = ends.map(|node| sheet.nodes[node as usize]);
    let length = distance(a, b);
    let steps = 8 * count;
    let mut wished = Vec::with_capacity(steps + 1);
    wished.push(0.0);
    for step in 0..steps {
        let along = (step as f64 + 0.5) / steps as f64 * length;
        let edges = 1.0 / wished_m(along, length, ends_m, size_m);
        wished.push(wished[step] + edges);
    }
    let mut line = Vec::with_capacity(count + 1);
    line.push(ends[0]);
    for edge in 1..count {
        let sum = wished[steps] * edge as f64 / count as f64;
        let step = wished.partition_point(|&w| w < sum).max(1);
        let inside = (sum - wished[step - 1]) / (wished[step] - wished[step - 1]);
        let t = (step as f64 - 1.0 + inside) / steps as f64;
        line.push(sheet.node([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]));
    }
    line.push(ends[1]);
    line
}

/// Lays the line and returns the loops on both sides of it.
pub(crate) fn halves(
    sheet: &mut Sheet,
    contour: &Contour,
    split: Split,
    size_m: f64,
) -> [Vec<u32>; 2] {
    let Split {
        from, to, count, ..
    } = split;
    let ends = [contour.ids[from], contour.ids[to]];
    let ends_m = [contour.spacing_m[from], contour.spacing_m[to]];
    let line = lay_line(sheet, ends, ends_m, size_m, count);
    let inner = &line[1..line.len() - 1];
    let mut left = contour.ids[from..=to].to_vec();
    left.extend(inner.iter().rev());
    let mut right = contour.ids[to..].to_vec();
    right.extend(&contour.ids[..=from]);
    right.extend(inner);
    [left, right]
}
