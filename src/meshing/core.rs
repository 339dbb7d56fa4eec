//! The core: the lattice cells that are far enough from the walks to be left alone.
//!
//! One byte a cell. The walks are drawn into the map once for what is inside (scan lines through
//! the cells' centres) and once for what is near (each edge clears, on each lattice row, the one
//! interval that is closer to it than the clearance). Everything after that touches only cells on
//! the rim of the core, so the bulk costs a fill.

use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::meshing::lattice::Lattice;
use crate::meshing::visits::Visits;

/// Clearance between the walks and the core, pitches: room for one row and one layer of fill.
/// Below 1.75 row, core and walk collide; above 2 the core shrinks and quality stays.
const CLEARANCE: f64 = 2.0;
/// Edges of a seam that leave the lattice (near its ends) only keep the core off themselves.
const SEAM_CLEARANCE: f64 = 0.9;
/// A seam node lies on a lattice node within this, pitches.
const ON_LATTICE: f64 = 1e-3;
/// Smaller islands of core are dropped, cells: their corners cost more than they give.
const LEAST_ISLAND: usize = 6;
/// Rows of core cells next to the strip that the finish may still move. More gain nothing.
const ZONE_ROWS: usize = 3;
/// Beyond this the map would not be small any more, cells.
const LARGEST_MAP: f64 = 1e8;

/// What a cell of the map is.
pub(crate) mod cell {
    /// Its centre is outside the sub-domain.
    pub const OUT: u8 = 0;
    /// Inside, between walks and core.
    pub const STRIP: u8 = 1;
    /// May become core.
    pub const OPEN: u8 = 2;
    /// Core, in one of the rows next to the strip.
    pub const ZONE: u8 = 3;
    /// Core, deeper.
    pub const SETTLED: u8 = 4;
}

/// The map of cells, row by row, with a margin of at least one `OUT` cell on all sides.
#[derive(Clone, Debug)]
pub(crate) struct Core {
    /// Cell (0, 0) has its lowest corner at lattice node (0, 0).
    pub lattice: Lattice,
    /// Cells in a row.
    pub columns: usize,
    /// Number of rows.
    pub rows: usize,
    /// State of cell (i, j) at `j * columns + i`.
    pub cells: Vec<u8>,
    /// Visits at seam edges that are lattice edges: (row, column, visit), sorted.
    pub seam_nodes: Vec<(u32, u32, u32)>,
    /// Visits in lattice coordinates.
    pub visits: Vec<Xy>,
}

impl Core {
    /// Maps the cells inside the walks and chooses the core. `None` if the map would be too large.
    pub fn carve(visits: &Visits, next: &[u32], lattice: Lattice) -> Option<Core> {
        let mut core = Core::blank(visits, lattice)?;
        core.fill_inside(next);
        core.clear_near(visits, next);
        core.respect_seams();
        let rim = core.rim();
        core.open(rim);
        Some(core)
    }

    /// An empty map that holds all visits.
    fn blank(visits: &Visits, mut lattice: Lattice) -> Option<Core> {
        let place: Vec<Xy> = visits
            .nodes
            .iter()
            .map(|&p| lattice.coordinates(p))
            .collect();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in &place {
            for k in 0..2 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        }
        let base = low.map(|v| v.floor() - 2.0);
        let extent = [
            high[0].ceil() + 2.0 - base[0],
            high[1].ceil() + 2.0 - base[1],
        ];
        if extent[0] * extent[1] > LARGEST_MAP {
            return None;
        }
        lattice.origin_m = lattice.place(base);
        let (columns, rows) = (extent[0] as usize, extent[1] as usize);
        Some(Core {
            lattice,
            columns,
            rows,
            cells: vec![cell::OUT; columns * rows],
            seam_nodes: Vec::new(),
            visits: place
                .iter()
                .map(|p| [p[0] - base[0], p[1] - base[1]])
                .collect(),
        })
    }

    /// Opens every cell whose centre is inside: scan lines, even-odd. The two sides of a slit
    /// cancel each other, and no centre lies on a seam.
    fn fill_inside(&mut self, next: &[u32]) {
        let mut crossings: Vec<(u32, f64)> = Vec::new();
        for v in 0..self.visits.len() {
            let (mut a, mut b) = (self.visits[v], self.visits[next[v] as usize]);
            if a[1] > b[1] {
                std::mem::swap(&mut a, &mut b);
            }
            let first = (a[1] - 0.5).ceil() as u32;
            let end = (b[1] - 0.5).ceil() as u32;
            for j in first..end {
                let t = (f64::from(j) + 0.5 - a[1]) / (b[1] - a[1]);
                crossings.push((j, a[0] + t * (b[0] - a[0])));
            }
        }
        crossings.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        for pair in crossings.chunks_exact(2) {
            let first = (pair[0].1 - 0.5).ceil() as usize;
            let end = (pair[1].1 - 0.5).ceil() as usize;
            let row = pair[0].0 as usize * self.columns;
            self.cells[row + first..row + end.max(first)].fill(cell::OPEN);
        }
    }

    /// Closes every cell with a corner nearer to an edge than the clearance; edges of seams that
    /// are lattice edges clear nothing, but their nodes are remembered.
    fn clear_near(&mut self, visits: &Visits, next: &[u32]) {
        for v in 0..self.visits.len() {
            let (a, b) = (self.visits[v], self.visits[next[v] as usize]);
            if !visits.on_seam[v] {
                // A coarse side needs room to get finer.
                let length = distance(a, b);
                self.clear(a, b, CLEARANCE.max(1.0 + 0.8 * length) - 1e-6);
                continue;
            }
            match (lattice_node(a), lattice_node(b)) {
                (Some(p), Some(q)) if p.0.abs_diff(q.0) + p.1.abs_diff(q.1) == 1 => {
                    self.seam_nodes.push((p.1, p.0, v as u32));
                    self.seam_nodes.push((q.1, q.0, next[v]));
                }
                _ => self.clear(a, b, SEAM_CLEARANCE),
            }
        }
        self.seam_nodes.sort_unstable();
        self.seam_nodes.dedup();
    }

    /// The visits at seam edges that lie on lattice node (i, j).
    pub fn seam_visits(&self, i: usize, j: usize) -> &[(u32, u32, u32)] {
        let at = (j as u32, i as u32, 0);
        let first = self.seam_nodes.partition_point(|&known| known < at);
        let here = |&&(row, column, _): &&(u32, u32, u32)| (row, column) == (at.0, at.1);
        let count = self.seam_nodes[first..].iter().take_while(here).count();
        &self.seam_nodes[first..first + count]
    }

    /// Closes the open cells with a corner nearer than `radius` to the segment `a b`.
    fn clear(&mut self, a: Xy, b: Xy, radius: f64) {
        let first = (a[1].min(b[1]) - radius).ceil().max(1.0);
        let last = (a[1].max(b[1]) + radius)
            .floor()
            .min(self.rows as f64 - 1.0);
        for j in first as usize..=last as usize {
            let Some([x0, x1]) = capsule_on_row(a, b, radius, j as f64) else {
                continue;
            };
            let (n0, n1) = (
                x0.ceil().max(1.0) as usize,
                x1.floor().min(self.columns as f64 - 1.0),
            );
            if (n0 as f64) > n1 {
                continue;
            }
            for row in [j - 1, j] {
                let at = row * self.columns;
                for c in &mut self.cells[at + n0 - 1..=at + n1 as usize] {
                    *c = (*c).min(cell::STRIP);
                }
            }
        }
    }

    /// Closes the open cells that look out over an edge that is no seam edge: only possible where
    /// a seam bends off the lattice.
    fn respect_seams(&mut self) {
        if self.seam_nodes.is_empty() {
            return;
        }
        for j in 1..self.rows - 1 {
            for i in 1..self.columns - 1 {
                if self.cells[j * self.columns + i] == cell::OPEN && !self.sides_are_seams(i, j) {
                    self.cells[j * self.columns + i] = cell::STRIP;
                }
            }
        }
    }

    /// True if every side of cell (i, j) toward an `OUT` cell has a visit at both ends.
    fn sides_are_seams(&self, i: usize, j: usize) -> bool {
        let at = j * self.columns + i;
        let w = self.columns;
        let known = |a: (usize, usize), b: (usize, usize)| {
            [a, b]
                .iter()
                .all(|&(i, j)| !self.seam_visits(i, j).is_empty())
        };
        let [low_left, low_right] = [(i, j), (i + 1, j)];
        let [high_left, high_right] = [(i, j + 1), (i + 1, j + 1)];
        (self.cells[at - w] != cell::OUT || known(low_left, low_right))
            && (self.cells[at + 1] != cell::OUT || known(low_right, high_right))
            && (self.cells[at + w] != cell::OUT || known(high_left, high_right))
            && (self.cells[at - 1] != cell::OUT || known(low_left, high_left))
    }

    /// The open cells that touch a cell that is not.
    fn rim(&self) -> Vec<u32> {
        let mut rim = Vec::new();
        let w = self.columns;
        for j in 1..self.rows - 1 {
            for at in j * w + 1..(j + 1) * w - 1 {
                let all = [at - w - 1, at - w, at - w + 1, at - 1, at + 1];
                let closed = |&n: &usize| self.cells[n] < cell::OPEN;
                if self.cells[at] == cell::OPEN
                    && (all.iter().any(closed)
                        || [at + w - 1, at + w, at + w + 1].iter().any(closed))
                {
                    rim.push(at as u32);
                }
            }
        }
        rim
    }

    /// Closes every open cell that is in no open block of 2 x 2 (whiskers), and both of two cells
    /// that touch in a corner only (pinches), until nothing changes. `doubtful` are the cells to
    /// look at first.
    pub fn open(&mut self, mut doubtful: Vec<u32>) {
        let w = self.columns;
        while let Some(at) = doubtful.pop() {
            let at = at as usize;
            if self.cells[at] < cell::OPEN {
                continue;
            }
            let open = |n: usize| self.cells[n] >= cell::OPEN;
            let (mut in_block, mut pinch) = (false, None);
            for (beside, above) in [
                (at - 1, at - w),
                (at + 1, at - w),
                (at - 1, at + w),
                (at + 1, at + w),
            ] {
                let diagonal = beside + above - at;
                match (open(beside), open(above), open(diagonal)) {
                    (true, true, true) => in_block = true,
                    (false, false, true) => pinch = Some(diagonal),
                    _ => {}
                }
            }
            if in_block && pinch.is_none() {
                continue;
            }
            for closed in [Some(at), pinch].into_iter().flatten() {
                self.cells[closed] = cell::STRIP;
                doubtful.extend(self.around(closed).map(|n| n as u32));
            }
        }
        self.drop_islands();
    }

    /// The eight cells around one.
    fn around(&self, at: usize) -> [usize; 8] {
        let w = self.columns;
        [
            at - w - 1,
            at - w,
            at - w + 1,
            at - 1,
            at + 1,
            at + w - 1,
            at + w,
            at + w + 1,
        ]
    }

    /// Settles the islands of open cells that are large enough, closes the others.
    fn drop_islands(&mut self) {
        let w = self.columns;
        let mut island: Vec<u32> = Vec::new();
        for start in 0..self.cells.len() {
            if self.cells[start] != cell::OPEN {
                continue;
            }
            island.clear();
            island.push(start as u32);
            self.cells[start] = cell::SETTLED;
            let mut done = 0;
            while done < island.len() {
                let at = island[done] as usize;
                done += 1;
                for n in [at - w, at - 1, at + 1, at + w] {
                    if self.cells[n] == cell::OPEN {
                        self.cells[n] = cell::SETTLED;
                        island.push(n as u32);
                    }
                }
            }
            if island.len() < LEAST_ISLAND {
                for &at in &island {
                    self.cells[at as usize] = cell::STRIP;
                }
            }
        }
    }

    /// Marks the rows of the core next to the strip. Next to a seam there is none.
    pub fn mark_zone(&mut self) {
        let w = self.columns;
        let mut rim: Vec<usize> = Vec::new();
        for j in 1..self.rows - 1 {
            for at in j * w + 1..(j + 1) * w - 1 {
                if self.cells[at] == cell::STRIP {
                    rim.push(at);
                }
            }
        }
        for _ in 0..ZONE_ROWS {
            let mut row = Vec::new();
            for &at in &rim {
                for n in self.around(at) {
                    if self.cells[n] == cell::SETTLED {
                        self.cells[n] = cell::ZONE;
                        row.push(n);
                    }
                }
            }
            rim = row;
        }
    }

    /// Takes the cells, and the three to the east, north and north-east of each (room for the
    /// nodes of a strip), out of the core.
    pub fn open_corridors(&mut self, way: &[u32]) {
        for state in &mut self.cells {
            *state = (*state).min(cell::OPEN);
        }
        let w = self.columns;
        let mut beside = Vec::new();
        for &at in way {
            let at = at as usize;
            for n in [at, at + 1, at + w, at + w + 1] {
                if self.cells[n] == cell::OPEN {
                    self.cells[n] = cell::STRIP;
                    beside.extend(self.around(n).map(|n| n as u32));
                }
            }
        }
        self.open(beside);
    }

    /// Gives up the core.
    pub fn clear_all(&mut self) {
        for state in &mut self.cells {
            *state = (*state).min(cell::STRIP);
        }
    }

    /// State of the cell that holds the point with lattice coordinates `u`.
    pub fn state(&self, u: Xy) -> u8 {
        let inside = |v: f64, end: usize| v >= 0.0 && v < end as f64;
        if inside(u[0], self.columns) && inside(u[1], self.rows) {
            self.cells[u[1] as usize * self.columns + u[0] as usize]
        } else {
            cell::OUT
        }
    }

    /// Number of core cells.
    pub fn count(&self) -> usize {
        self.cells.iter().filter(|&&c| c >= cell::ZONE).count()
    }

    /// True if lattice node (i, j), not on the margin, is a corner of a core cell.
    pub fn is_core_node(&self, i: usize, j: usize) -> bool {
        let at = j * self.columns + i;
        [at - self.columns - 1, at - self.columns, at - 1, at]
            .iter()
            .any(|&n| self.cells[n] >= cell::ZONE)
    }
}

/// The lattice node at lattice coordinates `u`, if one is there.
fn lattice_node(u: Xy) -> Option<(u32, u32)> {
    let on = |v: f64| (v - v.round()).abs() < ON_LATTICE;
    (on(u[0]) && on(u[1])).then(|| (u[0].round() as u32, u[1].round() as u32))
}

/// The interval of row `y` that is nearer than `radius` to the segment `a b`: the extent of the
/// discs about its ends and of the two sides between them.
fn capsule_on_row(a: Xy, b: Xy, radius: f64, y: f64) -> Option<[f64; 2]> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut reach = |x: f64| {
        low = low.min(x);
        high = high.max(x);
    };
    for p in [a, b] {
        let dy = y - p[1];
        if dy.abs() < radius {
            let half = (radius * radius - dy * dy).sqrt();
            reach(p[0] - half);
            reach(p[0] + half);
        }
    }
    let length = distance(a, b);
    for side in [radius, -radius] {
        let (nx, ny) = ((a[1] - b[1]) / length * side, (b[0] - a[0]) / length * side);
        let (ya, yb) = (a[1] + ny, b[1] + ny);
        if (ya - y) * (yb - y) < 0.0 {
            reach(a[0] + nx + (y - ya) / (yb - ya) * (b[0] - a[0]));
        }
    }
    (low < high).then_some([low, high])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::quad::distance;
    use crate::meshing::clearance::Clearance;
    use crate::meshing::patch::Loops;

    /// A star with 7 rays, its inner and outer radii not on any lattice.
    fn star() -> Visits {
        let place = |k: u32| {
            let (radius, angle) = (15.3 + 7.9 * f64::from(k % 2), f64::from(k) * 0.4488);
            [radius * angle.cos(), radius * angle.sin()]
        };
        Visits::of(&Loops {
            nodes: (0..14).map(place).collect(),
            walks: vec![(0..14).collect()],
            size_m: 1.0,
            lattice_origin: None,
            on_seam: vec![vec![false; 14]],
            across_m: Vec::new(),
        })
    }

    #[test]
    fn cells_are_open_exactly_where_all_corners_are_clear() {
        let visits = star();
        let next: Vec<u32> = (1..15).map(|k| k % 14).collect();
        let lattice = Lattice::fit(&visits, &next, 1.0);
        let mut core = Core::blank(&visits, lattice).expect("small");
        core.fill_inside(&next);
        core.clear_near(&visits, &next);
        let edge = |v: usize| [visits.nodes[v], visits.nodes[next[v] as usize]];
        let radius = |[a, b]: [Xy; 2]| CLEARANCE.max(1.0 + 0.8 * distance(a, b)) - 1e-6;
        let twin = |v: usize| (Clearance::of(vec![edge(v)], 1.0), radius(edge(v)));
        let twins: Vec<(Clearance, f64)> = (0..14).map(twin).collect();
        let whole = Clearance::of((0..14).map(edge).collect(), 1.0);
        for j in 1..core.rows - 1 {
            for i in 1..core.columns - 1 {
                let (x, y) = (i as f64, j as f64);
                let place = |u: Xy| core.lattice.place(u);
                let clear = [[x, y], [x + 1.0, y], [x, y + 1.0], [x + 1.0, y + 1.0]]
                    .into_iter()
                    .all(|u| twins.iter().all(|(e, r)| e.nearest(place(u), *r).is_none()));
                let centre = whole.nearest(place([x + 0.5, y + 0.5]), 50.0);
                let inside = centre.is_some_and(|nearest| nearest.inside);
                let open = core.cells[j * core.columns + i] == cell::OPEN;
                assert_eq!(open, clear && inside, "cell {i} {j}");
            }
        }
    }
}
