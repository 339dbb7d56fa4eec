//! Distances and crossings between segments, and an index to find those that are near.

use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::geometry::predicates::on_segment;
use crate::geometry::predicates::orient;
use crate::noding::arrangement::Arrangement;
use rustc_hash::FxHashMap;

/// Distance from `p` to the segment `a b`.
pub(super) fn distance_to_segment(p: Xy, a: Xy, b: Xy) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length2 = dx * dx + dy * dy;
    let along = (p[0] - a[0]) * dx + (p[1] - a[1]) * dy;
    let t = if length2 > 0.0 {
        (along / length2).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (p[0] - a[0] - t * dx).hypot(p[1] - a[1] - t * dy)
}

/// Distance between two segments, cells; zero if they meet.
pub fn distance_between(s: [Point; 2], t: [Point; 2]) -> f64 {
    if meet(s, t) {
        return 0.0;
    }
    let xy = |p: Point| [f64::from(p.x), f64::from(p.y)];
    let [a, b, c, d] = [s[0], s[1], t[0], t[1]].map(xy);
    distance_to_segment(a, c, d)
        .min(distance_to_segment(b, c, d))
        .min(distance_to_segment(c, a, b))
        .min(distance_to_segment(d, a, b))
}

/// True if two closed segments have a point in common. Exact.
pub(super) fn meet([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    let (ac, ad) = (orient(a, b, c).signum(), orient(a, b, d).signum());
    let (ca, cb) = (orient(c, d, a).signum(), orient(c, d, b).signum());
    (ac * ad < 0 && ca * cb < 0)
        || on_segment(a, b, c)
        || on_segment(a, b, d)
        || on_segment(c, d, a)
        || on_segment(c, d, b)
}

/// Segments by the square buckets that they pass.
pub struct Buckets {
    side: i64,
    /// Never iterated, so that the order of hashing does not matter.
    ids: FxHashMap<(i64, i64), Vec<u32>>,
}

impl Buckets {
    /// None yet; squares with sides of so many cells.
    pub fn new(side: i32) -> Buckets {
        Buckets {
            side: i64::from(side.max(1)),
            ids: FxHashMap::default(),
        }
    }

    /// All edges of an arrangement.
    pub fn of(arrangement: &Arrangement, side: i32) -> Buckets {
        let mut buckets = Buckets::new(side);
        for (edge, nodes) in arrangement.edges.iter().enumerate() {
            let [a, b] = nodes.map(|node| arrangement.points[node as usize]);
            buckets.insert(edge as u32, [a, b]);
        }
        buckets
    }

    /// Adds the segment to each bucket that it passes, and perhaps to one beside it.
    pub fn insert(&mut self, id: u32, [a, b]: [Point; 2]) {
        let (a, b) = if a <= b { (a, b) } else { (b, a) };
        let (ax, ay) = (i64::from(a.x), i64::from(a.y));
        let (bx, by) = (i64::from(b.x), i64::from(b.y));
        let slope = if bx > ax {
            (by - ay) as f64 / (bx - ax) as f64
        } else {
            0.0
        };
        for column in ax.div_euclid(self.side)..=bx.div_euclid(self.side) {
            let from = (column * self.side).max(ax);
            let to = ((column + 1) * self.side).min(bx);
            let (mut low, mut high) = (ay.min(by), ay.max(by));
            if bx > ax {
                let at = |x: i64| ay + (slope * (x - ax) as f64).round() as i64;
                // A cell more on either side makes up for rounding.
                low = low.max(at(from).min(at(to)) - 1);
                high = high.min(at(from).max(at(to)) + 1);
            }
            for row in low.div_euclid(self.side)..=high.div_euclid(self.side) {
                self.ids.entry((column, row)).or_default().push(id);
            }
        }
    }

    /// Ids in the buckets that touch the box of these points, widened by `reach`; ascending.
    pub fn near(&self, points: [Point; 2], reach: f64) -> Vec<u32> {
        let reach = reach.ceil() as i64;
        let range = |u: i32, v: i32| {
            let (low, high) = (i64::from(u.min(v)) - reach, i64::from(u.max(v)) + reach);
            low.div_euclid(self.side)..=high.div_euclid(self.side)
        };
        let [a, b] = points;
        let mut found = Vec::new();
        for column in range(a.x, b.x) {
            for row in range(a.y, b.y) {
                if let Some(ids) = self.ids.get(&(column, row)) {
                    found.extend_from_slice(ids);
                }
            }
        }
        found.sort_unstable();
        found.dedup();
        found
    }
}
