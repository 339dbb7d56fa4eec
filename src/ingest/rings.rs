//! Direction and self-crossings of closed rings, exact on the grid.

use crate::geometry::crossing::along;
use crate::geometry::crossing::crossing;
use crate::geometry::point::Point;
use crate::geometry::predicates::orient;

/// Twice the signed area of a closed ring, cells²; positive if it runs counter-clockwise.
pub fn doubled_area(ring: &[Point]) -> i128 {
    let wide = |v: i32| i128::from(v);
    (ring.windows(2))
        .map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            wide(a.x) * wide(b.y) - wide(b.x) * wide(a.y)
        })
        .sum()
}

/// A point where the closed ring crosses itself, or runs along itself; touching itself in a point
/// is allowed. Segments sorted by west end; each is compared with those that start before its east
/// end, so a ring of n even segments costs about n^1.5.
pub fn self_crossing(ring: &[Point]) -> Option<Point> {
    let mut segments: Vec<(Point, Point)> = (ring.windows(2))
        .map(|pair| (pair[0].min(pair[1]), pair[0].max(pair[1])))
        .collect();
    segments.sort_unstable();
    for (i, &(a, b)) in segments.iter().enumerate() {
        let (low, high) = (a.y.min(b.y), a.y.max(b.y));
        for &(c, d) in segments[i + 1..].iter().take_while(|(c, _)| c.x <= b.x) {
            if c.y.min(d.y) > high || c.y.max(d.y) < low {
                continue;
            }
            if let Some(at) = crossing(a, b, c, d).or_else(|| overlap(a, b, c, d)) {
                return Some(at);
            }
        }
    }
    None
}

/// A point of the common stretch of two segments on one line (`a < b`, `c < d`), if it has length.
fn overlap(a: Point, b: Point, c: Point, d: Point) -> Option<Point> {
    let is_straight = orient(a, b, c) == 0 && orient(a, b, d) == 0;
    let (from, to) = (a.max(c), b.min(d));
    (is_straight && along(a, b, from) < along(a, b, to)).then_some(from)
}
