//! A set of edges between triangles in which every triangle has one or three: a way to all quads.
//!
//! Such a set (a T-join of the dual graph, T = all triangles) exists if and only if the number of
//! triangles is even. A triangle with one edge in it pairs with the neighbour there. A triangle
//! with three is cut into three thirds at its centroid, and each third pairs across its own edge.
//! So a perfect pairing is the special case without threes, and a join always becomes quads.

use crate::geometry::point::Xy;
use crate::meshing::draft::Draft;
use crate::meshing::patch::Method;
use crate::meshing::triangulate::NONE;
use crate::meshing::triangulate::Triangles;

/// For each triangle and each of its edges: true if the pair across that edge is in the join.
/// Symmetric: both triangles of an edge say the same.
pub(crate) struct Join<'a> {
    pub triangles: &'a Triangles,
    pub joined: Vec<[bool; 3]>,
}

/// Edge `k` of triangle `t`, from corner `k` to corner `k + 1`.
pub(crate) type Side = (u32, usize);

impl Join<'_> {
    /// The empty set: not a join yet.
    pub fn empty(triangles: &Triangles) -> Join<'_> {
        Join {
            triangles,
            joined: vec![[false; 3]; triangles.corners.len()],
        }
    }

    /// The join inside a spanning tree of the dual graph: exists for any even number of triangles,
    /// and is found in one pass from the leaves to the root.
    pub fn along_tree(triangles: &Triangles) -> Join<'_> {
        let mut join = Join::empty(triangles);
        let mut parent: Vec<Option<Side>> = vec![None; triangles.corners.len()];
        let mut order = vec![0_u32];
        let mut seen = vec![false; triangles.corners.len()];
        seen[0] = true;
        let mut head = 0;
        while head < order.len() {
            let t = order[head];
            head += 1;
            for k in 0..3 {
                let next = triangles.neighbours[t as usize][k];
                if next != NONE && !seen[next as usize] {
                    seen[next as usize] = true;
                    parent[next as usize] = Some((t, k));
                    order.push(next);
                }
            }
        }
        debug_assert_eq!(
            order.len(),
            triangles.corners.len(),
            "one connected sub-domain"
        );
        for &t in order.iter().rev() {
            if join.degree(t).is_multiple_of(2)
                && let Some(side) = parent[t as usize]
            {
                join.toggle(side);
            }
        }
        join
    }

    /// Number of edges of triangle `t` in the join.
    pub fn degree(&self, t: u32) -> usize {
        self.joined[t as usize]
            .iter()
            .filter(|&&joined| joined)
            .count()
    }

    /// The same edge seen from the other side.
    pub fn twin(&self, (t, k): Side) -> Side {
        let other = self.triangles.neighbours[t as usize][k];
        let start = self.triangles.corners[t as usize][(k + 1) % 3];
        let places = self.triangles.corners[other as usize];
        let back =
            |&j: &usize| places[j] == start && self.triangles.neighbours[other as usize][j] == t;
        (other, (0..3).find(back).expect("neighbours are mutual"))
    }

    /// Puts the edge in or takes it out.
    pub fn toggle(&mut self, side: Side) {
        for (t, k) in [side, self.twin(side)] {
            self.joined[t as usize][k] ^= true;
        }
    }

    /// The quad of the two triangles at an edge: apex, start, apex beyond, end; counter-clockwise.
    pub fn quad(triangles: &Triangles, (t, k): Side, (other, j): Side) -> [u32; 4] {
        let near = triangles.corners[t as usize];
        let far = triangles.corners[other as usize];
        [
            near[(k + 2) % 3],
            near[k],
            far[(j + 2) % 3],
            near[(k + 1) % 3],
        ]
    }

    /// The quads. The shared edge of the two triangles (or thirds) of each is its second diagonal:
    /// from corner 1 to corner 3.
    pub fn draft(&self, method: Method) -> Draft {
        let triangles = self.triangles;
        let mut nodes = triangles.nodes.clone();
        let mut centre = vec![NONE; triangles.corners.len()];
        for t in 0..triangles.corners.len() {
            if self.degree(t as u32) == 3 {
                centre[t] = nodes.len() as u32;
                nodes.push(centroid(triangles, t));
            }
        }
        let mut quads = Vec::with_capacity(triangles.corners.len() / 2);
        for t in 0..triangles.corners.len() as u32 {
            for k in (0..3).filter(|&k| self.joined[t as usize][k]) {
                let (other, j) = self.twin((t, k));
                if t < other {
                    let mut quad = Join::quad(triangles, (t, k), (other, j));
                    for (corner, triangle) in [(0, t), (2, other)] {
                        if centre[triangle as usize] != NONE {
                            quad[corner] = centre[triangle as usize];
                        }
                    }
                    quads.push(quad);
                }
            }
        }
        Draft {
            nodes,
            visits: triangles.visits,
            quads,
            settled: 0,
            method,
        }
    }
}

fn centroid(triangles: &Triangles, t: usize) -> Xy {
    let [a, b, c] = triangles.corners[t].map(|node| triangles.nodes[node as usize]);
    [(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0]
}
