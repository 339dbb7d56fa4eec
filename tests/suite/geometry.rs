//! Tests of `geometry`.

use polder::geometry::crossing::along;
use polder::geometry::crossing::crossing;
use polder::geometry::crossing::passes_pixel;
use polder::geometry::point::LIMIT;
use polder::geometry::point::Point;
use polder::geometry::quad::is_surely_below;
use polder::geometry::quad::scaled_jacobian;
use polder::geometry::turns::quarter_turns;
use proptest::prelude::*;

fn point(range: i32) -> impl Strategy<Value = Point> {
    (-range..=range, -range..=range).prop_map(|(x, y)| Point::new(x, y))
}

/// A share of the way along a segment, as an exact fraction with a positive denominator.
type Share = (i128, i128);

/// The slow twin of `passes_pixel`: cuts the segment's parameters by the four sides one by one and
/// looks whether something is left, with open and closed ends kept apart.
fn passes_pixel_twin(a: Point, b: Point, p: Point) -> bool {
    let (mut low, mut low_open): (Share, bool) = ((0, 1), false);
    let (mut high, mut high_open): (Share, bool) = ((1, 1), false);
    let before = |s: Share, t: Share| s.0 * t.1 < t.0 * s.1;
    for (from, to, centre) in [(a.x, b.x, p.x), (a.y, b.y, p.y)] {
        let (from, to, centre) = (i128::from(from), i128::from(to), i128::from(centre));
        // 2 from + t * 2 (to - from) >= 2 centre - 1 and < 2 centre + 1
        let step = 2 * (to - from);
        let (start, end) = (2 * centre - 1 - 2 * from, 2 * centre + 1 - 2 * from);
        if step == 0 {
            if start > 0 || end <= 0 {
                return false;
            }
            continue;
        }
        let (enter, leave) = if step > 0 {
            (((start, step), false), ((end, step), true))
        } else {
            (((-end, -step), true), ((-start, -step), false))
        };
        if before(low, enter.0) || (!before(enter.0, low) && enter.1) {
            (low, low_open) = enter;
        }
        if before(leave.0, high) || (!before(high, leave.0) && leave.1) {
            (high, high_open) = leave;
        }
    }
    before(low, high) || (!before(high, low) && !low_open && !high_open)
}

fn assert_crossing_laws(a: Point, b: Point, c: Point, d: Point) {
    let found = crossing(a, b, c, d);
    assert_eq!(found, crossing(b, a, c, d), "reversed first");
    assert_eq!(found, crossing(a, b, d, c), "reversed second");
    assert_eq!(found, crossing(c, d, a, b), "swapped");
    assert_eq!(found, crossing(d, c, b, a), "swapped and reversed");
    if let Some(p) = found {
        assert!(
            passes_pixel(a, b, p),
            "{a:?} {b:?} misses its crossing {p:?}"
        );
        assert!(
            passes_pixel(c, d, p),
            "{c:?} {d:?} misses its crossing {p:?}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn crossing_obeys_its_laws(
        a in point(9), b in point(9), c in point(9), d in point(9),
    ) {
        assert_crossing_laws(a, b, c, d);
    }

    #[test]
    fn crossing_obeys_its_laws_at_the_limit(
        a in point(LIMIT), b in point(LIMIT), c in point(LIMIT), d in point(LIMIT),
    ) {
        assert_crossing_laws(a, b, c, d);
    }

    #[test]
    fn passes_pixel_is_its_twin(a in point(7), b in point(7), p in point(8)) {
        prop_assert_eq!(passes_pixel(a, b, p), passes_pixel_twin(a, b, p));
    }

    #[test]
    fn passes_pixel_is_its_twin_near_long_segments(
        a in point(LIMIT), b in point(LIMIT), share in 0.0..1.0_f64, off in point(2),
    ) {
        let at = |from: i32, to: i32| {
            (f64::from(from) + share * (f64::from(to) - f64::from(from))) as i32
        };
        let p = Point::new(at(a.x, b.x) + off.x, at(a.y, b.y) + off.y);
        prop_assert_eq!(passes_pixel(a, b, p), passes_pixel_twin(a, b, p));
    }

    /// Trial places are refused by the quick test; it must refuse no quad that the slow one would take, and few others
    /// may get past it.
    #[test]
    fn a_shape_that_is_surely_below_is_below(
        corners in prop::array::uniform4(prop::array::uniform2(-1.0_f64..1.0)),
        least in 1e-3_f64..1.0,
        close in -1e-12_f64..1e-12,
    ) {
        let shape = scaled_jacobian(&corners);
        prop_assert!(!is_surely_below(&corners, least) || shape < least);
        prop_assert!(is_surely_below(&corners, least) || shape > least * (1.0 - 1e-8));
        if shape > 0.0 {
            prop_assert!(!is_surely_below(&corners, shape * (1.0 + close)), "rounding decides");
        }
    }

    #[test]
    fn pixels_of_a_segment_never_tie_along_it(a in point(6), b in point(6)) {
        let mut keys = Vec::new();
        for x in -7..=7 {
            for y in -7..=7 {
                if a != b && passes_pixel(a, b, Point::new(x, y)) {
                    keys.push(along(a, b, Point::new(x, y)));
                }
            }
        }
        keys.sort_unstable();
        prop_assert!(keys.windows(2).all(|pair| pair[0] < pair[1]));
        prop_assert!(keys.iter().all(|&key| key >= 0 && key <= a.distance2(b)));
    }
}

#[test]
fn crossing_rounds_half_up() {
    let p = Point::new;
    assert_eq!(crossing(p(0, 0), p(1, 1), p(0, 1), p(1, 0)), Some(p(1, 1)));
    assert_eq!(
        crossing(p(0, 0), p(-1, -1), p(0, -1), p(-1, 0)),
        Some(p(0, 0))
    );
}

#[test]
fn touching_and_overlapping_is_no_crossing() {
    let p = Point::new;
    assert_eq!(crossing(p(0, 0), p(4, 0), p(2, 0), p(2, 3)), None);
    assert_eq!(crossing(p(0, 0), p(4, 0), p(4, 0), p(5, 3)), None);
    assert_eq!(crossing(p(0, 0), p(4, 0), p(1, 0), p(9, 0)), None);
    assert_eq!(crossing(p(0, 0), p(4, 0), p(6, -1), p(6, 1)), None);
}

#[test]
fn crossing_at_the_corners_of_the_grid() {
    let p = |x: i32, y: i32| Point::new(x * LIMIT, y * LIMIT);
    assert_eq!(
        crossing(p(-1, -1), p(1, 1), p(-1, 1), p(1, -1)),
        Some(p(0, 0))
    );
}

#[test]
fn quarter_turns_sum_to_what_a_lattice_asks() {
    let quarters = |turns: &[f64]| quarter_turns(turns, 4);
    assert_eq!(
        quarters(&[90.0, 85.0, 0.0, 95.0, 90.0]),
        Some(vec![1, 1, 0, 1, 1])
    );
    // An L, and a slit that hangs on the rim.
    let l = [90.0, 90.0, 90.0, -90.0, 90.0, 90.0];
    assert_eq!(quarters(&l), Some(vec![1, 1, 1, -1, 1, 1]));
    let slit = [90.0, 90.0, 90.0, -180.0, 90.0, 90.0, 90.0];
    assert_eq!(quarters(&slit), Some(vec![1, 1, 1, -2, 1, 1, 1]));
    // What is nearest to a corner becomes one; a triangle has no fourth.
    assert_eq!(
        quarters(&[90.0, 90.0, 100.0, 38.0, 42.0]),
        Some(vec![1, 1, 1, 0, 1])
    );
    assert_eq!(quarters(&[120.0, 120.0, 120.0]), None);
    assert_eq!(quarters(&[120.0, 120.0, 120.0, 10.0, -10.0]), None);
    assert_eq!(quarter_turns(&[-90.0; 4], -4), Some(vec![-1; 4]));
}
