//! Submapping: a sub-domain whose walks close on a square lattice takes the cells of that lattice,
//! without one irregular node, whatever re-entrant corners, inner walks and slits it has.
//!
//! 1. `turns`: the quarter turn of each visit; so each walk is a polygon of unit edges.
//! 2. Each must close: as many edges in a direction as against it (`parity` is asked for it, see
//!    `intervals::submaps`). An inner walk is turned and shifted to where the outer one suggests.
//! 3. Each visit claims the lattice quarters on its left. From there cells are taken up to the walks.
//!    They are right if no two visits claim one quarter and there are as many as the polygons enclose.
//! 4. Inner nodes start where the nearest visits suggest, and are relaxed.
//!
//! After Whiteley, White, Benzley and Blacker (1996), several walks after Ruiz-Girones and Sarrate
//! (2010), who ask a linear programme where inner walks lie; here the geometry says it.
//!
//! Cost: cells times visits, for step 4: 1 ms for 700 cells.

use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::geometry::turns::quarter_turns;
use crate::meshing::draft::Draft;
use crate::meshing::patch::Loops;
use crate::meshing::patch::Method;
use crate::meshing::sheet::Sheet;
use crate::meshing::triangulate::NONE;
use crate::meshing::visits::Visits;

/// Sweeps after which the inner nodes no longer depend on where they started.
const SWEEPS: usize = 30;

/// So many times the cells that the size asks for may the lattice have, beside one a visit.
const WASTE: f64 = 3.0;

/// An inner walk that should lie this far beyond a place of the lattice, cells, is tried at the next
/// one too.
const BETWEEN: f64 = 0.25;

/// Unit steps of the four directions.
const STEP: [[i32; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];

/// The cells of the lattice on which the walks close; `None` if they do not.
pub(crate) fn mesh(visits: &Visits, loops: &Loops) -> Option<Draft> {
    let mut walks = (0..visits.walk_start.len() - 1)
        .map(|walk| Closed::of(visits, walk))
        .collect::<Option<Vec<Closed>>>()?;
    let wished = visits.area_m2() / (loops.size_m * loops.size_m) + visits.len() as f64;
    let most = (WASTE * wished) as usize;
    let wishes = wished_shifts(visits, &mut walks);
    let mut shifts: Vec<[i32; 2]> = (wishes.iter())
        .map(|wish| wish.map(|it| it.round() as i32))
        .collect();
    let mut best = lay(visits, &walks, &shifts, most);
    for (walk, wish) in wishes.iter().enumerate() {
        for axis in 0..2 {
            let beyond = wish[axis] - f64::from(shifts[walk][axis]);
            if beyond.abs() < BETWEEN {
                continue;
            }
            let mut other = shifts.clone();
            other[walk][axis] += beyond.signum() as i32;
            let draft = lay(visits, &walks, &other, most);
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
    best.map(|(sheet, _)| sheet.into_draft(visits.len(), Method::Mapping))
}

/// The cells with the inner walks shifted so, and their mean shape.
fn lay(
    visits: &Visits,
    walks: &[Closed],
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

/// A walk on the lattice.
struct Closed {
    visits: std::ops::Range<usize>,
    /// Direction of the edge from each visit on.
    direction: Vec<usize>,
    /// Places of the visits.
    at: Vec<[i32; 2]>,
}

impl Closed {
    fn of(visits: &Visits, walk: usize) -> Option<Closed> {
        let range = visits.walk_start[walk]..visits.walk_start[walk + 1];
        let turn_deg = |visit| 180.0 - visits.angle(visit).to_degrees();
        let turns_deg: Vec<f64> = range.clone().map(turn_deg).collect();
        let quarters = quarter_turns(&turns_deg, if walk == 0 { 4 } else { -4 })?;
        let mut closed = Closed {
            visits: range.start as usize..range.end as usize,
            direction: Vec::with_capacity(quarters.len()),
            at: Vec::with_capacity(quarters.len()),
        };
        let (mut at, mut direction) = ([0, 0], 0);
        for (k, &quarter) in quarters.iter().enumerate() {
            if k > 0 {
                direction = (direction + i32::from(quarter)).rem_euclid(4);
            }
            closed.direction.push(direction as usize);
            closed.at.push(at);
            at = plus(at, STEP[direction as usize]);
        }
        (at == [0, 0]).then_some(closed)
    }

    /// Where direction 0 points on average, radians.
    fn axis_rad(&self, visits: &Visits) -> f64 {
        let mut sum = [0.0, 0.0];
        for (visit, &direction) in self.visits.clone().zip(&self.direction) {
            let [a, b] =
                [visit as u32, visits.next(visit as u32)].map(|it| visits.nodes[it as usize]);
            let along = turned([b[0] - a[0], b[1] - a[1]], 4 - direction);
            sum = [sum[0] + along[0], sum[1] + along[1]];
        }
        f64::atan2(sum[1], sum[0])
    }

    /// Turns the walk counter-clockwise by quarters.
    fn turn(&mut self, quarters: usize) {
        for direction in &mut self.direction {
            *direction = (*direction + quarters) % 4;
        }
        for at in &mut self.at {
            for _ in 0..quarters {
                *at = [-at[1], at[0]];
            }
        }
    }
}

fn plus(a: [i32; 2], b: [i32; 2]) -> [i32; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

fn turned(v: Xy, quarters: usize) -> Xy {
    match quarters % 4 {
        0 => v,
        1 => [-v[1], v[0]],
        2 => [-v[0], -v[1]],
        _ => [v[1], -v[0]],
    }
}

/// All visits on one lattice.
struct Placed {
    /// Visit -> its place, from [0, 0] up, and the directions of the edges to and from it.
    at: Vec<[i32; 2]>,
    to: Vec<usize>,
    from: Vec<usize>,
    /// The largest place.
    extent: [i32; 2],
}

/// Turns the inner walks as the outer one lies, and says how far each should be shifted.
fn wished_shifts(visits: &Visits, walks: &mut [Closed]) -> Vec<Xy> {
    let axis_rad = walks[0].axis_rad(visits);
    let outer: Vec<(Xy, Xy)> = (walks[0].visits.clone().zip(&walks[0].at))
        .map(|(visit, at)| (visits.nodes[visit], at.map(f64::from)))
        .collect();
    let scale = visits.len() as f64 / perimeter_m(visits);
    let (sin, cos) = axis_rad.sin_cos();
    let onto = |p: Xy| {
        [
            scale * (cos * p[0] + sin * p[1]),
            scale * (cos * p[1] - sin * p[0]),
        ]
    };
    let shift = |walk: &mut Closed| {
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

fn perimeter_m(visits: &Visits) -> f64 {
    let length = |visit: u32| {
        let ends = [visit, visits.next(visit)].map(|it| visits.nodes[it as usize]);
        distance(ends[0], ends[1])
    };
    (0..visits.len() as u32).map(length).sum()
}

/// `p` by the plain map `onto`, shifted as the known pairs (from, to) around it are: the weight of
/// each falls with the fourth power of its distance (Shepard 1968).
fn carried(p: Xy, known: &[(Xy, Xy)], onto: impl Fn(Xy) -> Xy) -> Xy {
    let (mut sum, mut shift) = (0.0, [0.0, 0.0]);
    for &(from, to) in known {
        let square = (from[0] - p[0]).powi(2) + (from[1] - p[1]).powi(2);
        let weight = 1.0 / (square * square).max(1e-12);
        let plain = onto(from);
        sum += weight;
        for axis in 0..2 {
            shift[axis] += weight * (to[axis] - plain[axis]);
        }
    }
    let plain = onto(p);
    [plain[0] + shift[0] / sum, plain[1] + shift[1] / sum]
}

/// The cells inside.
struct Cells {
    /// Cells in a row, and rows.
    columns: i32,
    /// Place and quarter (north-east first, counter-clockwise) -> the visit that claims it.
    claims: Vec<u32>,
    /// Which cells are inside.
    inside: Vec<bool>,
}

impl Cells {
    /// At most `most` cells.
    fn within(visits: &Visits, place: &Placed, most: usize) -> Option<Cells> {
        let [columns, rows] = place.extent;
        let count = columns as usize * rows as usize;
        if columns < 1 || rows < 1 || count > 4 * most {
            return None;
        }
        let mut cells = Cells {
            columns,
            claims: vec![NONE; 4 * (columns as usize + 1) * (rows as usize + 1)],
            inside: vec![false; count],
        };
        cells.claim(place)?;
        let taken = cells.flood(place, rows)?;
        (taken <= most && taken as i64 == enclosed(visits, place)).then_some(cells)
    }

    fn corner(&self, at: [i32; 2], quarter: usize) -> usize {
        4 * (at[1] as usize * (self.columns as usize + 1) + at[0] as usize) + quarter
    }

    /// Each visit claims the quarters between its edge ahead and, counter-clockwise, the one behind.
    fn claim(&mut self, place: &Placed) -> Option<()> {
        for (visit, &at) in place.at.iter().enumerate() {
            let (from, back) = (place.from[visit], (place.to[visit] + 2) % 4);
            let mut quarter = from;
            loop {
                let corner = self.corner(at, quarter);
                if self.claims[corner] != NONE {
                    return None;
                }
                self.claims[corner] = visit as u32;
                quarter = (quarter + 1) % 4;
                if quarter == back {
                    break;
                }
            }
        }
        Some(())
    }

    /// Takes the cells of all claims and what lies beside them up to the walks; how many.
    fn flood(&mut self, place: &Placed, rows: i32) -> Option<usize> {
        let columns = self.columns;
        let is_cell = |[i, j]: [i32; 2]| (0..columns).contains(&i) && (0..rows).contains(&j);
        let mut open: Vec<[i32; 2]> = Vec::new();
        for &at in &place.at {
            for quarter in 0..4 {
                if self.claims[self.corner(at, quarter)] != NONE {
                    open.push(plus(at, [[0, 0], [-1, 0], [-1, -1], [0, -1]][quarter]));
                }
            }
        }
        let mut taken = 0;
        while let Some(cell) = open.pop() {
            if !is_cell(cell) {
                return None;
            }
            let index = (cell[1] * columns + cell[0]) as usize;
            if std::mem::replace(&mut self.inside[index], true) {
                continue;
            }
            taken += 1;
            // Beyond an edge without a walk: both its ends are not on one, or not in this direction.
            for (side, step) in [[0, -1], [1, 0], [0, 1], [-1, 0]].into_iter().enumerate() {
                let [start, end] = [side, (side + 1) % 4].map(|corner| self.node(cell, corner));
                let on_walk = |start: u32, end: u32| {
                    start != NONE && end != NONE && place.is_edge(start, end, side)
                };
                if !on_walk(start, end) {
                    open.push(plus(cell, step));
                }
            }
        }
        Some(taken)
    }

    /// The visit that is this corner of a cell, south-west first.
    fn node(&self, cell: [i32; 2], corner: usize) -> u32 {
        let at = plus(cell, [[0, 0], [1, 0], [1, 1], [0, 1]][corner]);
        self.claims[self.corner(at, corner)]
    }

    /// Lays the cells.
    fn lay(&self, sheet: &mut Sheet, place: &Placed) {
        let known: Vec<(Xy, Xy)> = (place.at.iter().zip(&sheet.nodes))
            .map(|(at, node)| (at.map(f64::from), *node))
            .collect();
        let mut inner = vec![NONE; self.claims.len() / 4];
        for (index, _) in self.inside.iter().enumerate().filter(|it| *it.1) {
            let index = index as i32;
            let cell = [index % self.columns, index / self.columns];
            let quad = std::array::from_fn(|corner| {
                let claimed = self.node(cell, corner);
                if claimed != NONE {
                    return claimed;
                }
                let at = plus(cell, [[0, 0], [1, 0], [1, 1], [0, 1]][corner]);
                let node = &mut inner[self.corner(at, 0) / 4];
                if *node == NONE {
                    let here = carried(at.map(f64::from), &known, |_| [0.0, 0.0]);
                    *node = sheet.node(here);
                }
                *node
            });
            sheet.quads.push(quad);
        }
    }
}

impl Placed {
    /// The outer walk as it is, the inner ones shifted.
    fn of(visits: &Visits, walks: &[Closed], shifts: &[[i32; 2]]) -> Placed {
        let mut all = walks[0].at.clone();
        for (walk, &shift) in walks[1..].iter().zip(shifts) {
            all.extend(walk.at.iter().map(|&at| plus(at, shift)));
        }
        let least = [0, 1].map(|axis| all.iter().map(|at| at[axis]).min().expect("visits"));
        let mut place = Placed {
            at: (all.iter().map(|at| [at[0] - least[0], at[1] - least[1]])).collect(),
            to: Vec::with_capacity(visits.len()),
            from: Vec::with_capacity(visits.len()),
            extent: [0, 0],
        };
        for walk in walks {
            let last = walk.direction.len() - 1;
            place.to.push(walk.direction[last]);
            place.to.extend(&walk.direction[..last]);
            place.from.extend(&walk.direction);
        }
        place.extent = [0, 1].map(|axis| place.at.iter().map(|at| at[axis]).max().expect("visits"));
        place
    }

    /// True if the walk goes from visit `start` to `end` in this direction.
    fn is_edge(&self, start: u32, end: u32, direction: usize) -> bool {
        let ahead = plus(self.at[start as usize], STEP[direction]);
        self.from[start as usize] == direction
            && self.to[end as usize] == direction
            && ahead == self.at[end as usize]
    }
}

/// How many cells the walks enclose.
fn enclosed(visits: &Visits, place: &Placed) -> i64 {
    let twice = |visit: u32| {
        let [a, b] = [visit, visits.next(visit)].map(|it| place.at[it as usize].map(i64::from));
        a[0] * b[1] - a[1] * b[0]
    };
    (0..visits.len() as u32).map(twice).sum::<i64>() / 2
}
