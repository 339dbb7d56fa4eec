//! Submapping: a sub-domain whose walks close on a square lattice takes the cells of that lattice,
//! without one irregular node, whatever re-entrant corners, inner walks and slits it has.
//!
//! 1. `course`: the quarter turn of each visit; so each walk is a polygon of unit edges.
//! 2. Each must close: as many edges in a direction as against it (`parity` is asked for it, see
//!    `intervals::submaps`). An inner walk is turned and shifted to where the outer one suggests.
//! 3. `lattice_cells`: the cells that the walks enclose.
//! 4. Inner nodes start where the nearest visits suggest, and are relaxed.
//!
//! After Whiteley, White, Benzley and Blacker (1996), several walks after Ruiz-Girones and Sarrate
//! (2010), who ask a linear programme where inner walks lie; here the geometry says it.
//!
//! Cost: cells times visits, for step 4: 1 ms for 700 cells.

use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::meshing::course::Course;
use crate::meshing::draft::Draft;
use crate::meshing::lattice_cells::Cells;
use crate::meshing::lattice_cells::Placed;
use crate::meshing::lattice_cells::carried;
use crate::meshing::patch::Method;
use crate::meshing::sheet::Sheet;
use crate::meshing::visits::Visits;

/// Sweeps after which the inner nodes no longer depend on where they started.
pub(crate) const SWEEPS: usize = 30;

/// So many times the cells that the size asks for may the lattice have, beside one a visit.
const WASTE: f64 = 3.0;

/// An inner walk that should lie this far beyond a place of the lattice, cells, is tried at the next
/// one too.
const BETWEEN: f64 = 0.25;

/// The cells of the lattice on which the walks close; `None` if they do not.
pub(crate) fn mesh(visits: &Visits, walks: &mut [Course], size_m: f64) -> Option<Draft> {
    if !walks.iter().all(Course::is_closed) {
        return None;
    }
    let sheet = cover(visits, walks, size_m)?;
    Some(sheet.into_draft(visits.len(), Method::Mapping))
}

/// The cells within walks that close, the inner ones where they fit best.
pub(crate) fn cover(visits: &Visits, walks: &mut [Course], size_m: f64) -> Option<Sheet> {
    let wished = visits.area_m2() / (size_m * size_m) + visits.len() as f64;
    let most = (WASTE * wished) as usize;
    let wishes = wished_shifts(visits, walks);
    let mut shifts: Vec<[i32; 2]> = (wishes.iter())
        .map(|wish| wish.map(|it| it.round() as i32))
        .collect();
    let mut best = lay(visits, walks, &shifts, most);
    for (walk, wish) in wishes.iter().enumerate() {
        for axis in 0..2 {
            let beyond = wish[axis] - f64::from(shifts[walk][axis]);
            if beyond.abs() < BETWEEN {
                continue;
            }
            let mut other = shifts.clone();
            other[walk][axis] += beyond.signum() as i32;
            let draft = lay(visits, walks, &other, most);
            let is_better = match (&best, &draft) {
                (_, None) => false,
                (None, _) => true,
                (Some(one), Some(two)) => two.1 > one.1,
            };
            if is_better {
                (best, shifts) = (draft, other);
            }
        }
    }
    best.map(|(sheet, _)| sheet)
}

/// The cells with the inner walks shifted so, and their mean shape.
fn lay(
    visits: &Visits,
    walks: &[Course],
    shifts: &[[i32; 2]],
    most: usize,
) -> Option<(Sheet, f64)> {
    let place = Placed::of(visits, walks, shifts);
    let cells = Cells::within(visits, &place, most)?;
    let mut sheet = Sheet::over(visits);
    let mark = sheet.mark();
    cells.lay(&mut sheet, &place);
    sheet.relax(mark, SWEEPS);
    let worth = sheet.shape(mark).mean();
    Some((sheet, worth))
}

/// Turns the inner walks as the outer one lies, and says how far each should be shifted.
fn wished_shifts(visits: &Visits, walks: &mut [Course]) -> Vec<Xy> {
    let axis_rad = walks[0].axis_rad(visits);
    let outer: Vec<(Xy, Xy)> = (walks[0].visits.clone().zip(&walks[0].at))
        .map(|(visit, at)| (visits.nodes[visit], at.map(f64::from)))
        .collect();
    let onto = onto_lattice(visits, &walks[0]);
    let shift = |walk: &mut Course| {
        let off_rad = walk.axis_rad(visits) - axis_rad;
        let quarters = (off_rad / std::f64::consts::FRAC_PI_2).round() as i32;
        walk.turn(quarters.rem_euclid(4) as usize);
        let mut mean = [0.0, 0.0];
        for (visit, at) in walk.visits.clone().zip(&walk.at) {
            let should = carried(visits.nodes[visit], &outer, onto);
            for axis in 0..2 {
                mean[axis] += (should[axis] - f64::from(at[axis])) / walk.at.len() as f64;
            }
        }
        mean
    };
    walks[1..].iter_mut().map(shift).collect()
}

/// The plain map onto the lattice: turned as the outer walk lies, one lattice edge an edge of the walks on average.
pub(crate) fn onto_lattice(visits: &Visits, outer: &Course) -> impl Fn(Xy) -> Xy + Copy + use<> {
    let length = |visit: u32| {
        let ends = [visit, visits.next(visit)].map(|it| visits.nodes[it as usize]);
        distance(ends[0], ends[1])
    };
    let scale = visits.len() as f64 / (0..visits.len() as u32).map(length).sum::<f64>();
    let (sin, cos) = outer.axis_rad(visits).sin_cos();
    move |p: Xy| {
        [
            scale * (cos * p[0] + sin * p[1]),
            scale * (cos * p[1] - sin * p[0]),
        ]
    }
}
