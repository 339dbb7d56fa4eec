//! Metres to grid cells and back: the only place where the two meet before `boundary`.

use crate::geometry::point::LIMIT;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;

/// The integer grid: where its origin lies and how large a cell is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Projected coordinates of cell (0, 0), metres; a whole number of metres.
    pub origin_m: Xy,
    /// Side of a cell, metres; 0.001 unless the job says otherwise.
    pub cell_m: f64,
}

impl Grid {
    /// The cell nearest to the projected position `at_m`, or `None` beyond ±[`LIMIT`] cells.
    pub fn cell(&self, at_m: Xy) -> Option<Point> {
        let x = ((at_m[0] - self.origin_m[0]) / self.cell_m).round();
        let y = ((at_m[1] - self.origin_m[1]) / self.cell_m).round();
        let inside = |v: f64| v.abs() <= f64::from(LIMIT);
        (inside(x) && inside(y)).then(|| Point::new(x as i32, y as i32))
    }

    /// Metres relative to the origin.
    #[inline]
    pub fn local_m(&self, p: Point) -> Xy {
        [f64::from(p.x) * self.cell_m, f64::from(p.y) * self.cell_m]
    }

    /// Projected coordinates, metres.
    pub fn projected_m(&self, p: Point) -> Xy {
        let [x, y] = self.local_m(p);
        [x + self.origin_m[0], y + self.origin_m[1]]
    }
}
