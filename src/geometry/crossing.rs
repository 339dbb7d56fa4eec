//! Where two segments cross, rounded to the grid; and which pixels a segment passes through.
//!
//! The *pixel* of a grid point `p` is the half-open unit square `[p.x - 1/2, p.x + 1/2) x
//! [p.y - 1/2, p.y + 1/2)`. Pixels tile the plane, so each position belongs to exactly one of them,
//! and rounding a position half up gives the centre of its pixel: [`crossing`] and
//! [`passes_pixel`] agree by construction.

use crate::geometry::point::Point;
use crate::geometry::predicates::orient;

/// The grid point whose pixel holds the proper crossing of the segments `a b` and `c d`, or `None`
/// if they do not cross in the inside of both (touching at an end or overlapping is no crossing).
///
/// The crossing is a rational number that does not depend on the order of the arguments, and it is
/// rounded only once, exactly (i128), so these laws hold bit by bit:
/// `crossing(a, b, c, d) == crossing(b, a, c, d) == crossing(a, b, d, c) == crossing(c, d, a, b)`.
pub fn crossing(a: Point, b: Point, c: Point, d: Point) -> Option<Point> {
    let (side_a, side_b) = (orient(c, d, a), orient(c, d, b));
    if side_a == 0 || side_b == 0 || (side_a > 0) == (side_b > 0) {
        return None;
    }
    let (side_c, side_d) = (orient(a, b, c), orient(a, b, d));
    if side_c == 0 || side_d == 0 || (side_c > 0) == (side_d > 0) {
        return None;
    }
    // a + (b - a) * num / den with 0 < num < den <= 2^62; the products below stay under 2^94
    let num = i128::from(side_a).abs();
    let den = num + i128::from(side_b).abs();
    let at = |from: i32, to: i32| {
        let exact = i128::from(from) * den + (i128::from(to) - i128::from(from)) * num;
        (2 * exact + den).div_euclid(2 * den) as i32
    };
    Some(Point::new(at(a.x, b.x), at(a.y, b.y)))
}

/// True if the closed segment `a b` has a point in the half-open pixel of `p`. Exact.
///
/// Intervals on a line that meet pairwise have a common point (Helly). Applied to the parameters
/// for which the segment is in the pixel's columns, in its rows and between its ends, it leaves
/// three tests: the range in x, the range in y, and whether the whole line passes the pixel.
pub fn passes_pixel(a: Point, b: Point, p: Point) -> bool {
    if p.x < a.x.min(b.x) || p.x > a.x.max(b.x) || p.y < a.y.min(b.y) || p.y > a.y.max(b.y) {
        return false;
    }
    let (dx, dy) = (
        i64::from(b.x) - i64::from(a.x),
        i64::from(b.y) - i64::from(a.y),
    );
    // the direction's cross product with the corner p + (sx, sy) / 2, doubled: below 2^63
    let doubled = 2 * orient(a, b, p);
    let corner = |sx: i64, sy: i64| doubled + dx * sy - dy * sx;
    match dx.signum() * dy.signum() {
        0 => true,
        // rising: between the corners top left and bottom right, neither of which is in the pixel
        1 => opposite(corner(-1, 1), corner(1, -1)),
        // falling: between bottom left, which is in the pixel, and top right, which is not
        _ => corner(-1, -1) == 0 || opposite(corner(-1, -1), corner(1, 1)),
    }
}

fn opposite(s: i64, t: i64) -> bool {
    (s > 0 && t < 0) || (s < 0 && t > 0)
}

/// Dot product of `p - a` with `b - a`, in cells²: orders pixels along the segment `a b`. Exact.
pub fn along(a: Point, b: Point, p: Point) -> i64 {
    let (dx, dy) = (
        i64::from(b.x) - i64::from(a.x),
        i64::from(b.y) - i64::from(a.y),
    );
    dx * (i64::from(p.x) - i64::from(a.x)) + dy * (i64::from(p.y) - i64::from(a.y))
}
