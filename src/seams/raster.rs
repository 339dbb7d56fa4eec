//! The lattice, and the raster of those of its lines that seams may follow.

use crate::geometry::point::Point;

/// The direction that a lattice line runs in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Along {
    X,
    Y,
}

impl Along {
    /// The coordinates of `p` across and along the line.
    pub fn split(self, p: Point) -> (i64, i64) {
        let (x, y) = (i64::from(p.x), i64::from(p.y));
        match self {
            Along::X => (y, x),
            Along::Y => (x, y),
        }
    }

    /// The point with these coordinates across and along the line.
    pub fn point(self, across: i64, along: i64) -> Point {
        match self {
            Along::X => Point::new(along as i32, across as i32),
            Along::Y => Point::new(across as i32, along as i32),
        }
    }
}

/// A lattice line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct LatticeLine {
    pub along: Along,
    /// Its place across, in pitches.
    pub line: i64,
}

impl LatticeLine {
    /// Its `k`-th lattice point.
    pub fn point(self, k: i64, pitch: i32) -> Point {
        let pitch = i64::from(pitch);
        self.along.point(self.line * pitch, k * pitch)
    }
}

/// Distances between raster lines, pitches: coarse, then finer ones. The ends of seams need some
/// eight pitches between lines.
pub(super) fn steps(budget_quads: f64) -> [i64; 3] {
    let third = budget_quads.max(0.0).sqrt() / 3.0;
    let quarter = ((third / 4.0) as i64).max(1);
    [4, 2, 1].map(|it| (it * quarter).max(8))
}
