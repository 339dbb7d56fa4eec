//! A mesh while it is laid: nodes, quads and the few ways to add some of them.

use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::geometry::quad::scaled_jacobian;
use crate::meshing::draft::Draft;
use crate::meshing::patch::Method;
use crate::meshing::visits::Visits;

/// Visits first, then the interior nodes in the order in which they were laid.
#[derive(Clone, Debug)]
pub(crate) struct Sheet {
    /// Positions, metres.
    pub nodes: Vec<Xy>,
    /// Quads, counter-clockwise.
    pub quads: Vec<[u32; 4]>,
}

/// How far a sheet has come: what is laid later can be measured, relaxed or taken back.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mark {
    nodes: usize,
    quads: usize,
}

/// Shape of some quads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shape {
    /// Least scaled Jacobian.
    pub least: f64,
    sum: f64,
    count: usize,
}

impl Shape {
    /// No quads: perfect.
    pub const NONE: Shape = Shape {
        least: 1.0,
        sum: 0.0,
        count: 0,
    };

    /// Mean scaled Jacobian.
    pub fn mean(&self) -> f64 {
        if self.count > 0 {
            self.sum / self.count as f64
        } else {
            1.0
        }
    }

    /// The shape of these quads and those together.
    pub fn with(self, other: Shape) -> Shape {
        Shape {
            least: self.least.min(other.least),
            sum: self.sum + other.sum,
            count: self.count + other.count,
        }
    }
}

impl Sheet {
    /// No quads yet.
    pub fn over(visits: &Visits) -> Sheet {
        Sheet {
            nodes: visits.nodes.clone(),
            quads: Vec::new(),
        }
    }

    /// Hands the quads on.
    pub fn into_draft(self, visits: usize, method: Method) -> Draft {
        Draft {
            nodes: self.nodes,
            visits,
            quads: self.quads,
            settled: 0,
            method,
        }
    }

    /// A new node.
    pub fn node(&mut self, at: Xy) -> u32 {
        self.nodes.push(at);
        self.nodes.len() as u32 - 1
    }

    /// Nodes on the straight line from `from` to `to`, both included, in `count` equal steps.
    pub fn line(&mut self, from: u32, to: u32, count: usize) -> Vec<u32> {
        let (a, b) = (self.nodes[from as usize], self.nodes[to as usize]);
        let mut line = Vec::with_capacity(count + 1);
        line.push(from);
        for step in 1..count {
            let t = step as f64 / count as f64;
            line.push(self.node([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]));
        }
        line.push(to);
        line
    }

    /// Where the sheet stands now.
    pub fn mark(&self) -> Mark {
        Mark {
            nodes: self.nodes.len(),
            quads: self.quads.len(),
        }
    }

    /// Takes back all that was laid since `mark`.
    pub fn undo(&mut self, mark: Mark) {
        self.nodes.truncate(mark.nodes);
        self.quads.truncate(mark.quads);
    }

    /// The corners of a quad.
    pub fn corners(&self, quad: [u32; 4]) -> [Xy; 4] {
        quad.map(|node| self.nodes[node as usize])
    }

    /// Shape of the quads laid since `mark`; perfect if there are none.
    pub fn shape(&self, mark: Mark) -> Shape {
        let mut shape = Shape::NONE;
        for &quad in &self.quads[mark.quads..] {
            let jacobian = scaled_jacobian(&self.corners(quad));
            shape.least = shape.least.min(jacobian);
            shape.sum += jacobian;
            shape.count += 1;
        }
        shape
    }

    /// Laplacian sweeps over the nodes laid since `mark`, which must all be inside what was laid
    /// since: every edge at such a node then occurs in two quads, so plain sums weigh all alike.
    pub fn relax(&mut self, mark: Mark, sweeps: usize) {
        let free = self.nodes.len() - mark.nodes;
        let mut sum = vec![[0.0, 0.0, 0.0]; free];
        for _ in 0..sweeps {
            sum.fill([0.0; 3]);
            for quad in &self.quads[mark.quads..] {
                for k in 0..4 {
                    let at = quad[k] as usize;
                    if at >= mark.nodes {
                        for neighbour in [quad[(k + 1) % 4], quad[(k + 3) % 4]] {
                            let p = self.nodes[neighbour as usize];
                            let s = &mut sum[at - mark.nodes];
                            *s = [s[0] + p[0], s[1] + p[1], s[2] + 1.0];
                        }
                    }
                }
            }
            for (node, s) in self.nodes[mark.nodes..].iter_mut().zip(&sum) {
                if s[2] > 0.0 {
                    *node = [s[0] / s[2], s[1] / s[2]];
                }
            }
        }
    }

    /// A grid of quads between four sides by transfinite interpolation (Gordon and Hall 1973), the
    /// parameters blended from the arc lengths of opposite sides (Soni 1985). `south` and `north`
    /// run alike, and so do `west` and `east`; counter-clockwise is south, east, north, west.
    pub fn grid(&mut self, south: &[u32], east: &[u32], north: &[u32], west: &[u32]) {
        let (m, n) = (south.len() - 1, west.len() - 1);
        debug_assert!(m >= 1 && n >= 1 && north.len() == m + 1 && east.len() == n + 1);
        let along = [south, north, west, east].map(|side| self.arc(side));
        let mut row = south.to_vec();
        let mut next = Vec::with_capacity(m + 1);
        self.nodes.reserve((m - 1) * (n - 1));
        self.quads.reserve(m * n);
        for j in 1..=n {
            next.clear();
            for i in 0..=m {
                next.push(match (i, j) {
                    (_, j) if j == n => north[i],
                    (0, _) => west[j],
                    (i, _) if i == m => east[j],
                    _ => {
                        let at = self.transfinite([south, north, west, east], &along, i, j);
                        self.node(at)
                    }
                });
            }
            for i in 0..m {
                self.quads.push([row[i], row[i + 1], next[i + 1], next[i]]);
            }
            std::mem::swap(&mut row, &mut next);
        }
    }

    /// Position of grid node `(i, j)` between the sides south, north, west, east.
    fn transfinite(&self, sides: [&[u32]; 4], along: &[Vec<f64>; 4], i: usize, j: usize) -> Xy {
        let (s, n, w, e) = (along[0][i], along[1][i], along[2][j], along[3][j]);
        // Where the straight line from s to n meets that from w to e in the unit square.
        let u = (s + w * (n - s)) / (1.0 - (n - s) * (e - w));
        let v = w + u * (e - w);
        let at = |side: usize, k: usize| self.nodes[sides[side][k] as usize];
        let (m, last) = (sides[0].len() - 1, sides[2].len() - 1);
        std::array::from_fn(|axis| {
            let sides_blend = (1.0 - v) * at(0, i)[axis]
                + v * at(1, i)[axis]
                + (1.0 - u) * at(2, j)[axis]
                + u * at(3, j)[axis];
            let corners_blend = (1.0 - u) * ((1.0 - v) * at(0, 0)[axis] + v * at(2, last)[axis])
                + u * ((1.0 - v) * at(0, m)[axis] + v * at(3, last)[axis]);
            sides_blend - corners_blend
        })
    }

    /// Arc length from the first node to each, as a share of the whole.
    fn arc(&self, side: &[u32]) -> Vec<f64> {
        let mut along = vec![0.0];
        let mut sum = 0.0;
        for pair in side.windows(2) {
            sum += distance(self.nodes[pair[0] as usize], self.nodes[pair[1] as usize]);
            along.push(sum);
        }
        along.iter().map(|length| length / sum).collect()
    }
}
