//! Levels steep neighbours: raises the *evenness* of a quad, the least ratio of areas with its neighbours.
//!
//! A patch knows what lies across its outline only by how wide the sub-domain there is (`boundary::widths_m`): beside
//! a strip of two fifths of the size a first row of full depth is twice and a half too large.

use crate::geometry::point::Xy;
use crate::geometry::quad::area;
use crate::meshing::kernel::Few;
use crate::meshing::kernel::Kernel;
use crate::meshing::kernel::quad_of;
use crate::meshing::mend::compass;
use crate::meshing::mend::mend;
use crate::meshing::ring::Beside;
use crate::meshing::ring::Ring;
use crate::meshing::triangulate::NONE;

/// Below this evenness a quad is levelled with its neighbours.
const EVEN: f64 = 0.5;

/// No quad is levelled, or has its neighbour levelled, at the price of a worth below this, or below
/// its own where that is less.
///
/// (Measured on five cities: levelling lowers the 99 % quantile of the ratio of neighbouring areas by 1
/// to 7 %, 2.22 to 2.07 in one, and raises the .1 % quantile of the time-step proxy by up to 1 %, for
/// .0001 to .0006 of the mean shape. In that one, .85 lowers it to 2.05 for .0004 of the mean more.)
const KEPT: f64 = 0.88;

/// The same where quads across the outline are levelled with, in the patch that has won. (Measured on `nl-thoekje-polder`,
/// which has many strips of two fifths of the size: the 99 % quantile of the ratio of neighbouring areas falls from 2.37 to 2.22
/// for .0009 of the mean shape; with .92 to 2.19 for .002, with .88 to 2.17 for .003.)
const KEPT_ACROSS: f64 = 0.95;

/// The least area over the greatest of a quad and one of its neighbours.
pub(crate) fn evenness(kernel: &Kernel, quad: u32) -> f64 {
    let own = area(&kernel.corners(quad));
    let twins = kernel.twins[quad as usize].iter();
    let ratios = twins.filter(|&&twin| twin != NONE).map(|&twin| {
        let other = area(&kernel.corners(quad_of(twin)));
        (own / other).min(other / own)
    });
    ratios.fold(1.0, f64::min)
}

/// The same, with what lies across the outline as deep as it is likely to be.
pub(crate) fn evenness_across(kernel: &Kernel, quad: u32) -> f64 {
    let own = area(&kernel.corners(quad));
    let outer = (0..4).filter(|&k| kernel.twins[quad as usize][k] == NONE);
    let known = outer.filter_map(|k| kernel.across_m2(quad, k));
    let ratios = known.map(|other| (own / other).min(other / own));
    ratios.fold(evenness(kernel, quad), f64::min)
}

/// Raises the least [`evenness`] around the free nodes of quads that have little.
pub(crate) fn level_worst(kernel: &mut Kernel, size_m: f64) {
    let uneven = |kernel: &Kernel, quad| evenness(kernel, quad) < EVEN;
    mend(kernel, uneven, |kernel, node| {
        level(kernel, node, size_m, false, KEPT)
    });
}

/// The same of [`evenness_across`].
pub(crate) fn level_across(kernel: &mut Kernel, size_m: f64) {
    let uneven = |kernel: &Kernel, quad| evenness_across(kernel, quad) < EVEN;
    mend(kernel, uneven, |kernel, node| {
        level(kernel, node, size_m, true, KEPT_ACROSS)
    });
}

/// Searches a better least evenness of the quads of one node, up to [`EVEN`], none of them worth less than `kept` or
/// than it was; returns what it gained.
fn level(kernel: &mut Kernel, node: u32, size_m: f64, looks_across: bool, kept: f64) -> f64 {
    let ring = Ring::of(kernel, node, size_m);
    let beside = Beside::of(kernel, &ring, looks_across);
    let floors: Few<f64> = (0..ring.len())
        .map(|k| ring.worth(k, ring.at).min(kept))
        .collect();
    let start = beside.least(&ring, ring.at);
    let better = |place: Xy, best: f64| {
        if best >= EVEN {
            return None;
        }
        // an area costs less than a worth
        let now = beside.least(&ring, place);
        let holds = |(k, &floor): (usize, &f64)| ring.worth(k, place) >= floor;
        (now > best && floors.iter().enumerate().all(holds)).then_some(now)
    };
    let (best, place) = compass(&ring, start, better);
    kernel.nodes[node as usize] = place;
    best - start
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::kernel::grid;
    use crate::meshing::kernel::shaken;
    use crate::meshing::lift::worth;
    use crate::meshing::smooth::wish;
    use proptest::prelude::*;

    fn all(kernel: &Kernel, measure: impl Fn(u32) -> f64) -> Vec<f64> {
        (0..kernel.quads.len() as u32).map(measure).collect()
    }

    fn least(values: &[f64]) -> f64 {
        values.iter().copied().fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #[test]
        fn levelling_makes_no_fair_quad_poor(
            moves in proptest::collection::vec(prop::array::uniform2(-1.0_f64..1.0), 12),
            by in 0.0_f64..0.45,
        ) {
            let mut kernel = shaken(&moves, by);
            let nodes = kernel.nodes.clone();
            let worths = all(&kernel, |quad| worth(&kernel, quad, 1.0));
            let before = least(&all(&kernel, |quad| evenness(&kernel, quad)));
            level_worst(&mut kernel, 1.0);
            let after = least(&all(&kernel, |quad| evenness(&kernel, quad)));
            prop_assert!(after >= before.min(EVEN));
            prop_assert!(before < EVEN || kernel.nodes == nodes, "what is even enough stays");
            for (quad, was) in worths.into_iter().enumerate() {
                prop_assert!(worth(&kernel, quad as u32, 1.0) >= was.min(KEPT) - 1e-12);
            }
        }
    }

    #[test]
    fn one_steep_pair_is_levelled() {
        // the middle column of three: a cell of 1.45 below one of .55
        let mut kernel = grid(3, 2);
        wish(&mut kernel, 1.0);
        for node in 0..kernel.nodes.len() {
            if !kernel.held[node] {
                kernel.nodes[node][1] += 0.45;
            }
        }
        assert!(evenness(&kernel, 1) < EVEN);
        level_worst(&mut kernel, 1.0);
        let even = all(&kernel, |quad| evenness(&kernel, quad));
        assert!(least(&even) >= EVEN, "{even:?}");
    }

    /// Quads of the size beside a strip of .45 of it: the first row becomes narrower.
    #[test]
    fn a_row_is_levelled_with_a_strip_across_the_line() {
        let mut kernel = grid(6, 6);
        wish(&mut kernel, 1.0);
        for node in 0..kernel.nodes.len() {
            if kernel.nodes[node][1] == 0.0 && kernel.nodes[node][0] < 6.0 {
                kernel.across_m[node] = 0.45;
            }
        }
        let even = |kernel: &Kernel| least(&all(kernel, |quad| evenness_across(kernel, quad)));
        assert!((even(&kernel) - 0.45).abs() < 1e-12);
        level_worst(&mut kernel, 1.0);
        assert!(
            (even(&kernel) - 0.45).abs() < 1e-12,
            "it does not look across"
        );
        level_across(&mut kernel, 1.0);
        // the corners of a row between two walls cannot move
        let inner = (1..5).map(|quad| evenness_across(&kernel, quad));
        assert!(inner.fold(1.0, f64::min) >= EVEN - 0.01);
    }
}
