//! Moves free nodes: a barrier energy that untangles, squares up and sizes quads.
//!
//! The energy is that of `star`; how it is lowered is here: nodes move one at a time (Gauss-Seidel)
//! by a safeguarded Newton step on 2 unknowns, since the clean-up needs cheap local smoothing far
//! more often than a global one.

use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::geometry::quad::hydraulic_size_m;
use crate::geometry::quad::scaled_jacobian;
use crate::meshing::kernel::Kernel;
use crate::meshing::kernel::after;
use crate::meshing::kernel::before;
use crate::meshing::kernel::quad_of;
use crate::meshing::star::Phase;
use crate::meshing::star::Star;
use crate::meshing::triangulate::NONE;

/// To open tangles.
pub(crate) const OPEN: Phase = Phase {
    epsilon: 0.3,
    squared: false,
};

/// To perfect.
pub(crate) const PERFECT: Phase = Phase {
    epsilon: 0.05,
    squared: true,
};

/// Below this move, as a share of the wished edge length, local smoothing has done its work.
const LOCAL_REST: f64 = 1e-2;

/// Sets the wished edge length of every node: on the outline half the length of its two edges,
/// inside the mean of the neighbours drawn towards `size_m`.
pub(crate) fn wish(kernel: &mut Kernel, size_m: f64) {
    let count = kernel.nodes.len();
    let mut length = vec![size_m; count];
    for node in (0..count as u32).filter(|&node| kernel.held[node as usize]) {
        let spokes = kernel.spokes(node);
        let (Some(&first), Some(&last)) = (spokes.first(), spokes.last()) else {
            continue;
        };
        let at = kernel.nodes[node as usize];
        let ahead = distance(at, kernel.nodes[kernel.end(first) as usize]);
        let behind = distance(at, kernel.nodes[kernel.start(before(last)) as usize]);
        length[node as usize] = 0.5 * (ahead + behind);
    }
    // A wish fades by about a factor of two a row, so six rows are enough.
    for _ in 0..6 {
        for node in (0..count as u32).filter(|&node| !kernel.held[node as usize]) {
            let spokes = kernel.spokes(node);
            let near = |&side: &u32| length[kernel.end(side) as usize];
            let sum: f64 = spokes.iter().map(near).sum();
            length[node as usize] = (sum + size_m) / (spokes.len() as f64 + 1.0);
        }
    }
    for (scale, length) in kernel.scale.iter_mut().zip(length) {
        *scale = 1.0 / (length * length);
    }
}

/// Smooths all free nodes: at most `sweeps` sweeps, in the order of their numbers. A node that moves
/// by less than `rest` wished lengths rests until a neighbour moves.
pub(crate) fn smooth_all(kernel: &mut Kernel, phase: Phase, sweeps: usize, rest: f64) {
    let mut awake = vec![true; kernel.nodes.len()];
    sweep(kernel, phase, sweeps, rest, &mut awake);
}

/// Opens tangles: smooths around quads below `below` only, and as far as that makes others move.
pub(crate) fn untangle(kernel: &mut Kernel, below: f64, sweeps: usize, rest: f64) {
    let mut awake = vec![false; kernel.nodes.len()];
    for quad in 0..kernel.quads.len() as u32 {
        if kernel.lives(quad) && kernel.quality(quad) < below {
            for node in kernel.quads[quad as usize] {
                awake[node as usize] = true;
            }
        }
    }
    sweep(kernel, OPEN, sweeps, rest, &mut awake);
}

fn sweep(kernel: &mut Kernel, phase: Phase, sweeps: usize, rest: f64, awake: &mut [bool]) {
    let free = |node: &u32| !kernel.held[*node as usize] && kernel.valence[*node as usize] > 0;
    let nodes: Vec<u32> = (0..kernel.nodes.len() as u32).filter(free).collect();
    let mut star = Star::default();
    for _ in 0..sweeps {
        let mut any = false;
        for &node in &nodes {
            if !std::mem::take(&mut awake[node as usize]) {
                continue;
            }
            if relax(kernel, &mut star, node, phase) > rest {
                any = true;
                awake[node as usize] = true;
                for side in kernel.spokes(node) {
                    awake[kernel.end(side) as usize] = true;
                    awake[kernel.end(after(side)) as usize] = true;
                }
            }
        }
        if !any {
            break;
        }
    }
}

/// Smooths a few nodes, in the given order.
pub(crate) fn smooth_few(kernel: &mut Kernel, nodes: &[u32], phase: Phase, sweeps: usize) {
    let mut star = Star::default();
    for _ in 0..sweeps {
        let mut most = 0.0_f64;
        for &node in nodes {
            most = most.max(relax(kernel, &mut star, node, phase));
        }
        if most < LOCAL_REST {
            break;
        }
    }
}

/// Sweeps of [`lift_worst`] over the quads that are still too poor.
const LIFTS: usize = 8;

/// Raises the least [`worth`] around the free nodes of quads below `below`, by compass search: the
/// few worst quads are ruled by lengths that the wished ones know nothing of.
pub(crate) fn lift_worst(kernel: &mut Kernel, below: f64, size_m: f64) {
    for _ in 0..LIFTS {
        let poor = |&quad: &u32| kernel.lives(quad) && worth(kernel, quad, size_m) < below;
        let quads: Vec<u32> = (0..kernel.quads.len() as u32).filter(poor).collect();
        let mut nodes: Vec<u32> = quads
            .iter()
            .flat_map(|&quad| kernel.quads[quad as usize])
            .collect();
        nodes.retain(|&node| !kernel.held[node as usize]);
        nodes.sort_unstable();
        nodes.dedup();
        let mut any = false;
        for node in nodes {
            any |= lift(kernel, node, size_m);
        }
        if !any {
            break;
        }
    }
}

/// So many times its hydraulic size over the wished one, a quad is worth at most: two fifths of the
/// size cost no more than a solver's time step, a tenth of it is as bad as a corner of 15 degrees.
/// Smaller factors lift the least sizes at the price of the poorest shapes: against 3, these two
/// (with the rescues of `finish`) raise the .1 % quantile of edges by a tenth and lower the 1 %
/// quantile of shapes by up to .01.
const LARGE: f64 = 2.6;

/// The same for its shortest side that is not on the outline: those are given. (Measured on seven
/// cities: 2.4 leaves two below a quarter of the size at the .1 % quantile of edges, 2.2 costs .003
/// to .015 of the 1 % quantile of shapes.)
const LONG: f64 = 2.3;

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

/// The scaled Jacobian, less if the quad is small or has a short side.
pub(crate) fn worth(kernel: &Kernel, quad: u32, size_m: f64) -> f64 {
    let corners = kernel.corners(quad);
    let shape = scaled_jacobian(&corners);
    if shape > 0.0 {
        let shortest_m = (0..4)
            .filter(|&k| kernel.twins[quad as usize][k] != NONE)
            .map(|k| distance(corners[k], corners[(k + 1) % 4]))
            .fold(f64::INFINITY, f64::min);
        let scales = kernel.quads[quad as usize].map(|node| kernel.scale[node as usize]);
        let coarsest = scales.into_iter().fold(f64::INFINITY, f64::min);
        let size_m = size_m.min(COARSER / coarsest.sqrt());
        let side = LONG * shortest_m / size_m;
        shape
            .min(LARGE * hydraulic_size_m(&corners) / size_m)
            .min((side * side / ENOUGH).max(side.min(SPARED)))
    } else {
        shape
    }
}

/// A node may not come nearer to a neighbour than this share of the wished edge length to lift a
/// quad: shape alone would let two nodes fall together.
const APART: f64 = 0.18;

const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Eight directions.
const COMPASS: [Xy; 8] = [
    [1.0, 0.0],
    [HALF, HALF],
    [0.0, 1.0],
    [-HALF, HALF],
    [-1.0, 0.0],
    [-HALF, -HALF],
    [0.0, -1.0],
    [HALF, -HALF],
];

/// Compass search of one node for a better least worth of its quads; true if it moved.
fn lift(kernel: &mut Kernel, node: u32, size_m: f64) -> bool {
    let spokes = kernel.spokes(node);
    let shortest = |kernel: &Kernel| {
        let at = kernel.nodes[node as usize];
        let length = |&side: &u32| distance(at, kernel.nodes[kernel.end(side) as usize]);
        spokes.iter().map(length).fold(f64::INFINITY, f64::min)
    };
    let least = |kernel: &Kernel| {
        let quality = |&side: &u32| worth(kernel, quad_of(side), size_m);
        spokes.iter().map(quality).fold(f64::INFINITY, f64::min)
    };
    let mut step = 0.3 * shortest(kernel);
    let floor = shortest(kernel).min(APART / kernel.scale[node as usize].sqrt());
    let start = least(kernel);
    let mut best = start;
    for _ in 0..6 {
        let at = kernel.nodes[node as usize];
        let mut to = at;
        for [x, y] in COMPASS {
            kernel.nodes[node as usize] = [at[0] + step * x, at[1] + step * y];
            let quality = least(kernel);
            if quality > best && shortest(kernel) >= floor {
                best = quality;
                to = kernel.nodes[node as usize];
            }
        }
        kernel.nodes[node as usize] = to;
        if to == at {
            step *= 0.4;
        }
    }
    best > start + 1e-3
}

/// One Newton step of one node; returns how far it moved, in wished lengths. Corners that are not
/// inverted stay so: small ones lie below epsilon, where the barrier alone would let them through.
fn relax(kernel: &mut Kernel, star: &mut Star, node: u32, phase: Phase) -> f64 {
    star.gather(kernel, node);
    let at = kernel.nodes[node as usize];
    let local = star.expand(at, phase);
    let step = local.newton_step();
    let length = 1.0 / kernel.scale[node as usize].sqrt();
    let reach = (step[0] * step[0] + step[1] * step[1]).sqrt();
    let mut factor = (0.7 * length / reach).min(1.0);
    for _ in 0..6 {
        let to = [at[0] + factor * step[0], at[1] + factor * step[1]];
        let (value, least) = star.energy(to, phase);
        if value < local.value && (least > 0.0 || local.least <= 0.0) {
            kernel.nodes[node as usize] = to;
            return factor * reach / length;
        }
        factor *= 0.4;
    }
    0.0
}
