//! Segments found by place: distances up to a limit, and crossings.

use crate::geometry::point::Xy;
use crate::geometry::quad::cross;

/// Distance from `p` to the nearest of `segments`, metres; infinite without any.
pub(crate) fn nearest_m(p: Xy, segments: impl Iterator<Item = [Xy; 2]>) -> f64 {
    segments
        .map(|segment| distance2_m2(p, segment))
        .fold(f64::INFINITY, f64::min)
        .sqrt()
}

/// Squared distance from `p` to the segment `a b`, m².
fn distance2_m2(p: Xy, [a, b]: [Xy; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length2 = dx * dx + dy * dy;
    let along = (p[0] - a[0]) * dx + (p[1] - a[1]) * dy;
    let t = if length2 > 0.0 {
        (along / length2).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let (x, y) = (p[0] - a[0] - t * dx, p[1] - a[1] - t * dy);
    x * x + y * y
}

/// True if the segments cross at an inner point of both. Touching does not count.
pub(crate) fn cross_inside([a, b]: [Xy; 2], [c, d]: [Xy; 2]) -> bool {
    let opposite = |u: f64, v: f64| (u > 0.0 && v < 0.0) || (u < 0.0 && v > 0.0);
    opposite(cross(a, b, c), cross(a, b, d)) && opposite(cross(c, d, a), cross(c, d, b))
}

/// Segments in the cells of a square grid. About 12 bytes a segment and cell that it passes.
pub(crate) struct Segments {
    pub all: Vec<[Xy; 2]>,
    cell_m: f64,
    /// (cell, segment), sorted.
    entries: Vec<([i32; 2], u32)>,
}

impl Segments {
    /// `cell_m` should be about the length of a segment or the distance that will be asked for.
    pub fn new(all: Vec<[Xy; 2]>, cell_m: f64) -> Segments {
        let mut entries = Vec::with_capacity(2 * all.len());
        for (k, segment) in all.iter().enumerate() {
            for_cells(segment, cell_m, |cell| entries.push((cell, k as u32)));
        }
        entries.sort_unstable();
        Segments {
            all,
            cell_m,
            entries,
        }
    }

    /// Segments with an entry in column `x`, rows `low` to `high`.
    fn column(&self, x: i32, low: i32, high: i32) -> impl Iterator<Item = usize> + '_ {
        let from = self.entries.partition_point(|&(cell, _)| cell < [x, low]);
        (self.entries[from..].iter())
            .take_while(move |(cell, _)| *cell <= [x, high])
            .map(|&(_, k)| k as usize)
    }

    /// Distance from `p` to the nearest segment if it is at most `limit_m`, metres.
    pub fn distance_within_m(&self, p: Xy, limit_m: f64) -> Option<f64> {
        let cell = |v: f64| (v / self.cell_m).floor() as i32;
        let (low, high) = (cell(p[1] - limit_m), cell(p[1] + limit_m));
        let columns = cell(p[0] - limit_m)..=cell(p[0] + limit_m);
        let near = columns.flat_map(|x| self.column(x, low, high));
        let nearest = nearest_m(p, near.map(|k| self.all[k]));
        (nearest <= limit_m).then_some(nearest)
    }

    /// The first pair of segments that cross at an inner point of both.
    pub fn crossing(&self) -> Option<[usize; 2]> {
        for same_cell in self.entries.chunk_by(|a, b| a.0 == b.0) {
            for (k, &(_, i)) in same_cell.iter().enumerate() {
                for &(_, j) in &same_cell[..k] {
                    let pair = [i as usize, j as usize];
                    if cross_inside(self.all[pair[0]], self.all[pair[1]]) {
                        return Some(pair);
                    }
                }
            }
        }
        None
    }
}

/// Calls `found` for the cells that `segment` passes (and a few of their neighbours).
fn for_cells(&[a, b]: &[Xy; 2], cell_m: f64, mut found: impl FnMut([i32; 2])) {
    let cell = |v: f64| (v / cell_m).floor() as i32;
    let (low, high) = if a[0] <= b[0] { (a, b) } else { (b, a) };
    let slope = (high[1] - low[1]) / (high[0] - low[0]);
    for x in cell(low[0])..=cell(high[0]) {
        // The part of the segment within this column.
        let west = (f64::from(x) * cell_m).max(low[0]);
        let east = (f64::from(x + 1) * cell_m).min(high[0]);
        let (mut from, mut to) = (low[1], high[1]);
        if slope.is_finite() {
            from = low[1] + (west - low[0]) * slope;
            to = low[1] + (east - low[0]) * slope;
        }
        // A hair wider, so that rounding cannot lose the cell of an end.
        let pad = 1e-6 * cell_m;
        for y in cell(from.min(to) - pad)..=cell(from.max(to) + pad) {
            found([x, y]);
        }
    }
}
