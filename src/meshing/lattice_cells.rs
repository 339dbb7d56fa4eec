//! The cells of a lattice within walks that close on it.
//!
//! Each visit claims the lattice quarters on its left. From there cells are taken up to the walks. They are right
//! if no two visits claim one quarter and there are as many as the polygons enclose.

use crate::geometry::point::Xy;
use crate::meshing::course::Course;
use crate::meshing::course::STEP;
use crate::meshing::course::plus;
use crate::meshing::sheet::Sheet;
use crate::meshing::triangulate::NONE;
use crate::meshing::visits::Visits;

/// All visits on one lattice.
pub(crate) struct Placed {
    /// Visit -> its place, from [0, 0] up, and the directions of the edges to and from it.
    at: Vec<[i32; 2]>,
    to: Vec<usize>,
    from: Vec<usize>,
    /// The largest place.
    extent: [i32; 2],
}

impl Placed {
    /// The outer walk as it is, the inner ones shifted.
    pub fn of(visits: &Visits, walks: &[Course], shifts: &[[i32; 2]]) -> Placed {
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

/// The cells inside.
pub(crate) struct Cells {
    /// Cells in a row, and rows.
    columns: i32,
    /// Place and quarter (north-east first, counter-clockwise) -> the visit that claims it.
    claims: Vec<u32>,
    /// Which cells are inside.
    inside: Vec<bool>,
}

impl Cells {
    /// At most `most` cells.
    pub fn within(visits: &Visits, place: &Placed, most: usize) -> Option<Cells> {
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
    pub fn lay(&self, sheet: &mut Sheet, place: &Placed) {
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

/// How many cells the walks enclose.
fn enclosed(visits: &Visits, place: &Placed) -> i64 {
    let twice = |visit: u32| {
        let [a, b] = [visit, visits.next(visit)].map(|it| place.at[it as usize].map(i64::from));
        a[0] * b[1] - a[1] * b[0]
    };
    (0..visits.len() as u32).map(twice).sum::<i64>() / 2
}
/// `p` by the plain map `onto`, shifted as the known pairs (from, to) around it are: the weight of
/// each falls with the fourth power of its distance (Shepard 1968).
pub(crate) fn carried(p: Xy, known: &[(Xy, Xy)], onto: impl Fn(Xy) -> Xy) -> Xy {
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
