//! Moves the free nodes of the few quads that the energy of `star` leaves behind, by compass search.
//!
//! That energy serves the mean, and knows of sizes by way of wished lengths only. Two measures of its
//! last percent are raised here, one quad after the other, without regard to derivatives (they have
//! none): the *worth* of a quad, which is its shape unless it is small or has a short side, and its
//! *evenness*, the least ratio of areas with its neighbours.

use crate::geometry::point::COMPASS;
use crate::geometry::quad::Measured;
use crate::geometry::quad::area;
use crate::geometry::quad::distance;
use crate::geometry::quad::measure;
use crate::meshing::kernel::Few;
use crate::meshing::kernel::Kernel;
use crate::meshing::kernel::quad_of;
use crate::meshing::triangulate::NONE;

/// Below this worth a quad is lifted: far above the poorest, as the energy leaves the last percent
/// behind. Measured on five cities: .75 for .3 raises the 1 % quantile by .02 to .04 for 5 % of the
/// time.
const LIFTED: f64 = 0.75;

/// Below this evenness a quad is levelled with its neighbours.
const EVEN: f64 = 0.5;

/// No quad is levelled, or has its neighbour levelled, at the price of a worth below this, or below
/// its own where that is less.
///
/// (Measured on five cities: levelling lowers the 99 % quantile of the ratio of neighbouring areas by 1
/// to 7 %, 2.22 to 2.07 in one, and raises the .1 % quantile of the time-step proxy by up to 1 %, for
/// .0001 to .0006 of the mean shape. In that one, .85 lowers it to 2.05 for .0004 of the mean more.)
const KEPT: f64 = 0.88;

/// Sweeps over the quads that are still to be mended.
const SWEEPS: usize = 8;

/// Steps of one search.
const STEPS: usize = 6;

/// A search that has gained less is not worth another sweep.
const GAIN: f64 = 1e-3;

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

/// The [`worth_of`] a quad, sides on the outline left out.
pub(crate) fn worth(kernel: &Kernel, quad: u32, size_m: f64) -> f64 {
    let measured = measure(&kernel.corners(quad));
    if measured.scaled_jacobian <= 0.0 {
        return measured.scaled_jacobian;
    }
    let shortest_m = (0..4)
        .filter(|&k| kernel.twins[quad as usize][k] != NONE)
        .map(|k| measured.sides_m[k])
        .fold(f64::INFINITY, f64::min);
    let scales = kernel.quads[quad as usize].map(|node| kernel.scale[node as usize]);
    let coarsest = scales.into_iter().fold(f64::INFINITY, f64::min);
    let size_m = size_m.min(COARSER / coarsest.sqrt());
    worth_of(&measured, shortest_m, size_m)
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

/// The least area over the greatest of a quad and one of its neighbours.
fn evenness(kernel: &Kernel, quad: u32) -> f64 {
    let own = area(&kernel.corners(quad));
    let twins = kernel.twins[quad as usize].iter();
    let ratios = twins.filter(|&&twin| twin != NONE).map(|&twin| {
        let other = area(&kernel.corners(quad_of(twin)));
        (own / other).min(other / own)
    });
    ratios.fold(1.0, f64::min)
}

/// Raises the least [`worth`] around the free nodes of quads that have little.
pub(crate) fn lift_worst(kernel: &mut Kernel, size_m: f64) {
    let poor = |kernel: &Kernel, quad| worth(kernel, quad, size_m) < LIFTED;
    mend(kernel, poor, |kernel, node| lift(kernel, node, size_m));
}

/// Raises the least [`evenness`] around the free nodes of quads that have little.
pub(crate) fn level_worst(kernel: &mut Kernel, size_m: f64) {
    let uneven = |kernel: &Kernel, quad| evenness(kernel, quad) < EVEN;
    mend(kernel, uneven, |kernel, node| level(kernel, node, size_m));
}

/// Sweeps over the free nodes of all quads that are `poor`, in the order of their numbers, and of what
/// becomes so, while a search still gains.
fn mend(
    kernel: &mut Kernel,
    poor: impl Fn(&Kernel, u32) -> bool,
    search: impl Fn(&mut Kernel, u32) -> f64,
) {
    let mut doubtful: Vec<u32> = (0..kernel.quads.len() as u32).collect();
    for _ in 0..SWEEPS {
        doubtful.retain(|&quad| kernel.lives(quad) && poor(kernel, quad));
        let mut nodes: Vec<u32> = doubtful
            .iter()
            .flat_map(|&quad| kernel.quads[quad as usize])
            .collect();
        nodes.retain(|&node| !kernel.held[node as usize]);
        nodes.sort_unstable();
        nodes.dedup();
        let mut any = false;
        for node in nodes {
            let start = kernel.nodes[node as usize];
            any |= search(kernel, node) > GAIN;
            if kernel.nodes[node as usize] != start {
                doubtful.extend(kernel.spokes(node).iter().map(|&side| quad_of(side)));
            }
        }
        if !any {
            break;
        }
        doubtful.sort_unstable();
        doubtful.dedup();
    }
}

/// Searches a better least worth of the quads of one node; returns what it gained.
fn lift(kernel: &mut Kernel, node: u32, size_m: f64) -> f64 {
    let spokes = kernel.spokes(node);
    let quality = |kernel: &Kernel, side: u32| worth(kernel, quad_of(side), size_m);
    let least = |kernel: &Kernel| {
        let worths = spokes.iter().map(|&side| quality(kernel, side));
        worths.fold(f64::INFINITY, f64::min)
    };
    let start = least(kernel);
    // Most directions fail at the first quad.
    let better = |kernel: &Kernel, best: f64| {
        let rises = |&side: &u32| quality(kernel, side) > best;
        spokes.iter().all(rises).then(|| least(kernel))
    };
    compass(kernel, node, &spokes, start, better) - start
}

/// Searches a better least evenness of the quads of one node, up to [`EVEN`]; returns what it gained.
fn level(kernel: &mut Kernel, node: u32, size_m: f64) -> f64 {
    let spokes = kernel.spokes(node);
    let quality = |kernel: &Kernel, side: u32| worth(kernel, quad_of(side), size_m);
    let least = |kernel: &Kernel| {
        let quads = spokes.iter().map(|&side| evenness(kernel, quad_of(side)));
        quads.fold(1.0, f64::min)
    };
    let floors: Few<f64> = spokes
        .iter()
        .map(|&side| quality(kernel, side).min(KEPT))
        .collect();
    let start = least(kernel);
    let better = |kernel: &Kernel, best: f64| {
        let holds = |(&side, &floor): (&u32, &f64)| quality(kernel, side) >= floor;
        let allowed = best < EVEN && spokes.iter().zip(&floors).all(holds);
        allowed.then(|| least(kernel)).filter(|&now| now > best)
    };
    compass(kernel, node, &spokes, start, better) - start
}

/// A node may not come nearer to a neighbour than this share of the wished edge length to mend a
/// quad: shape alone would let two nodes fall together.
const APART: f64 = 0.18;

/// Moves one node where `better`, given the best value until now, finds a better one; returns the best.
fn compass(
    kernel: &mut Kernel,
    node: u32,
    spokes: &[u32],
    start: f64,
    better: impl Fn(&Kernel, f64) -> Option<f64>,
) -> f64 {
    let shortest_m = |kernel: &Kernel| {
        let at = kernel.nodes[node as usize];
        let length = |&side: &u32| distance(at, kernel.nodes[kernel.end(side) as usize]);
        spokes.iter().map(length).fold(f64::INFINITY, f64::min)
    };
    let mut best = start;
    let mut step_m = 0.3 * shortest_m(kernel);
    let floor_m = shortest_m(kernel).min(APART / kernel.scale[node as usize].sqrt());
    for _ in 0..STEPS {
        let at = kernel.nodes[node as usize];
        let mut to = at;
        for [x, y] in COMPASS {
            kernel.nodes[node as usize] = [at[0] + step_m * x, at[1] + step_m * y];
            let value = better(kernel, best).filter(|_| shortest_m(kernel) >= floor_m);
            if let Some(value) = value {
                best = value;
                to = kernel.nodes[node as usize];
            }
        }
        kernel.nodes[node as usize] = to;
        if to == at {
            step_m *= 0.4;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::kernel::grid;
    use crate::meshing::smooth::wish;
    use proptest::prelude::*;

    /// A grid whose inner nodes have moved by up to `by` of a cell.
    fn shaken(moves: &[[f64; 2]], by: f64) -> Kernel {
        let mut kernel = grid(5, 4);
        wish(&mut kernel, 1.0);
        let inner = (0..kernel.nodes.len()).filter(|&node| !kernel.held[node]);
        for (node, [x, y]) in inner.collect::<Vec<_>>().into_iter().zip(moves) {
            let at = kernel.nodes[node];
            kernel.nodes[node] = [at[0] + by * x, at[1] + by * y];
        }
        kernel
    }

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

        #[test]
        fn lifting_lowers_no_least_worth(
            moves in proptest::collection::vec(prop::array::uniform2(-1.0_f64..1.0), 12),
            by in 0.0_f64..0.45,
        ) {
            let mut kernel = shaken(&moves, by);
            let before = least(&all(&kernel, |quad| worth(&kernel, quad, 1.0)));
            lift_worst(&mut kernel, 1.0);
            prop_assert!(least(&all(&kernel, |quad| worth(&kernel, quad, 1.0))) >= before);
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
}
