//! The energy of the smoothing as a function of one node: value, gradient, Hessian.
//!
//! Per corner with edges e1, e2 scaled by the wished length, and d = e1 x e2:
//!
//! f = [(|e1|^2 + |e2|^2) / 2 + .35 (1 + d^2) / 2] / chi(d),  chi = (d + sqrt(eps^2 + d^2)) / 2
//!
//! The first term is least (1) for a right angle between equal edges, the second for a corner of
//! the wished size. chi tends to d for good corners and stays positive for inverted ones, so the
//! energy is smooth everywhere and the optimiser can start from a tangle (Garanzha, Kaporin,
//! Kudryavtseva, Protais, Ray, Sokolov, "Foldover-free maps in 50 lines of code", 2021).
//!
//! A node v takes part in three corners of each of its quads: its own, the next and the last. All
//! three are one formula, as d is twice the area of a triangle v x y in each (*wedge*), and only
//! which edges move with v differs. Wedges are computed [`LANES`] at a time: half of the finish is
//! spent here.

use crate::geometry::point::Xy;
use crate::meshing::kernel::Kernel;
use crate::meshing::kernel::after;
use crate::meshing::kernel::before;
use crate::meshing::triangulate::NONE;

/// Weight of size against shape.
const SIZE: f64 = 0.35;

/// Wedges computed side by side; plain arrays that the compiler turns into vector instructions.
const LANES: usize = 4;

type Lanes = [f64; LANES];

/// How far corners may be inverted before the barrier steepens, and which power of f is summed: 1
/// lets a tangle open quickly, 2 then serves the worst corners first.
#[derive(Clone, Copy)]
pub(crate) struct Phase {
    pub epsilon: f64,
    pub squared: bool,
}

/// What the energy around one node depends on. Reused from node to node.
#[derive(Default)]
pub(crate) struct Star {
    batches: Vec<Wedges>,
    /// Number of wedges in use.
    count: usize,
}

/// Some wedges v x y, v being the node: with s the scale of the corner,
/// d = s (x - v) x (y - v) and |e1|^2 + |e2|^2 = s (pull_x |x - v|^2 + pull_y |y - v|^2 + rest).
#[derive(Clone, Copy, Default)]
struct Wedges {
    x: [Lanes; 2],
    y: [Lanes; 2],
    scale: Lanes,
    pull_x: Lanes,
    pull_y: Lanes,
    rest: Lanes,
    /// 1, or 0 for a lane that only fills the batch.
    weight: Lanes,
}

/// Value, gradient and Hessian (xx, xy, yy) of the energy around a node.
pub(crate) struct Expansion {
    pub value: f64,
    /// The least d.
    pub least: f64,
    pub gradient: Xy,
    pub hessian: [f64; 3],
}

impl Star {
    /// Collects the wedges of `node`.
    pub fn gather(&mut self, kernel: &Kernel, node: u32) {
        self.count = 0;
        let scale = kernel.scale[node as usize];
        let first = kernel.spoke[node as usize];
        let mut side = first;
        while side != NONE {
            let incoming = before(side);
            let [next, far, last] = [
                kernel.end(side),
                kernel.end(after(side)),
                kernel.start(incoming),
            ];
            let [a, b, c] = [next, far, last].map(|node| kernel.nodes[node as usize]);
            self.push(a, c, scale, [1.0, 1.0, 0.0]);
            self.push(a, b, kernel.scale[next as usize], [1.0, 0.0, square(a, b)]);
            self.push(b, c, kernel.scale[last as usize], [0.0, 1.0, square(b, c)]);
            side = kernel.twin(incoming);
            if side == first {
                break;
            }
        }
        // A copy of a true wedge is harmless where the least d is sought.
        for k in self.count..self.count.next_multiple_of(LANES) {
            let (batch, lane) = (&mut self.batches[k / LANES], k % LANES);
            for axis in 0..2 {
                batch.x[axis][lane] = batch.x[axis][0];
                batch.y[axis][lane] = batch.y[axis][0];
            }
            batch.scale[lane] = batch.scale[0];
            batch.weight[lane] = 0.0;
        }
    }

    fn push(&mut self, x: Xy, y: Xy, scale: f64, [pull_x, pull_y, rest]: [f64; 3]) {
        let (batch, lane) = (self.count / LANES, self.count % LANES);
        if batch == self.batches.len() {
            self.batches.push(Wedges::default());
        }
        let wedges = &mut self.batches[batch];
        for axis in 0..2 {
            wedges.x[axis][lane] = x[axis];
            wedges.y[axis][lane] = y[axis];
        }
        wedges.scale[lane] = scale;
        wedges.pull_x[lane] = pull_x;
        wedges.pull_y[lane] = pull_y;
        wedges.rest[lane] = rest;
        wedges.weight[lane] = 1.0;
        self.count += 1;
    }

    fn used(&self) -> &[Wedges] {
        &self.batches[..self.count.div_ceil(LANES)]
    }

    /// The energy and the least d with the node at `at`.
    pub fn energy(&self, at: Xy, phase: Phase) -> (f64, f64) {
        let mut sum = [0.0; LANES];
        let mut least = [f64::INFINITY; LANES];
        for wedges in self.used() {
            wedges.energy(at, phase, &mut sum, &mut least);
        }
        (
            total(&sum),
            least.iter().copied().fold(f64::INFINITY, f64::min),
        )
    }

    /// Value and derivatives with the node at `at`.
    pub fn expand(&self, at: Xy, phase: Phase) -> Expansion {
        let mut sums = [[0.0; LANES]; 6];
        let mut least = [f64::INFINITY; LANES];
        for wedges in self.used() {
            wedges.expand(at, phase, &mut sums, &mut least);
        }
        let [value, gx, gy, hxx, hxy, hyy] = sums.map(|lanes| total(&lanes));
        Expansion {
            value,
            least: least.iter().copied().fold(f64::INFINITY, f64::min),
            gradient: [gx, gy],
            hessian: [hxx, hxy, hyy],
        }
    }
}

impl Wedges {
    #[inline(always)]
    fn energy(&self, at: Xy, phase: Phase, sum: &mut Lanes, least: &mut Lanes) {
        let narrow = phase.epsilon * phase.epsilon;
        let power = if phase.squared { 1.0 } else { 0.0 };
        for k in 0..LANES {
            let (ax, ay) = (self.x[0][k] - at[0], self.x[1][k] - at[1]);
            let (bx, by) = (self.y[0][k] - at[0], self.y[1][k] - at[1]);
            let d = self.scale[k] * (ax * by - ay * bx);
            let squares = self.pull_x[k] * (ax * ax + ay * ay)
                + self.pull_y[k] * (bx * bx + by * by)
                + self.rest[k];
            let n = 0.5 * self.scale[k] * squares + 0.5 * SIZE * (1.0 + d * d);
            let f = n * inverse_chi(d, (narrow + d * d).sqrt(), narrow);
            sum[k] += self.weight[k] * f * (1.0 - power + power * f);
            least[k] = if d < least[k] { d } else { least[k] };
        }
    }

    /// Adds value, gradient (2) and Hessian (3) to `sums`, lane by lane.
    #[inline(always)]
    fn expand(&self, at: Xy, phase: Phase, sums: &mut [Lanes; 6], least: &mut Lanes) {
        let narrow = phase.epsilon * phase.epsilon;
        let power = if phase.squared { 1.0 } else { 0.0 };
        for k in 0..LANES {
            let (ax, ay) = (self.x[0][k] - at[0], self.x[1][k] - at[1]);
            let (bx, by) = (self.y[0][k] - at[0], self.y[1][k] - at[1]);
            let (s, px, py) = (self.scale[k], self.pull_x[k], self.pull_y[k]);
            let d = s * (ax * by - ay * bx);
            let squares = px * (ax * ax + ay * ay) + py * (bx * bx + by * by) + self.rest[k];
            let n = 0.5 * s * squares + 0.5 * SIZE * (1.0 + d * d);
            let root = (narrow + d * d).sqrt();
            let inverse = inverse_chi(d, root, narrow);
            let f = n * inverse;
            // chi' / chi and chi'' / chi.
            let slope = 1.0 / root;
            let bend = 0.5 * narrow * slope * slope * slope * inverse;
            // Gradients of d, n and f; curvature of n.
            let (gx, gy) = (s * (ay - by), s * (bx - ax));
            let nx = SIZE * d * gx - s * (px * ax + py * bx);
            let ny = SIZE * d * gy - s * (px * ay + py * by);
            let (fx, fy) = (inverse * nx - f * slope * gx, inverse * ny - f * slope * gy);
            let curve = s * (px + py) * inverse;
            let gg = SIZE * inverse + f * (2.0 * slope * slope - bend);
            let mixed = slope * inverse;
            let hxx = curve + gg * gx * gx - 2.0 * mixed * nx * gx;
            let hxy = gg * gx * gy - mixed * (nx * gy + ny * gx);
            let hyy = curve + gg * gy * gy - 2.0 * mixed * ny * gy;
            // The chain rule for f or f^2.
            let w = self.weight[k];
            let outer = w * (1.0 - power + 2.0 * power * f);
            let cross = 2.0 * power * w;
            sums[0][k] += w * f * (1.0 - power + power * f);
            sums[1][k] += outer * fx;
            sums[2][k] += outer * fy;
            sums[3][k] += outer * hxx + cross * fx * fx;
            sums[4][k] += outer * hxy + cross * fx * fy;
            sums[5][k] += outer * hyy + cross * fy * fy;
            least[k] = if d < least[k] { d } else { least[k] };
        }
    }
}

/// 1 / chi(d), given root = sqrt(eps^2 + d^2) and eps^2; without cancellation for d far below 0.
#[inline(always)]
fn inverse_chi(d: f64, root: f64, narrow: f64) -> f64 {
    let sum = root + d.abs();
    let up = if d > 0.0 { 2.0 } else { 2.0 * sum };
    let down = if d > 0.0 { sum } else { narrow };
    up / down
}

fn total(lanes: &Lanes) -> f64 {
    (lanes[0] + lanes[1]) + (lanes[2] + lanes[3])
}

fn square(a: Xy, b: Xy) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    dx * dx + dy * dy
}

impl Expansion {
    /// Minus the gradient over the Hessian, whose smaller eigenvalue is first raised to a
    /// hundredth of the larger one, so that the step goes down.
    pub fn newton_step(&self) -> Xy {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A star of three quads around a node near the origin, one of them inverted.
    fn star() -> Star {
        let mut star = Star::default();
        let corners = [
            [[1.0, 0.1], [0.9, 1.2], [-0.1, 1.0]],
            [[-0.1, 1.0], [-1.0, 0.9], [-0.8, -0.7]],
            [[-0.8, -0.7], [0.2, -0.1], [1.0, 0.1]],
        ];
        for [a, b, c] in corners {
            star.push(a, c, 0.9, [1.0, 1.0, 0.0]);
            star.push(a, b, 1.1, [1.0, 0.0, square(a, b)]);
            star.push(b, c, 0.8, [0.0, 1.0, square(b, c)]);
        }
        star
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let star = star();
        let (at, step) = ([0.05, -0.02], 1e-4);
        for (epsilon, squared) in [(0.3, false), (0.05, true)] {
            let phase = Phase { epsilon, squared };
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
