//! One closed loop of nodes with the area to be meshed on its left, and what can be seen in it.

use std::f64::consts::TAU;

use crate::geometry::point::Xy;
use crate::geometry::quad::cross;
use crate::geometry::quad::distance;
use crate::meshing::sheet::Sheet;

/// A loop and its local measures; the arrays are parallel, indexed by *entry*.
///
/// A node may have several entries (the two sides of a bridge); each has its own interior angle.
#[derive(Clone, Debug)]
pub(crate) struct Contour {
    /// Nodes in order, the area on their left.
    pub ids: Vec<u32>,
    /// Their positions, metres.
    pub at: Vec<Xy>,
    /// Interior angle, radians, in (0, 2 pi].
    pub angle: Vec<f64>,
    /// Direction to the next entry, radians.
    pub heading: Vec<f64>,
    /// Mean length of the two edges at the entry, metres.
    pub spacing_m: Vec<f64>,
}

impl Contour {
    /// Measures the loop `ids`.
    pub fn of(sheet: &Sheet, ids: Vec<u32>) -> Contour {
        let n = ids.len();
        let at: Vec<Xy> = ids.iter().map(|&id| sheet.nodes[id as usize]).collect();
        let toward = |a: Xy, b: Xy| (b[1] - a[1]).atan2(b[0] - a[0]);
        let heading: Vec<f64> = (0..n).map(|i| toward(at[i], at[(i + 1) % n])).collect();
        let length: Vec<f64> = (0..n).map(|i| distance(at[i], at[(i + 1) % n])).collect();
        let angle = (0..n)
            .map(|i| {
                // Backwards along the very same segment is exactly a full turn: the tip of a slit.
                let turn = toward(at[i], at[(i + n - 1) % n]) - heading[i];
                if turn <= 0.0 { turn + TAU } else { turn }
            })
            .collect();
        let spacing_m = (0..n)
            .map(|i| 0.5 * (length[i] + length[(i + n - 1) % n]))
            .collect();
        Contour {
            ids,
            at,
            angle,
            heading,
            spacing_m,
        }
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Angle from the edge that leaves `entry` counter-clockwise to `direction` (radians, above
    /// -pi and at most 2 pi), in [0, 2 pi).
    pub fn opening(&self, entry: usize, direction: f64) -> f64 {
        let turn = direction - self.heading[entry];
        if turn < 0.0 {
            turn + TAU
        } else if turn >= TAU {
            turn - TAU
        } else {
            turn
        }
    }

    /// Signed area, m².
    pub fn area_m2(&self) -> f64 {
        let origin = self.at[0];
        let fan = self.at.windows(2).map(|e| cross(origin, e[0], e[1]));
        0.5 * fan.sum::<f64>()
    }

    /// How near the straight line from `a` to `b` comes to this loop, as the least distance of an
    /// entry over its spacing; `None` if it meets the loop anywhere but at its ends.
    ///
    /// Edges that start where the line ends are left to the caller, who has compared directions:
    /// they cannot meet the line again unless their other end lies on it, which counts as near.
    pub fn clearance(&self, a: Xy, b: Xy) -> Option<f64> {
        let n = self.len();
        let mut least = f64::INFINITY;
        let side = |k: usize| cross(a, b, self.at[k]);
        let mut before = side(n - 1);
        for k in 0..n {
            let here = side(k);
            let p = self.at[k];
            let from = self.at[(k + n - 1) % n];
            let at_end = |q: Xy| q == a || q == b;
            if !at_end(p) {
                let apart = from_segment(a, b, p, here);
                least = least.min(apart / self.spacing_m[k]);
                if before * here <= 0.0
                    && !at_end(from)
                    && cross(from, p, a) * cross(from, p, b) <= 0.0
                {
                    return None;
                }
            }
            before = here;
        }
        (least > 1e-3).then_some(least)
    }
}

/// Distance of `p` from the segment `a b`, where `double_area` is `cross(a, b, p)`.
fn from_segment(a: Xy, b: Xy, p: Xy, double_area: f64) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let length2 = dx * dx + dy * dy;
    let t = (p[0] - a[0]) * dx + (p[1] - a[1]) * dy;
    if t <= 0.0 {
        distance(a, p)
    } else if t >= length2 {
        distance(b, p)
    } else {
        double_area.abs() / length2.sqrt()
    }
}
