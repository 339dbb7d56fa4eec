//! Moves free nodes: a barrier energy that untangles, squares up and sizes quads.
//!
//! Per corner with edges e1, e2 scaled by the wished length, and d = e1 x e2:
//!
//! f = [(|e1|^2 + |e2|^2) / 2 + .35 (1 + d^2) / 2] / chi(d),  chi = (d + sqrt(eps^2 + d^2)) / 2
//!
//! The first term is least (1) for a right angle between equal edges, the second for a corner of
//! the wished size. chi tends to d for good corners and stays positive for inverted ones, so the
//! energy is smooth everywhere and the optimiser can start from a tangle (Garanzha, Kaporin,
//! Kudryavtseva, Protais, Ray, Sokolov, "Foldover-free maps in 50 lines of code", 2021). Unlike
//! there, nodes move one at a time (Gauss-Seidel) by a safeguarded Newton step on 2 unknowns, since
//! the clean-up needs cheap local smoothing far more often than a global one.

use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::meshing::kernel::Few;
use crate::meshing::kernel::Kernel;
use crate::meshing::kernel::after;
use crate::meshing::kernel::before;
use crate::meshing::kernel::quad_of;
use crate::meshing::triangulate::NONE;

/// Weight of size against shape.
const SIZE: f64 = 0.35;

/// How far corners may be inverted before the barrier steepens, and which power of f is summed: 1
/// lets a tangle open quickly, 2 then serves the worst corners first.
#[derive(Clone, Copy)]
pub(crate) struct Phase {
    pub epsilon: f64,
    pub squared: bool,
}

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
    for _ in 0..sweeps {
        let mut any = false;
        for &node in &nodes {
            if !std::mem::take(&mut awake[node as usize]) {
                continue;
            }
            if relax(kernel, node, phase) > rest {
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
    for _ in 0..sweeps {
        let mut most = 0.0_f64;
        for &node in nodes {
            most = most.max(relax(kernel, node, phase));
        }
        if most < LOCAL_REST {
            break;
        }
    }
}

/// Raises the least scaled Jacobian around the free nodes of quads below `below`, by compass search:
/// the few worst quads are ruled by lengths that the wished ones know nothing of.
pub(crate) fn lift_worst(kernel: &mut Kernel, below: f64, sweeps: usize) {
    for _ in 0..sweeps {
        let poor = |&quad: &u32| kernel.lives(quad) && kernel.quality(quad) < below;
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
            any |= lift(kernel, node);
        }
        if !any {
            break;
        }
    }
}

/// Compass search of one node for a better least quality of its quads; true if it moved.
fn lift(kernel: &mut Kernel, node: u32) -> bool {
    let spokes = kernel.spokes(node);
    let least = |kernel: &Kernel| {
        let quality = |&side: &u32| kernel.quality(quad_of(side));
        spokes.iter().map(quality).fold(f64::INFINITY, f64::min)
    };
    let shortest = spokes.iter().map(|&side| {
        distance(
            kernel.nodes[node as usize],
            kernel.nodes[kernel.end(side) as usize],
        )
    });
    let mut step = 0.3 * shortest.fold(f64::INFINITY, f64::min);
    let start = least(kernel);
    let mut best = start;
    for _ in 0..6 {
        let at = kernel.nodes[node as usize];
        let mut to = at;
        for k in 0..8 {
            let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_4).sin_cos();
            kernel.nodes[node as usize] = [at[0] + step * cos, at[1] + step * sin];
            let quality = least(kernel);
            if quality > best {
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
fn relax(kernel: &mut Kernel, node: u32, phase: Phase) -> f64 {
    let star = Star::of(kernel, node);
    let at = kernel.nodes[node as usize];
    let local = star.expand(at, phase);
    let step = local.newton_step();
    let length = 1.0 / star.scale.sqrt();
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

/// What the energy around one node depends on.
struct Star {
    quads: Few<StarQuad>,
    scale: f64,
}

/// One quad of a star: the corner after the node, the opposite one, the one before; and the scales
/// at the first and the last of them.
struct StarQuad {
    next: Xy,
    far: Xy,
    last: Xy,
    next_scale: f64,
    last_scale: f64,
}

/// Value, gradient and Hessian (xx, xy, yy) of the energy around a node.
struct Expansion {
    value: f64,
    /// The least d.
    least: f64,
    gradient: Xy,
    hessian: [f64; 3],
}

impl Star {
    fn of(kernel: &Kernel, node: u32) -> Star {
        let mut quads = Few::new();
        let first = kernel.spoke[node as usize];
        let mut side = first;
        while side != NONE {
            let next = kernel.end(side) as usize;
            let far = kernel.end(after(side)) as usize;
            let incoming = before(side);
            let last = kernel.start(incoming) as usize;
            quads.push(StarQuad {
                next: kernel.nodes[next],
                far: kernel.nodes[far],
                last: kernel.nodes[last],
                next_scale: kernel.scale[next],
                last_scale: kernel.scale[last],
            });
            side = kernel.twin(incoming);
            if side == first {
                break;
            }
        }
        Star {
            quads,
            scale: kernel.scale[node as usize],
        }
    }

    /// The energy and the least d with the node at `at`.
    fn energy(&self, at: Xy, phase: Phase) -> (f64, f64) {
        let mut sum = 0.0;
        let mut least = f64::INFINITY;
        for quad in &self.quads {
            let own = Corner::of(
                minus(quad.next, at),
                minus(quad.last, at),
                self.scale,
                phase,
            );
            let next = Corner::of(
                minus(quad.far, quad.next),
                minus(at, quad.next),
                quad.next_scale,
                phase,
            );
            let last = Corner::of(
                minus(at, quad.last),
                minus(quad.far, quad.last),
                quad.last_scale,
                phase,
            );
            sum += own.value(phase) + next.value(phase) + last.value(phase);
            least = least.min(own.d).min(next.d).min(last.d);
        }
        (sum, least)
    }

    fn expand(&self, at: Xy, phase: Phase) -> Expansion {
        let mut sum = Expansion {
            value: 0.0,
            least: f64::INFINITY,
            gradient: [0.0; 2],
            hessian: [0.0; 3],
        };
        for quad in &self.quads {
            let (to_next, to_last) = (minus(quad.next, at), minus(quad.last, at));
            let own = Corner::of(to_next, to_last, self.scale, phase);
            let turn = [to_next[1] - to_last[1], to_last[0] - to_next[0]];
            let pull = [-to_next[0] - to_last[0], -to_next[1] - to_last[1]];
            own.expand(pull, turn, 2.0 * self.scale, self.scale, phase, &mut sum);

            let (ahead, back) = (minus(quad.far, quad.next), minus(at, quad.next));
            let next = Corner::of(ahead, back, quad.next_scale, phase);
            let s = quad.next_scale;
            next.expand(back, [-ahead[1], ahead[0]], s, s, phase, &mut sum);

            let (ahead, back) = (minus(at, quad.last), minus(quad.far, quad.last));
            let last = Corner::of(ahead, back, quad.last_scale, phase);
            let s = quad.last_scale;
            last.expand(ahead, [back[1], -back[0]], s, s, phase, &mut sum);
        }
        sum
    }
}

/// The energy f = n / chi of one corner, with what its derivatives need.
struct Corner {
    n: f64,
    d: f64,
    root: f64,
    chi: f64,
}

impl Corner {
    #[inline(always)]
    fn of(e1: Xy, e2: Xy, scale: f64, phase: Phase) -> Corner {
        let d = scale * (e1[0] * e2[1] - e1[1] * e2[0]);
        let squares = e1[0] * e1[0] + e1[1] * e1[1] + e2[0] * e2[0] + e2[1] * e2[1];
        let e2 = phase.epsilon * phase.epsilon;
        let root = (e2 + d * d).sqrt();
        // The sum cancels for large negative d; the other form does not.
        let chi = if d > 0.0 {
            0.5 * (d + root)
        } else {
            0.5 * e2 / (root - d)
        };
        Corner {
            n: 0.5 * scale * squares + 0.5 * SIZE * (1.0 + d * d),
            d,
            root,
            chi,
        }
    }

    #[inline(always)]
    fn value(&self, phase: Phase) -> f64 {
        let f = self.n / self.chi;
        if phase.squared { f * f } else { f }
    }

    #[inline(always)]
    /// Adds value and derivatives with respect to one node of the corner: n changes by
    /// scale * `pull` + SIZE d (gradient of d), curves by `curve`; d changes by scale * `turn`.
    fn expand(
        &self,
        pull: Xy,
        turn: Xy,
        curve: f64,
        scale: f64,
        phase: Phase,
        sum: &mut Expansion,
    ) {
        sum.least = sum.least.min(self.d);
        let g = [scale * turn[0], scale * turn[1]];
        let dn = [
            scale * pull[0] + SIZE * self.d * g[0],
            scale * pull[1] + SIZE * self.d * g[1],
        ];
        let inverse = 1.0 / self.chi;
        let f = self.n * inverse;
        // chi' / chi and chi'' / chi
        let slope = 1.0 / self.root;
        let narrow = phase.epsilon * slope;
        let bend = 0.5 * narrow * narrow * slope * inverse;
        let df = [
            inverse * dn[0] - f * slope * g[0],
            inverse * dn[1] - f * slope * g[1],
        ];
        let gg = SIZE * inverse + f * (2.0 * slope * slope - bend);
        let mixed = slope * inverse;
        let h = [
            curve * inverse + gg * g[0] * g[0] - 2.0 * mixed * dn[0] * g[0],
            gg * g[0] * g[1] - mixed * (dn[0] * g[1] + dn[1] * g[0]),
            curve * inverse + gg * g[1] * g[1] - 2.0 * mixed * dn[1] * g[1],
        ];
        if phase.squared {
            sum.value += f * f;
            for k in 0..2 {
                sum.gradient[k] += 2.0 * f * df[k];
            }
            sum.hessian[0] += 2.0 * (df[0] * df[0] + f * h[0]);
            sum.hessian[1] += 2.0 * (df[0] * df[1] + f * h[1]);
            sum.hessian[2] += 2.0 * (df[1] * df[1] + f * h[2]);
        } else {
            sum.value += f;
            for k in 0..2 {
                sum.gradient[k] += df[k];
            }
            for k in 0..3 {
                sum.hessian[k] += h[k];
            }
        }
    }
}

impl Expansion {
    /// Minus the gradient over the Hessian, whose smaller eigenvalue is first raised to a
    /// hundredth of the larger one, so that the step goes down.
    fn newton_step(&self) -> Xy {
        let [a, b, c] = self.hessian;
        let middle = 0.5 * (a + c);
        let radius = (0.25 * (a - c) * (a - c) + b * b).sqrt();
        let lift = (0.01 * (middle.abs() + radius) - (middle - radius)).max(0.0);
        let (a, c) = (a + lift, c + lift);
        let determinant = a * c - b * b;
        let [x, y] = self.gradient;
        if determinant > 0.0 {
            [(b * y - c * x) / determinant, (b * x - a * y) / determinant]
        } else {
            [0.0; 2]
        }
    }
}

fn minus(a: Xy, b: Xy) -> Xy {
    [a[0] - b[0], a[1] - b[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A star of three quads around a node near the origin, one of them inverted.
    fn star() -> Star {
        let quad = |next: Xy, far: Xy, last: Xy| StarQuad {
            next,
            far,
            last,
            next_scale: 1.1,
            last_scale: 0.8,
        };
        let mut quads = Few::new();
        quads.push(quad([1.0, 0.1], [0.9, 1.2], [-0.1, 1.0]));
        quads.push(quad([-0.1, 1.0], [-1.0, 0.9], [-0.8, -0.7]));
        quads.push(quad([-0.8, -0.7], [0.2, -0.1], [1.0, 0.1]));
        Star { quads, scale: 0.9 }
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let star = star();
        let (at, step) = ([0.05, -0.02], 1e-4);
        for phase in [OPEN, PERFECT] {
            let f = |x: f64, y: f64| star.energy([at[0] + x * step, at[1] + y * step], phase).0;
            let expansion = star.expand(at, phase);
            let slope = [f(1.0, 0.0) - f(-1.0, 0.0), f(0.0, 1.0) - f(0.0, -1.0)];
            let middle = 2.0 * f(0.0, 0.0);
            let bend = [
                f(1.0, 0.0) + f(-1.0, 0.0) - middle,
                0.25 * (f(1.0, 1.0) + f(-1.0, -1.0) - f(1.0, -1.0) - f(-1.0, 1.0)),
                f(0.0, 1.0) + f(0.0, -1.0) - middle,
            ];
            let close = |a: f64, b: f64| (a - b).abs() < 1e-3 * (1.0 + a.abs());
            for k in 0..2 {
                assert!(close(expansion.gradient[k], slope[k] / (2.0 * step)));
            }
            for k in 0..3 {
                assert!(close(expansion.hessian[k], bend[k] / (step * step)));
            }
        }
    }
}
