//! Corners of a walk, and the sides between them.

use crate::geometry::point::Point;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::HalfCurve;
use crate::partition::subdomains::Partition;

/// A stretch of a walk between two corners: (curve, edges of it on this side), in order.
pub type Side = Vec<(u32, u32)>;

/// A closed walk, edge by edge.
pub struct Walk {
    /// The curve of each edge.
    curve: Vec<u32>,
    /// True if the edge is the first one of its half-curve.
    pub starts_curve: Vec<bool>,
    /// The point where each edge starts.
    point: Vec<Point>,
}

impl Walk {
    /// The edges along `walk`.
    pub fn of(walk: &[HalfCurve], arrangement: &Arrangement, partition: &Partition) -> Walk {
        let mut made = Walk {
            curve: Vec::new(),
            starts_curve: Vec::new(),
            point: Vec::new(),
        };
        for &half in walk {
            let nodes = &partition.curves[(half >> 1) as usize].nodes;
            let last = nodes.len() - 1;
            for k in 0..last {
                let node = nodes[if half & 1 == 0 { k } else { last - k }];
                made.curve.push(half >> 1);
                made.starts_curve.push(k == 0);
                made.point.push(arrangement.points[node as usize]);
            }
        }
        made
    }

    /// Change of direction where edge `k` starts, degrees; to the left positive.
    pub fn turn_deg(&self, k: usize) -> f64 {
        let n = self.point.len();
        let (before, at, after) = (
            self.point[(k + n - 1) % n],
            self.point[k],
            self.point[(k + 1) % n],
        );
        let step = |a: Point, b: Point| (f64::from(b.x - a.x), f64::from(b.y - a.y));
        let ((ux, uy), (vx, vy)) = (step(before, at), step(at, after));
        (ux * vy - uy * vx).atan2(ux * vx + uy * vy).to_degrees()
    }

    /// Change of direction where each edge starts, degrees, as [`turn_deg`](Walk::turn_deg); at the end
    /// of a free line, where the walk goes back along the same edge, -180.
    pub fn turns_deg(&self) -> Vec<f64> {
        let n = self.point.len();
        let is_end = |k: usize| self.point[(k + n - 1) % n] == self.point[(k + 1) % n];
        let turn = |k: usize| if is_end(k) { -180.0 } else { self.turn_deg(k) };
        (0..n).map(turn).collect()
    }

    /// The edges, each with its curve and its step, grid units.
    pub fn edges(&self) -> impl Iterator<Item = (u32, [f64; 2])> {
        let n = self.point.len();
        (0..n).map(move |k| {
            let (a, b) = (self.point[k], self.point[(k + 1) % n]);
            (self.curve[k], [f64::from(b.x - a.x), f64::from(b.y - a.y)])
        })
    }

    /// The edges whose turn is such, in order.
    pub fn entries(&self, is_such: impl Fn(f64) -> bool) -> Vec<usize> {
        (0..self.point.len())
            .filter(|&k| is_such(self.turn_deg(k)))
            .collect()
    }

    /// The sides between `corners`, which are in order; none without corners.
    pub fn sides(&self, corners: &[usize]) -> Vec<Side> {
        let n = self.curve.len();
        let mut sides = Vec::with_capacity(corners.len());
        for (i, &from) in corners.iter().enumerate() {
            let to = corners[(i + 1) % corners.len()];
            let edges = match (to + n - from) % n {
                0 => n,
                edges => edges,
            };
            let mut side = Side::new();
            for k in from..from + edges {
                let curve = self.curve[k % n];
                match side.last_mut() {
                    Some((last, edges)) if *last == curve => *edges += 1,
                    _ => side.push((curve, 1)),
                }
            }
            sides.push(side);
        }
        sides
    }
}
