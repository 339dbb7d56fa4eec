//! A point of the integer grid.

/// Metres relative to the origin of the [`Grid`](crate::geometry::grid::Grid): `[x, y]`.
pub type Xy = [f64; 2];

const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Eight directions of unit length, for compass searches.
pub const COMPASS: [Xy; 8] = [
    [1.0, 0.0],
    [HALF, HALF],
    [0.0, 1.0],
    [-HALF, HALF],
    [-1.0, 0.0],
    [-HALF, -HALF],
    [0.0, -1.0],
    [HALF, -HALF],
];

/// A point of the grid, in cells (1 mm unless the job says otherwise).
///
/// Both coordinates stay within ±[`LIMIT`]; the order is by `x`, then `y`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Point {
    /// Cells east of the origin.
    pub x: i32,
    /// Cells north of the origin.
    pub y: i32,
}

/// Largest absolute coordinate, 2^29 cells (537 km at 1 mm): differences fit 2^30, their products
/// 2^60, so a determinant of two differences is exact in i64.
pub const LIMIT: i32 = 1 << 29;

impl Point {
    /// The point at `(x, y)` cells.
    pub fn new(x: i32, y: i32) -> Point {
        Point { x, y }
    }

    /// Squared distance to `other`, in cells². Exact.
    pub fn distance2(self, other: Point) -> i64 {
        let dx = i64::from(other.x) - i64::from(self.x);
        let dy = i64::from(other.y) - i64::from(self.y);
        dx * dx + dy * dy
    }

    /// Distance to `other`, in cells.
    pub fn distance(self, other: Point) -> f64 {
        (self.distance2(other) as f64).sqrt()
    }
}
