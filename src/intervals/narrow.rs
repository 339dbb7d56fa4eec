//! What makes an interval more dear than its length tells: how narrow the sub-domains beside it are.
//!
//! A quad is as small as its shorter side lets it be. To halve an edge of full size harms nothing beside an
//! open place, but along a narrow one the two quads are small both ways, and these rule a solver's time step.

use crate::domain::size::SizeWish;
use crate::intervals::WEIGHT_MAX;
use crate::intervals::goals::Goals;
use crate::partition::subdomains::Partition;
use crate::partition::subdomains::Subdomain;

/// Sub-domains whose 2 x area / circumference is below this, in sizes, are narrow: strips of this width, and
/// squares of twice this side. (Measured on twelve cities with the price of
/// [`Goals::block_weight`]: the .1 % quantile of the time-step proxy grows by .8 %, the 1 % quantile of shapes by .001,
/// irregular nodes fall by .02 points. Up to .5 takes the synthetic cities .02 points of irregular nodes more, for
/// no more; the square of the ratio gains no more.)
const NARROW: f64 = 0.35;

/// Raises the weights of the curves beside narrow sub-domains, by how narrow the narrower one is.
pub(super) fn raise(goals: &mut Goals, sizes: &SizeWish, partition: &Partition) {
    let widths: Vec<f64> = (partition.subdomains.iter())
        .map(|it| width(goals, sizes, it))
        .collect();
    for (weight, curve) in goals.weight.iter_mut().zip(&partition.curves) {
        // outside there is no quad
        let beside = [curve.left, curve.right].map(|it| widths.get(it as usize));
        let least = beside.into_iter().flatten().copied().fold(NARROW, f64::min);
        *weight = (*weight * NARROW / least).min(WEIGHT_MAX);
    }
}

/// 2 x area / circumference, in sizes.
fn width(goals: &Goals, sizes: &SizeWish, subdomain: &Subdomain) -> f64 {
    let curves = subdomain.walks.iter().flatten().map(|half| half >> 1);
    let circumference: f64 = curves.map(|curve| goals.goal[curve as usize]).sum();
    2.0 * subdomain.area_m2 / sizes.default_m.powi(2) / circumference
}
