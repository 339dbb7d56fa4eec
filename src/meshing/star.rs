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
//! which edges move with v differs. [`LANES`] quads are computed side by side: a third of the
//! meshing is spent here.
//!
//! Places are relative to the node, in its wished lengths, so f32 is exact enough: where it rounds
//! (1e-7), the shortest step that `smooth` takes (1e-3) still lowers the energy by some 1e-5.

use crate::geometry::point::Xy;
use crate::meshing::kernel::Kernel;
use crate::meshing::kernel::after;
use crate::meshing::kernel::before;
use crate::meshing::triangulate::NONE;

/// Weight of size against shape.
const SIZE: f32 = 0.35;

/// Quads computed side by side; plain arrays that the compiler turns into vector instructions. Most
/// nodes have four.
const LANES: usize = 4;

type Lanes = [f32; LANES];

/// A place relative to the node, in wished lengths around it.
type Place = [f32; 2];

/// How far corners may be inverted before the barrier steepens, and which power of f is summed: 1
/// lets a tangle open quickly, 2 then serves the worst corners first.
#[derive(Clone, Copy)]
pub(crate) struct Phase {
    pub epsilon: f32,
    pub squared: bool,
}

/// What the energy around one node depends on. Reused from node to node.
#[derive(Default)]
pub(crate) struct Star {
    batches: Vec<Quads>,
    /// Number of quads in use.
    count: usize,
}

/// Some quads v a b c, v being the node: wedges v a c, v a b and v b c.
#[derive(Clone, Copy, Default)]
struct Quads {
    a: [Lanes; 2],
    b: [Lanes; 2],
    c: [Lanes; 2],
    /// Scales of the corners at a and c; that of v is 1.
    at_a: Lanes,
    at_c: Lanes,
    /// |a - b|^2 and |b - c|^2.
    ab: Lanes,
    bc: Lanes,
    /// 1, or 0 for a lane that only fills the batch.
    weight: Lanes,
}

/// Some wedges v x y: with s the scale of the corner, d = s (x - v) x (y - v), and |e1|^2 + |e2|^2
/// is s times `rest` and what moves of |x - v|^2 and |y - v|^2.
struct Wedges<'a> {
    x: &'a [Lanes; 2],
    y: &'a [Lanes; 2],
    scale: &'a Lanes,
    rest: &'a Lanes,
    weight: &'a Lanes,
}

/// Value, gradient and Hessian (xx, xy, yy) of the energy around a node.
pub(crate) struct Expansion {
    pub value: f32,
    /// The least d.
    pub least: f32,
    pub gradient: [f32; 2],
    pub hessian: [f32; 3],
}

impl Star {
    /// Collects the quads of `node`, around which the wished length is 1 / `per_m`.
    pub fn gather(&mut self, kernel: &Kernel, node: u32, per_m: f64) {
        self.count = 0;
        let at = kernel.nodes[node as usize];
        let unit = 1.0 / kernel.scale[node as usize];
        let place = |node: u32| {
            let p = kernel.nodes[node as usize];
            [
                ((p[0] - at[0]) * per_m) as f32,
                ((p[1] - at[1]) * per_m) as f32,
            ]
        };
        let first = kernel.spoke[node as usize];
        if first == NONE {
            return;
        }
        let mut side = first;
        let (mut next, mut a) = (kernel.end(side), place(kernel.end(side)));
        let mut at_a = (kernel.scale[next as usize] * unit) as f32;
        loop {
            let incoming = before(side);
            next = kernel.start(incoming);
            let (b, c) = (place(kernel.end(after(side))), place(next));
            let at_c = (kernel.scale[next as usize] * unit) as f32;
            self.push([a, b, c], [at_a, at_c]);
            side = kernel.twin(incoming);
            if side == first || side == NONE {
                break;
            }
            (a, at_a) = (c, at_c);
        }
        self.fill_up();
    }

    fn push(&mut self, [a, b, c]: [Place; 3], [at_a, at_c]: [f32; 2]) {
        let (batch, lane) = (self.count / LANES, self.count % LANES);
        if batch == self.batches.len() {
            self.batches.push(Quads::default());
        }
        let quads = &mut self.batches[batch];
        for axis in 0..2 {
            quads.a[axis][lane] = a[axis];
            quads.b[axis][lane] = b[axis];
            quads.c[axis][lane] = c[axis];
        }
        quads.at_a[lane] = at_a;
        quads.at_c[lane] = at_c;
        quads.ab[lane] = square(a, b);
        quads.bc[lane] = square(b, c);
        quads.weight[lane] = 1.0;
        self.count += 1;
    }

    /// A copy of a true quad is harmless where the least d is sought.
    fn fill_up(&mut self) {
        for k in self.count..self.count.next_multiple_of(LANES) {
            let (quads, lane) = (&mut self.batches[k / LANES], k % LANES);
            for axis in 0..2 {
                quads.a[axis][lane] = quads.a[axis][0];
                quads.b[axis][lane] = quads.b[axis][0];
                quads.c[axis][lane] = quads.c[axis][0];
            }
            quads.at_a[lane] = quads.at_a[0];
            quads.at_c[lane] = quads.at_c[0];
            quads.ab[lane] = quads.ab[0];
            quads.bc[lane] = quads.bc[0];
            quads.weight[lane] = 0.0;
        }
    }

    fn used(&self) -> &[Quads] {
        &self.batches[..self.count.div_ceil(LANES)]
    }

    /// The energy and the least d with the node moved to `at`.
    pub fn energy(&self, at: Place, phase: Phase) -> (f32, f32) {
        let mut sums = [[0.0; LANES], [f32::INFINITY; LANES]];
        for quads in self.used() {
            quads.energy(at, phase, &mut sums);
        }
        (total(&sums[0]), least_of(&sums[1]))
    }

    /// Value and derivatives with the node where it is.
    pub fn expand(&self, phase: Phase) -> Expansion {
        let mut sums = [[0.0; LANES]; 7];
        sums[6] = [f32::INFINITY; LANES];
        for quads in self.used() {
            quads.expand(phase, &mut sums);
        }
        let [value, gx, gy, hxx, hxy, hyy, _] = sums.map(|lanes| total(&lanes));
        Expansion {
            value,
            least: least_of(&sums[6]),
            gradient: [gx, gy],
            hessian: [hxx, hxy, hyy],
        }
    }
}

impl Quads {
    /// Adds the value to `sums`, lane by lane, and lowers the least d there. Not inlined, as the
    /// compiler finds vectors by what is stored in memory.
    #[inline(never)]
    fn energy(&self, at: Place, phase: Phase, sums: &mut [Lanes; 2]) {
        let [own, next, last] = self.wedges();
        own.energy::<true, true>(at, phase, sums);
        next.energy::<true, false>(at, phase, sums);
        last.energy::<false, true>(at, phase, sums);
    }

    /// The same with gradient (2) and Hessian (3) before the least d.
    #[inline(never)]
    fn expand(&self, phase: Phase, sums: &mut [Lanes; 7]) {
        let [own, next, last] = self.wedges();
        own.expand::<true, true>(phase, sums);
        next.expand::<true, false>(phase, sums);
        last.expand::<false, true>(phase, sums);
    }

    #[inline(always)]
    fn wedges(&self) -> [Wedges<'_>; 3] {
        let wedges = |x, y, scale, rest| Wedges {
            x,
            y,
            scale,
            rest,
            weight: &self.weight,
        };
        [
            wedges(&self.a, &self.c, &[1.0; LANES], &[0.0; LANES]),
            wedges(&self.a, &self.b, &self.at_a, &self.ab),
            wedges(&self.b, &self.c, &self.at_c, &self.bc),
        ]
    }
}

impl Wedges<'_> {
    /// See [`Quads::energy`]. `X` and `Y`: which edges move with the node.
    #[inline(always)]
    fn energy<const X: bool, const Y: bool>(&self, at: Place, phase: Phase, sums: &mut [Lanes; 2]) {
        let narrow = phase.epsilon * phase.epsilon;
        let power = if phase.squared { 1.0 } else { 0.0 };
        for k in 0..LANES {
            let (ax, ay) = (self.x[0][k] - at[0], self.x[1][k] - at[1]);
            let (bx, by) = (self.y[0][k] - at[0], self.y[1][k] - at[1]);
            let d = self.scale[k] * (ax * by - ay * bx);
            let mut squares = self.rest[k];
            squares += if X { ax * ax + ay * ay } else { 0.0 };
            squares += if Y { bx * bx + by * by } else { 0.0 };
            let n = 0.5 * self.scale[k] * squares + 0.5 * SIZE * (1.0 + d * d);
            let f = n * inverse_chi(d, (narrow + d * d).sqrt(), narrow);
            sums[0][k] += self.weight[k] * f * (1.0 - power + power * f);
            sums[1][k] = if d < sums[1][k] { d } else { sums[1][k] };
        }
    }

    /// See [`Quads::expand`].
    #[inline(always)]
    fn expand<const X: bool, const Y: bool>(&self, phase: Phase, sums: &mut [Lanes; 7]) {
        let narrow = phase.epsilon * phase.epsilon;
        let power = if phase.squared { 1.0 } else { 0.0 };
        for k in 0..LANES {
            let (ax, ay) = (self.x[0][k], self.x[1][k]);
            let (bx, by) = (self.y[0][k], self.y[1][k]);
            let s = self.scale[k];
            let d = s * (ax * by - ay * bx);
            let mut squares = self.rest[k];
            squares += if X { ax * ax + ay * ay } else { 0.0 };
            squares += if Y { bx * bx + by * by } else { 0.0 };
            let n = 0.5 * s * squares + 0.5 * SIZE * (1.0 + d * d);
            let root = (narrow + d * d).sqrt();
            let inverse = inverse_chi(d, root, narrow);
            let f = n * inverse;
            // chi' / chi and chi'' / chi.
            let slope = 1.0 / root;
            let bend = 0.5 * narrow * slope * slope * slope * inverse;
            // Gradients of d, n and f; curvature of n.
            let (gx, gy) = (s * (ay - by), s * (bx - ax));
            let (pull_x, pull_y) = match (X, Y) {
                (true, true) => (ax + bx, ay + by),
                (true, false) => (ax, ay),
                _ => (bx, by),
            };
            let nx = SIZE * d * gx - s * pull_x;
            let ny = SIZE * d * gy - s * pull_y;
            let (fx, fy) = (inverse * nx - f * slope * gx, inverse * ny - f * slope * gy);
            let curve = if X && Y { 2.0 } else { 1.0 } * s * inverse;
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
            sums[6][k] = if d < sums[6][k] { d } else { sums[6][k] };
        }
    }
}

/// 1 / chi(d), given root = sqrt(eps^2 + d^2) and eps^2; without cancellation for d far below 0.
#[inline(always)]
fn inverse_chi(d: f32, root: f32, narrow: f32) -> f32 {
    let sum = root + d.abs();
    let up = if d > 0.0 { 2.0 } else { 2.0 * sum };
    let down = if d > 0.0 { sum } else { narrow };
    up / down
}

fn total(lanes: &Lanes) -> f32 {
    (lanes[0] + lanes[1]) + (lanes[2] + lanes[3])
}

fn least_of(lanes: &Lanes) -> f32 {
    lanes.iter().copied().fold(f32::INFINITY, f32::min)
}

fn square(a: Place, b: Place) -> f32 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    dx * dx + dy * dy
}

impl Expansion {
    /// Minus the gradient over the Hessian, whose smaller eigenvalue is first raised to a
    /// hundredth of the larger one, so that the step goes down.
    pub fn newton_step(&self) -> Xy {
        let [a, b, c] = self.hessian.map(f64::from);
        let middle = 0.5 * (a + c);
        let radius = (0.25 * (a - c) * (a - c) + b * b).sqrt();
        let lift = (0.01 * (middle.abs() + radius) - (middle - radius)).max(0.0);
        let (a, c) = (a + lift, c + lift);
        let determinant = a * c - b * b;
        let [x, y] = self.gradient.map(f64::from);
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

    const CORNERS: [[Place; 3]; 3] = [
        [[1.0, 0.1], [0.9, 1.2], [-0.1, 1.0]],
        [[-0.1, 1.0], [-1.0, 0.9], [-0.8, -0.7]],
        [[-0.8, -0.7], [0.2, -0.1], [1.0, 0.1]],
    ];
    /// Scales of the corners after and before the node's own.
    const SCALES: [f32; 2] = [1.1, 0.8];

    /// A star of three quads around a node near the origin, one of them inverted.
    fn star() -> Star {
        let mut star = Star::default();
        for corners in CORNERS {
            star.push(corners, SCALES);
        }
        star.fill_up();
        star
    }

    /// The slow twin: the energy by its formula, in double precision.
    fn energy(v: Xy, phase: Phase) -> f64 {
        let corner = |at: Xy, next: Xy, last: Xy, scale: f32| {
            let edge = |p: Xy| [p[0] - at[0], p[1] - at[1]].map(|it| it * f64::from(scale).sqrt());
            let (a, b) = (edge(next), edge(last));
            let d = a[0] * b[1] - a[1] * b[0];
            let squares = a[0] * a[0] + a[1] * a[1] + b[0] * b[0] + b[1] * b[1];
            let epsilon = f64::from(phase.epsilon);
            let chi = 0.5 * (d + (epsilon * epsilon + d * d).sqrt());
            let f = 0.5 * (squares + f64::from(SIZE) * (1.0 + d * d)) / chi;
            if phase.squared { f * f } else { f }
        };
        let corners = CORNERS.map(|it| it.map(|place| place.map(f64::from)));
        let quad = |[a, b, c]: [Xy; 3]| {
            corner(v, a, c, 1.0) + corner(a, b, v, SCALES[0]) + corner(c, v, b, SCALES[1])
        };
        corners.into_iter().map(quad).sum()
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let star = star();
        let step = 1e-4;
        for (epsilon, squared) in [(0.3, false), (0.05, true)] {
            let phase = Phase { epsilon, squared };
            let f = |x: f64, y: f64| energy([x * step, y * step], phase);
            let expansion = star.expand(phase);
            let slope = [f(1.0, 0.0) - f(-1.0, 0.0), f(0.0, 1.0) - f(0.0, -1.0)];
            let middle = 2.0 * f(0.0, 0.0);
            let bend = [
                f(1.0, 0.0) + f(-1.0, 0.0) - middle,
                0.25 * (f(1.0, 1.0) + f(-1.0, -1.0) - f(1.0, -1.0) - f(-1.0, 1.0)),
                f(0.0, 1.0) + f(0.0, -1.0) - middle,
            ];
            let close = |a: f32, b: f64| (f64::from(a) - b).abs() < 1e-3 * (1.0 + b.abs());
            assert!(close(expansion.value, 0.5 * middle));
            let elsewhere = [0.05_f32, -0.02];
            let there = energy(elsewhere.map(f64::from), phase);
            assert!(close(star.energy(elsewhere, phase).0, there));
            for k in 0..2 {
                assert!(close(expansion.gradient[k], slope[k] / (2.0 * step)));
            }
            for k in 0..3 {
                assert!(close(expansion.hessian[k], bend[k] / (step * step)));
            }
        }
    }
}
