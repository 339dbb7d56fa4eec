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

/// Most visits, and longest loop with its bridges: comparing lines costs O(n²), so more are for
/// methods that scale. At 700 visits the lines cost a third of the finish.
const LONGEST: usize = 1200;
const LONGEST_MERGED: usize = 2400;
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
    // The whole is left to `mapping`: here it is split even where a pattern would fit.
    let contour = Contour::of(&sheet, ids);
    if contour.len() <= SMALL {
        lay_small(&mut sheet, &contour, size_m)?;
    } else {
        let mut open = split(&mut sheet, &contour, size_m)?.to_vec();
        while let Some(ids) = open.pop() {
            let contour = Contour::of(&sheet, ids);
            if contour.len() <= SMALL {
                lay_small_or_pattern(&mut sheet, &contour, size_m)?;
            } else if lay_pattern(&mut sheet, &contour).is_none() {
                open.extend(split(&mut sheet, &contour, size_m)?);
            }
        }
    }
    Some(sheet.into_draft(visits.len(), Method::Looping))
}

/// Splits a loop by its best line.
fn split(sheet: &mut Sheet, contour: &Contour, size_m: f64) -> Option<[Vec<u32>; 2]> {
    let split = splitting::best(sheet, contour, size_m, 1).pop()?;
    Some(splitting::halves(sheet, contour, split, size_m))
}

/// Lays a pattern if it has good shape.
fn lay_pattern(sheet: &mut Sheet, contour: &Contour) -> Option<Shape> {
    let mark = sheet.mark();
    let shape = patterns::lay(sheet, contour).filter(|shape| shape.least > PATTERN_LEAST);
    if shape.is_none() {
        sheet.undo(mark);
    }
    shape
}

/// Meshes a small loop by a pattern if one fits well.
fn lay_small_or_pattern(sheet: &mut Sheet, contour: &Contour, size_m: f64) -> Option<Shape> {
    if contour.len() > 6
        && let Some(shape) = lay_pattern(sheet, contour)
    {
        return Some(shape);
    }
    lay_small(sheet, contour, size_m)
}

/// Meshes a small loop by a closure, or by the best of several lines, each tried to the end.
fn lay_small(sheet: &mut Sheet, contour: &Contour, size_m: f64) -> Option<Shape> {
    let tried = match contour.len() {
        4 | 6 => return Some(closures::close(sheet, &contour.ids)),
        8 => 8,
        10 => 4,
        _ => 2,
    };
    let mark = sheet.mark();
    let mut best: Option<(f64, Split)> = None;
    for split in splitting::best(sheet, contour, size_m, tried) {
        if let Some(shape) = lay_halves(sheet, contour, split, size_m) {
            let worth = shape.mean().min(0.5 + shape.least);
            if best.is_none_or(|(most, _)| worth > most) {
                best = Some((worth, split));
            }
        }
        sheet.undo(mark);
    }
    lay_halves(sheet, contour, best?.1, size_m)
}

fn lay_halves(sheet: &mut Sheet, contour: &Contour, split: Split, size_m: f64) -> Option<Shape> {
    let mut shape = Shape::NONE;
    for ids in splitting::halves(sheet, contour, split, size_m) {
        // A loop that is closed needs no angles, which are most of the cost of a small one.
        let half = match ids.len() {
            4 | 6 => closures::close(sheet, &ids),
            _ => {
                let half = Contour::of(sheet, ids);
                lay_small_or_pattern(sheet, &half, size_m)?
            }
        };
        shape = shape.with(half);
    }
    Some(shape)
}
