//! Moves free nodes: a barrier energy that untangles, squares up and sizes quads.
//!
//! The energy is that of `star`; how it is lowered is here: nodes move one at a time (Gauss-Seidel)
//! by a safeguarded Newton step on 2 unknowns, since the clean-up needs cheap local smoothing far
//! more often than a global one.

use crate::geometry::quad::distance;
use crate::meshing::kernel::Kernel;
use crate::meshing::kernel::after;
use crate::meshing::kernel::before;
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

/// Sets the wished edge length of every node: on the outline half the length of its two edges, at most
/// `size_m`, inside the mean of the neighbours drawn towards `size_m`. (Without that limit quads along long edges
/// are deep as well: areas jump more from one side of a line to the other.)
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
        length[node as usize] = (0.5 * (ahead + behind)).min(size_m);
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
