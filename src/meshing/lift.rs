//! Lifts the quads that the energy of `star` leaves behind: raises their *worth*, which is the shape unless a quad is
//! small or has a short side.
//!
//! That energy serves the mean, and knows of sizes by way of wished lengths only. Its last percent is lifted
//! wherever a candidate is made (`lift_worst`); in the patch that has won, nearly all quads are
//! (`lift_last`), as long as areas stay even.

use crate::geometry::point::Xy;
use crate::geometry::quad::Measured;
use crate::geometry::quad::measure;
use crate::meshing::kernel::Few;
use crate::meshing::kernel::Kernel;
use crate::meshing::mend::compass;
use crate::meshing::mend::mend;
use crate::meshing::ring::Beside;
use crate::meshing::ring::Ring;
use crate::meshing::triangulate::NONE;
use std::cell::LazyCell;

/// Below this worth a quad is lifted: far above the poorest, as the energy leaves the last percent
/// behind. Measured on five cities: .75 for .3 raises the 1 % quantile by .02 to .04 for 5 % of the
/// time.
const LIFTED: f64 = 0.75;

/// Below this one, in the patch that has won. (Measured on a synthetic city at 10 m: the 5 % quantile of shapes grows
/// from .849 to .866, the 1 % quantile from .778 to .805, for .0007 of the mean. With .97 the mean is .0005 higher, but meshing
/// takes longer, and the mean ratio of neighbouring areas of one city grows from 1.087 to 1.108, not to 1.098.)
const LIFTED_LAST: f64 = 0.92;

/// There no quad comes below this evenness, or below the least one around the node that moves where that is less. (Measured on two cities, lifting up to .97:
/// with no limit the 99 % quantile of the ratio of neighbouring areas grows from 1.41 to 1.64 and from 1.99 to 2.10, with
/// this one to 1.55 and 1.99.)
const EVEN_LAST: f64 = 0.6;

/// So many times its hydraulic size over the wished one, a quad is worth at most: from two fifths of the
/// size on it is not lifted, a seventh of it is as bad as a corner of 15 degrees.
/// Smaller factors lift the least sizes at the price of the poorest shapes: 1.7 lowers the 1 % quantile of shapes by
/// .005 more, 2.2 and 2.6 leave the .1 % quantile of the time-step proxy 1 and 2 % lower.
const LARGE: f64 = 1.8;

/// The same for its shortest side that is not on the outline: those are given. (Measured on twelve
/// cities: 2.3 lowers the .1 % quantile of edges by 4.2 %, and leaves two more below a quarter of the size there, for
/// .005 of the 1 % quantile of shapes; 2.0 raises it by 1.3 %, which brings no other there, for .004.)
const LONG: f64 = 2.1;

/// The worth of a side falls with the square of its length, for at about a quarter of the size
/// it should end: this is what such a side is worth. (Measured on four cities against a worth in
/// proportion: the .1 % quantile of edges grows by 2 to 9 %, with the same mean shape.)
const ENOUGH: f64 = 0.6;

/// But no side is worth a shape poorer than this: without such a floor, the least shapes of three
/// cities fall by 14 to 36 %.
const SPARED: f64 = 0.35;

/// A quad is asked to be at most this many times as large as the edges around it: among edges a
/// twentieth of the size nothing can be large, and trying costs a fifth of the time there.
const COARSER: f64 = 2.0;

/// What a quad is asked for, wherever its corners are.
pub(crate) struct Wish {
    /// Which sides count: all that are not on the outline.
    inner: [bool; 4],
    /// How large it should be, metres.
    size_m: f64,
}

impl Wish {
    pub fn of(kernel: &Kernel, quad: u32, size_m: f64) -> Wish {
        let scales = kernel.quads[quad as usize].map(|node| kernel.scale[node as usize]);
        let coarsest = scales.into_iter().fold(f64::INFINITY, f64::min);
        Wish {
            inner: kernel.twins[quad as usize].map(|twin| twin != NONE),
            size_m: size_m.min(COARSER / coarsest.sqrt()),
        }
    }

    /// The [`worth_of`] a quad with these corners, sides on the outline left out.
    pub fn worth(&self, corners: &[Xy; 4]) -> f64 {
        let measured = measure(corners);
        if measured.scaled_jacobian <= 0.0 {
            return measured.scaled_jacobian;
        }
        let sides = measured.sides_m.iter().zip(self.inner);
        let shortest_m = sides
            .filter(|it| it.1)
            .map(|it| *it.0)
            .fold(f64::INFINITY, f64::min);
        worth_of(&measured, shortest_m, self.size_m)
    }
}

/// The [`worth_of`] a quad, sides on the outline left out.
pub(crate) fn worth(kernel: &Kernel, quad: u32, size_m: f64) -> f64 {
    Wish::of(kernel, quad, size_m).worth(&kernel.corners(quad))
}

/// The scaled Jacobian, less if the quad is small for its wished size or its shortest side that
/// counts is short.
pub(crate) fn worth_of(measured: &Measured, shortest_m: f64, size_m: f64) -> f64 {
    let shape = measured.scaled_jacobian;
    if shape <= 0.0 {
        return shape;
    }
    let side = LONG * shortest_m / size_m;
    shape
        .min(LARGE * measured.hydraulic_size_m / size_m)
        .min((side * side / ENOUGH).max(side.min(SPARED)))
}

/// Raises the least [`worth`] around the free nodes of quads that have little.
pub(crate) fn lift_worst(kernel: &mut Kernel, size_m: f64) {
    let poor = |kernel: &Kernel, quad| worth(kernel, quad, size_m) < LIFTED;
    mend(kernel, poor, |kernel, node| lift(kernel, node, size_m, 0.0));
}

/// The same of nearly all quads, unless areas become uneven by it.
pub(crate) fn lift_last(kernel: &mut Kernel, size_m: f64) {
    let poor = |kernel: &Kernel, quad| worth(kernel, quad, size_m) < LIFTED_LAST;
    mend(kernel, poor, |kernel, node| {
        lift(kernel, node, size_m, EVEN_LAST)
    });
}

/// Searches a better least worth of the quads of one node, none of them less even than `even`, or than the least one
/// was; returns what it gained.
fn lift(kernel: &mut Kernel, node: u32, size_m: f64, even: f64) -> f64 {
    let ring = Ring::of(kernel, node, size_m);
    let mut worths: Few<(f64, usize)> = (0..ring.len())
        .map(|k| (ring.worth(k, ring.at), k))
        .collect();
    // most places fail at the poorest quad
    worths.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let start = worths.first().map_or(f64::INFINITY, |it| it.0);
    // few places get as far as to be asked for it
    let evenness = LazyCell::new(|| {
        let beside = Beside::of(kernel, &ring, true);
        let floor = even.min(beside.least(&ring, ring.at));
        (beside, floor)
    });
    let better = |place: Xy, best: f64| {
        let mut least = f64::INFINITY;
        for &(_, k) in &worths {
            least = least.min(ring.worth_above(k, place, best)?);
        }
        let is_even = even == 0.0 || evenness.0.least(&ring, place) >= evenness.1;
        is_even.then_some(least)
    };
    let (best, place) = compass(&ring, start, better);
    kernel.nodes[node as usize] = place;
    best - start
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::kernel::shaken;
    use crate::meshing::level::evenness;
    use proptest::prelude::*;

    fn least(kernel: &Kernel, measure: impl Fn(u32) -> f64) -> f64 {
        let quads = 0..kernel.quads.len() as u32;
        quads.map(measure).fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #[test]
        fn lifting_lowers_no_least_worth(
            moves in proptest::collection::vec(prop::array::uniform2(-1.0_f64..1.0), 12),
            by in 0.0_f64..0.45,
        ) {
            let mut kernel = shaken(&moves, by);
            let before = least(&kernel, |quad| worth(&kernel, quad, 1.0));
            lift_worst(&mut kernel, 1.0);
            prop_assert!(least(&kernel, |quad| worth(&kernel, quad, 1.0)) >= before);
        }

        #[test]
        fn the_last_lift_leaves_areas_even(
            moves in proptest::collection::vec(prop::array::uniform2(-1.0_f64..1.0), 12),
            by in 0.0_f64..0.3,
        ) {
            let mut kernel = shaken(&moves, by);
            let worst = least(&kernel, |quad| worth(&kernel, quad, 1.0));
            let even = least(&kernel, |quad| evenness(&kernel, quad));
            lift_last(&mut kernel, 1.0);
            prop_assert!(least(&kernel, |quad| worth(&kernel, quad, 1.0)) >= worst);
            prop_assert!(least(&kernel, |quad| evenness(&kernel, quad)) >= even.min(EVEN_LAST) - 1e-12);
        }
    }

    /// A quad of .9 is good enough for a candidate, and is lifted in the winner.
    #[test]
    fn what_is_fair_is_lifted_at_last() {
        let mut kernel = shaken(
            &[[0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2], [1.0, 0.6]],
            0.25,
        );
        let worst = |kernel: &Kernel| least(kernel, |quad| worth(kernel, quad, 1.0));
        let before = worst(&kernel);
        assert!((LIFTED..LIFTED_LAST).contains(&before), "{before}");
        lift_worst(&mut kernel, 1.0);
        assert_eq!(worst(&kernel), before);
        lift_last(&mut kernel, 1.0);
        assert!(worst(&kernel) > LIFTED_LAST, "{}", worst(&kernel));
    }
}
