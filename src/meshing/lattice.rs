//! The frame of the core: a square lattice, turned and shifted to suit the walks.

use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::meshing::visits::Visits;

/// A square lattice; its coordinates count pitches from `origin_m` along its two axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lattice {
    /// Where lattice node (0, 0) lies.
    pub origin_m: Xy,
    /// Direction of the first axis, a unit vector.
    pub axis: Xy,
    /// Side of a cell, metres.
    pub pitch_m: f64,
}

/// Sides within 7 degrees of a lattice axis (as the ratio of their extents) decide its phase.
const ALIGNED: f64 = 0.12;

impl Lattice {
    /// The lattice that suits the walks best, in closed form and one pass each: its direction is
    /// the length-weighted mean of all edges' directions modulo a right angle, its phase that of
    /// the sides that run along its axes.
    pub fn fit(visits: &Visits, next: &[u32], pitch_m: f64) -> Lattice {
        let edges = || (0..visits.len()).map(|v| (visits.nodes[v], visits.nodes[next[v] as usize]));
        let (mut c, mut s) = (0.0, 0.0);
        for (p, q) in edges() {
            // (dx + i dy)^4 / l^3: length times the direction's fourth power.
            let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
            let (re, im) = (dx * dx - dy * dy, 2.0 * dx * dy);
            let l = distance(p, q);
            c += (re * re - im * im) / (l * l * l);
            s += 2.0 * re * im / (l * l * l);
        }
        let theta = s.atan2(c) / 4.0;
        let mut lattice = Lattice {
            origin_m: visits.nodes[0],
            axis: [theta.cos(), theta.sin()],
            pitch_m,
        };
        let mut phase = [[0.0; 2]; 2];
        for (p, q) in edges() {
            let (p, q) = (lattice.coordinates(p), lattice.coordinates(q));
            let l = distance(p, q);
            for k in 0..2 {
                if (q[k] - p[k]).abs() < ALIGNED * l {
                    let turn = std::f64::consts::PI * (p[k] + q[k]);
                    phase[k][0] += l * turn.cos();
                    phase[k][1] += l * turn.sin();
                }
            }
        }
        let shift = phase.map(|[c, s]| s.atan2(c) / std::f64::consts::TAU);
        lattice.origin_m = lattice.place(shift);
        lattice
    }

    /// The axis-aligned lattice through `origin_m`.
    pub fn aligned(origin_m: Xy, pitch_m: f64) -> Lattice {
        Lattice {
            origin_m,
            axis: [1.0, 0.0],
            pitch_m,
        }
    }

    /// Lattice coordinates of a place.
    pub fn coordinates(&self, p: Xy) -> Xy {
        let (dx, dy) = (p[0] - self.origin_m[0], p[1] - self.origin_m[1]);
        let [c, s] = self.axis;
        [
            (dx * c + dy * s) / self.pitch_m,
            (dy * c - dx * s) / self.pitch_m,
        ]
    }

    /// The place with lattice coordinates `u`, metres.
    pub fn place(&self, u: Xy) -> Xy {
        let [c, s] = self.axis;
        [
            self.origin_m[0] + (u[0] * c - u[1] * s) * self.pitch_m,
            self.origin_m[1] + (u[0] * s + u[1] * c) * self.pitch_m,
        ]
    }
}
