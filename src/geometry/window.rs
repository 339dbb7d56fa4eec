//! Half-open rectangles of the grid, and the tiling of the plane by them.

use crate::geometry::point::Point;

/// The cells with `min.x <= x < max.x` and `min.y <= y < max.y`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Lowest corner, inside.
    pub min: Point,
    /// Highest corner, outside.
    pub max: Point,
}

impl Window {
    /// True if `p` is one of the window's cells.
    pub fn owns(&self, p: Point) -> bool {
        (self.min.x..self.max.x).contains(&p.x) && (self.min.y..self.max.y).contains(&p.y)
    }

    /// True if both have a cell in common; neither is empty.
    pub fn meets(&self, other: &Window) -> bool {
        self.min.x < other.max.x
            && other.min.x < self.max.x
            && self.min.y < other.max.y
            && other.min.y < self.max.y
    }
}
