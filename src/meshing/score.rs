//! One number that says which of several patches of a sub-domain is best.

use crate::geometry::quad::measure;
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
    /// Share of nodes whose number of quads is not right: four inside, on a walk that which is
    /// nearest to right angles. One that is nearly as near counts for the difference.
    pub irregular: f64,
    /// Least hydraulic size / wished size, at most 1: what bounds the time step of a solver.
    pub size: f64,
    /// Quads over the number that the area asks for at the wished size, and half a quad an edge.
    pub crowding: f64,
    /// No mesh can have a greater least scaled Jacobian: the sine of the sharpest walk corner.
    pub bound: f64,
    /// Index of the quad with the least scaled Jacobian.
    pub worst_quad: u32,
}

/// Cells from this share of the wished size on cost a solver nothing that counts. (A little above the .35 that
/// is asked of all but one cell in a thousand: at .35 itself, a cell just below it would cost nothing.)
const BRISK: f64 = 0.4;
/// What a patch can lose if its least cell is smaller.
const SLOW: f64 = 1.07;
/// A least Jacobian below this is not traded for larger cells.
const POOR: f64 = 0.3;

impl Score {
    /// Measures a patch.
    pub(crate) fn of(patch: &Patch, visits: &Visits, loops: &Loops) -> Score {
        let mut score = Score {
            least: 1.0,
            mean: 0.0,
            irregular: 0.0,
            size: 1.0,
            crowding: 0.0,
            bound: bound(visits),
            worst_quad: 0,
        };
        let mut valence = vec![0_u32; patch.nodes.len()];
        for (k, quad) in patch.quads.iter().enumerate() {
            let corners = quad.map(|node| patch.nodes[node as usize]);
            let measured = measure(&corners);
            let quality = measured.scaled_jacobian;
            score.mean += quality;
            if quality < score.least {
                score.least = quality;
                score.worst_quad = k as u32;
            }
            score.size = score.size.min(measured.hydraulic_size_m / loops.size_m);
            for &node in quad {
                valence[node as usize] += 1;
            }
        }
        score.mean /= patch.quads.len().max(1) as f64;
        score.irregular = irregular(&valence, visits, loops);
        let wished = visits.area_m2() / (loops.size_m * loops.size_m) + 0.5 * visits.len() as f64;
        score.crowding = patch.quads.len() as f64 / wished;
        score
    }

    /// The rank: higher is better; 1 for a perfect lattice.
    ///
    /// The least Jacobian, as a share of what the sharpest corner allows, counts most while it is
    /// poor, because one bad element spoils a patch; above .6 it hardly matters, then mean shape,
    /// regularity, the time step and the number of quads decide: a wedge can be mapped with good
    /// corners and cells of half the size, but half again as many as wished lose all of the last.
    ///
    /// An irregular node may cost nine tenths of a perfect quad's shape in all. (Measured on a city of 10 000
    /// segments where lattices with few such nodes compete with looping: three quarters for a half leave .24 %
    /// irregular nodes fewer, for .0009 of the mean shape and .002 of the 5 % quantile; nine tenths another .08 %.)
    ///
    /// Cells below [`BRISK`] lose more: fewer and larger quads with poorer corners are better then,
    /// as long as no corner is [`POOR`]. (Measured on six cities against .35 and a loss of .4, with the worth of
    /// sizes in `smooth`: the .1 % quantile of the time-step proxy grows by 2 to 7 %; the 1 % quantile of shapes
    /// keeps within .005, but falls by .016 where lines are densest.)
    ///
    /// Measured on six cities: a weight of .3 for the least and .3 for the mean lowers the least
    /// cell of a mesh (.21 to .13 in one) for .0005 of its mean.
    pub fn rank(&self) -> f64 {
        let least = self.least / self.bound.min(0.6);
        let traded = if self.least < POOR { 0.0 } else { self.size };
        let room = (1.0 - 2.0 * (self.crowding - 1.0)).clamp(0.0, 1.0);
        0.36 * least.min(1.0)
            + 0.24 * self.mean
            + 0.22 * (1.0 - self.irregular)
            + 0.09 * self.size
            + 0.09 * room
            - SLOW * (1.0 - traded / BRISK).max(0.0)
    }
}

/// See [`Score::irregular`].
fn irregular(valence: &[u32], visits: &Visits, loops: &Loops) -> f64 {
    let (outer, inner) = valence.split_at(loops.nodes.len());
    let inner_irregular = inner.iter().filter(|&&count| count != 4).count() as f64;
    let mut right = vec![0.0; outer.len()];
    for visit in 0..visits.len() as u32 {
        let angle = visits.angle(visit) / FRAC_PI_2;
        right[visits.unique[visit as usize] as usize] += angle.max(1.0);
    }
    let beyond_need = |(&count, &right): (&u32, &f64)| {
        let need = (right - right.round()).abs();
        ((f64::from(count) - right).abs() - need).min(1.0)
    };
    let outer_irregular: f64 = outer.iter().zip(&right).map(beyond_need).sum();
    (inner_irregular + outer_irregular) / valence.len() as f64
}

/// The sine of the sharpest walk corner, 1 if none is sharper than a right angle.
fn bound(visits: &Visits) -> f64 {
    let angles = (0..visits.len() as u32).map(|visit| visits.angle(visit));
    angles.fold(FRAC_PI_2, f64::min).sin()
}
