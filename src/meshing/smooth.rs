//! Moves free nodes: a barrier energy that untangles, squares up and sizes quads.
//!
//! The energy is that of `star`; how it is lowered is here: nodes move one at a time (Gauss-Seidel)
//! by a safeguarded Newton step on 2 unknowns, since the clean-up needs cheap local smoothing far
//! more often than a global one.

use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::geometry::quad::measure;
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
const LOCAL_REST: f32 = 1e-2;

/// A shorter step, in wished lengths, is not taken: no rest is as small.
const LEAST_STEP: f64 = 1e-3;

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

/// Smooths all free nodes that are not at rest: at most `sweeps` sweeps, in the order of their
/// numbers. A node that moves by less than `rest` wished lengths rests until a neighbour moves
/// farther, or what is around it changes.
pub(crate) fn smooth_all(kernel: &mut Kernel, sweeps: usize, rest: f32) {
    let nodes = free_nodes(kernel);
    let mut star = Star::default();
    for _ in 0..sweeps {
        let mut any = false;
        for &node in &nodes {
            if kernel.unrest[node as usize] > rest {
                let moved = relax(kernel, &mut star, node, PERFECT);
                kernel.unrest[node as usize] = moved;
                stir(kernel, node, moved);
                any |= moved > rest;
            }
        }
        if !any {
            break;
        }
    }
}

/// The neighbours of a node that has moved are not at rest any more.
fn stir(kernel: &mut Kernel, node: u32, moved: f32) {
    if moved == 0.0 {
        return;
    }
    let first = kernel.spoke[node as usize];
    let mut side = first;
    while side != NONE {
        for near in [kernel.end(side), kernel.end(after(side))] {
            let unrest = &mut kernel.unrest[near as usize];
            *unrest = unrest.max(moved);
        }
        side = kernel.twin(before(side));
        if side == first {
            break;
        }
    }
}

/// Opens tangles: smooths around quads below `below` only, and as far as that makes others move.
pub(crate) fn untangle(kernel: &mut Kernel, below: f64, sweeps: usize, rest: f32) {
    let mut awake = vec![false; kernel.nodes.len()];
    let mut any = false;
    for quad in 0..kernel.quads.len() as u32 {
        if kernel.lives(quad) && kernel.quality(quad) < below {
            any = true;
            for node in kernel.quads[quad as usize] {
                awake[node as usize] = true;
            }
        }
    }
    if !any {
        return;
    }
    let nodes = free_nodes(kernel);
    let mut star = Star::default();
    for _ in 0..sweeps {
        let mut any = false;
        for &node in &nodes {
            if !std::mem::take(&mut awake[node as usize]) {
                continue;
            }
            let moved = relax(kernel, &mut star, node, OPEN);
            if moved > 0.0 {
                // Where the other phase would have it is not known.
                kernel.unrest[node as usize] = f32::INFINITY;
                stir(kernel, node, moved);
            }
            if moved > rest {
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

fn free_nodes(kernel: &Kernel) -> Vec<u32> {
    let free = |node: &u32| !kernel.held[*node as usize] && kernel.valence[*node as usize] > 0;
    (0..kernel.nodes.len() as u32).filter(free).collect()
}

/// Smooths a few nodes, in the given order.
pub(crate) fn smooth_few(kernel: &mut Kernel, nodes: &[u32], phase: Phase, sweeps: usize) {
    let mut star = Star::default();
    for _ in 0..sweeps {
        let mut most = 0.0_f32;
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
    let mut doubtful: Vec<u32> = (0..kernel.quads.len() as u32).collect();
    for _ in 0..LIFTS {
        doubtful.retain(|&quad| kernel.lives(quad) && worth(kernel, quad, size_m) < below);
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
            any |= lift(kernel, node, size_m);
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

/// So many times its hydraulic size over the wished one, a quad is worth at most: from two fifths of the
/// size on it is not lifted, a seventh of it is as bad as a corner of 15 degrees.
/// Smaller factors lift the least sizes at the price of the poorest shapes: 1.7 lowers the 1 % quantile of shapes by
/// .005 more, 2.2 and 2.6 leave the .1 % quantile of the time-step proxy 1 and 2 % lower.
const LARGE: f64 = 1.8;

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
    let measured = measure(&kernel.corners(quad));
    let shape = measured.scaled_jacobian;
    if shape > 0.0 {
        let shortest_m = (0..4)
            .filter(|&k| kernel.twins[quad as usize][k] != NONE)
            .map(|k| measured.sides_m[k])
            .fold(f64::INFINITY, f64::min);
        let scales = kernel.quads[quad as usize].map(|node| kernel.scale[node as usize]);
        let coarsest = scales.into_iter().fold(f64::INFINITY, f64::min);
        let size_m = size_m.min(COARSER / coarsest.sqrt());
        let side = LONG * shortest_m / size_m;
        shape
            .min(LARGE * measured.hydraulic_size_m / size_m)
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
    let quality = |kernel: &Kernel, side: u32| worth(kernel, quad_of(side), size_m);
    let least = |kernel: &Kernel| {
        let worths = spokes.iter().map(|&side| quality(kernel, side));
        worths.fold(f64::INFINITY, f64::min)
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
            // Most directions fail at the first quad.
            let better = |&side: &u32| quality(kernel, side) > best;
            if spokes.iter().all(better) && shortest(kernel) >= floor {
                best = least(kernel);
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

/// A corner counts as inverted up to this d: what single precision may get wrong.
const UPRIGHT: f32 = 1e-6;

/// One Newton step of one node; returns how far it moved, in wished lengths. Corners that are not
/// inverted stay so: small ones lie below epsilon, where the barrier alone would let them through.
fn relax(kernel: &mut Kernel, star: &mut Star, node: u32, phase: Phase) -> f32 {
    let per_m = kernel.scale[node as usize].sqrt();
    star.gather(kernel, node, per_m);
    let local = star.expand(phase);
    let step = local.newton_step();
    let reach = (step[0] * step[0] + step[1] * step[1]).sqrt();
    if reach < LEAST_STEP {
        return 0.0;
    }
    let mut factor = (0.7 / reach).min(1.0);
    for _ in 0..6 {
        let by = step.map(|it| factor * it);
        let (value, least) = star.energy(by.map(|it| it as f32), phase);
        if value < local.value && (least > UPRIGHT || local.least <= UPRIGHT) {
            let at = kernel.nodes[node as usize];
            kernel.nodes[node as usize] = [at[0] + by[0] / per_m, at[1] + by[1] / per_m];
            return (factor * reach) as f32;
        }
        factor *= 0.4;
    }
    0.0
}
