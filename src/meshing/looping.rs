//! Looping: split the loop by its best line, and the two halves again, down to patterns and loops
//! of four or six nodes (Talbert and Parkinson 1990).
//!
//! Where we depart: a half that has become a few-sided pattern is laid as a whole, and small loops
//! try several lines and keep the one with the best shape.

use crate::meshing::bridges;
use crate::meshing::closures;
use crate::meshing::contour::Contour;
use crate::meshing::draft::Draft;
use crate::meshing::patch::Method;
use crate::meshing::patterns;
use crate::meshing::sheet::Shape;
use crate::meshing::sheet::Sheet;
use crate::meshing::splitting;
use crate::meshing::splitting::Split;
use crate::meshing::visits::Visits;

/// Longest walk, and longest loop with its bridges: lines cost O(n²), so longer ones are for methods
/// that scale.
const LONGEST: usize = 400;
const LONGEST_MERGED: usize = 600;
/// A pattern with a least scaled Jacobian above this ends the splitting.
const PATTERN_LEAST: f64 = 0.5;
/// Loops up to this length try several lines.
const SMALL: usize = 12;

/// Quads by recursive splitting; `None` if the walks are too long or some loop has no line left.
pub(crate) fn mesh(visits: &Visits, size_m: f64) -> Option<Draft> {
    if visits.len() > LONGEST {
        return None;
    }
    let mut sheet = Sheet::over(visits);
    let ids = bridges::merge(&mut sheet, visits, size_m)?;
    if ids.len() > LONGEST_MERGED {
        return None;
    }
    let mut open = vec![ids];
    let mut whole = true;
    while let Some(ids) = open.pop() {
        // The whole is left to `mapping`: here it is split even where a pattern would fit.
        if ids.len() <= 6 || (ids.len() <= SMALL && !whole) {
            lay_small(&mut sheet, ids, size_m)?;
            continue;
        }
        let contour = Contour::of(&sheet, ids);
        if whole || !lay_pattern(&mut sheet, &contour) {
            let split = splitting::best(&contour, size_m, 1).pop()?;
            open.extend(halves(&mut sheet, &contour, split, size_m));
        }
        whole = false;
    }
    Some(sheet.into_draft(visits.len(), Method::Looping))
}

/// Lays a pattern if it has good shape.
fn lay_pattern(sheet: &mut Sheet, contour: &Contour) -> bool {
    let mark = sheet.mark();
    let good = patterns::lay(sheet, contour).is_some_and(|shape| shape.least > PATTERN_LEAST);
    if !good {
        sheet.undo(mark);
    }
    good
}

/// Meshes a small loop by the best of several lines, tried to the end.
fn lay_small(sheet: &mut Sheet, ids: Vec<u32>, size_m: f64) -> Option<Shape> {
    if ids.len() <= 6 {
        return Some(closures::close(sheet, &ids));
    }
    let contour = Contour::of(sheet, ids);
    let mark = sheet.mark();
    if lay_pattern(sheet, &contour) {
        return Some(sheet.shape(mark));
    }
    let tried = match contour.len() {
        8 => 8,
        10 => 4,
        _ => 2,
    };
    let mut best: Option<(f64, Split)> = None;
    for split in splitting::best(&contour, size_m, tried) {
        if let Some(shape) = lay_halves(sheet, &contour, split, size_m) {
            let worth = shape.mean.min(0.5 + shape.least);
            if best.is_none_or(|(most, _)| worth > most) {
                best = Some((worth, split));
            }
        }
        sheet.undo(mark);
    }
    lay_halves(sheet, &contour, best?.1, size_m)
}

fn lay_halves(sheet: &mut Sheet, contour: &Contour, split: Split, size_m: f64) -> Option<Shape> {
    let mark = sheet.mark();
    let [left, right] = halves(sheet, contour, split, size_m);
    lay_small(sheet, left, size_m)?;
    lay_small(sheet, right, size_m)?;
    Some(sheet.shape(mark))
}

/// Lays the line and returns the loops on both sides of it.
fn halves(sheet: &mut Sheet, contour: &Contour, split: Split, size_m: f64) -> [Vec<u32>; 2] {
    let Split {
        from, to, count, ..
    } = split;
    let ends = [contour.ids[from], contour.ids[to]];
    let ends_m = [contour.spacing_m[from], contour.spacing_m[to]];
    let line = splitting::lay_line(sheet, ends, ends_m, size_m, count);
    let inner = &line[1..line.len() - 1];
    let mut left = contour.ids[from..=to].to_vec();
    left.extend(inner.iter().rev());
    let mut right = contour.ids[to..].to_vec();
    right.extend(&contour.ids[..=from]);
    right.extend(inner);
    [left, right]
}
