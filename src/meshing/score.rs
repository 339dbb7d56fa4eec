//! One number that says which of several patches of a sub-domain is best.

use crate::geometry::quad::hydraulic_size_m;
use crate::geometry::quad::scaled_jacobian;
use crate::meshing::patch::Loops;
use crate::meshing::patch::Patch;
use crate::meshing::visits::Visits;
use std::f64::consts::FRAC_PI_2;

/// What a patch is judged by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// Least scaled Jacobian.
    pub least: f64,
    /// Mean scaled Jacobian.
    pub mean: f64,
    /// Share of interior nodes that do not have four quads.
    pub irregular: f64,
    /// Least hydraulic size / wished size, at most 1: what bounds the time step of a solver.
    pub size: f64,
    /// No mesh can have a greater least scaled Jacobian: the sine of the sharpest walk corner.
    pub bound: f64,
    /// Index of the quad with the least scaled Jacobian.
    pub worst_quad: u32,
}

impl Score {
    /// Measures a patch.
    pub(crate) fn of(patch: &Patch, visits: &Visits, loops: &Loops) -> Score {
        let mut score = Score {
            least: 1.0,
            mean: 0.0,
            irregular: 0.0,
            size: 1.0,
            bound: bound(visits),
            worst_quad: 0,
        };
        let mut valence = vec![0_u32; patch.nodes.len()];
        for (k, quad) in patch.quads.iter().enumerate() {
            let corners = quad.map(|node| patch.nodes[node as usize]);
            let quality = scaled_jacobian(&corners);
            score.mean += quality;
            if quality < score.least {
                score.least = quality;
                score.worst_quad = k as u32;
            }
            score.size = score.size.min(hydraulic_size_m(&corners) / loops.size_m);
            for &node in quad {
                valence[node as usize] += 1;
            }
        }
        score.mean /= patch.quads.len().max(1) as f64;
        let inner = &valence[loops.nodes.len()..];
        let irregular = inner.iter().filter(|&&count| count != 4).count();
        score.irregular = irregular as f64 / inner.len().max(1) as f64;
        score
    }

    /// The rank: higher is better; 1 for a perfect lattice.
    ///
    /// The least Jacobian, as a share of what the sharpest corner allows, counts most while it is
    /// poor, because one bad element spoils a patch; above .6 it hardly matters, then mean shape,
    /// regularity and the time step decide.
    pub fn rank(&self) -> f64 {
        let least = self.least / self.bound.min(0.6);
        0.4 * least.min(1.0) + 0.35 * self.mean + 0.15 * (1.0 - self.irregular) + 0.1 * self.size
    }
}

/// The sine of the sharpest walk corner, 1 if none is sharper than a right angle.
fn bound(visits: &Visits) -> f64 {
    let angles = (0..visits.len() as u32).map(|visit| visits.angle(visit));
    angles.fold(FRAC_PI_2, f64::min).sin()
}
