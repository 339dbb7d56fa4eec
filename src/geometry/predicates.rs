//! Exact predicates on grid points.

use crate::geometry::point::Point;

/// Twice the signed area of the triangle `a b c`: positive if `c` lies left of `a -> b`.
///
/// Exact: coordinates stay within ±2^29, so each product is below 2^60.
#[inline]
pub fn orient(a: Point, b: Point, c: Point) -> i64 {
    let (abx, aby) = (
        i64::from(b.x) - i64::from(a.x),
        i64::from(b.y) - i64::from(a.y),
    );
    let (acx, acy) = (
        i64::from(c.x) - i64::from(a.x),
        i64::from(c.y) - i64::from(a.y),
    );
    abx * acy - aby * acx
}

/// True if `p` lies on the closed segment `a b`.
#[inline]
pub fn on_segment(a: Point, b: Point, p: Point) -> bool {
    orient(a, b, p) == 0
        && (a.x.min(b.x)..=a.x.max(b.x)).contains(&p.x)
        && (a.y.min(b.y)..=a.y.max(b.y)).contains(&p.y)
}

/// Sorts directions `v` (non-zero, cells) counter-clockwise from east: half-plane first, then sign
/// of the cross product. Exact.
pub fn by_angle(u: (i64, i64), v: (i64, i64)) -> std::cmp::Ordering {
    let half = |d: (i64, i64)| u8::from(d.1 < 0 || (d.1 == 0 && d.0 < 0));
    half(u)
        .cmp(&half(v))
        .then_with(|| (v.0 * u.1).cmp(&(u.0 * v.1)))
}
