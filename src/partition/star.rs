//! Half-edges, and those that leave a node in the order of their angles.

use crate::geometry::predicates::by_angle;
use crate::noding::arrangement::Arrangement;

/// An edge and a direction along it: `edge << 1 | against`. With 0 it runs from the edge's first
/// node to the second. The face in question lies on its left.
pub type HalfEdge = u32;

/// The node that `half` leaves.
pub(super) fn tail(arrangement: &Arrangement, half: HalfEdge) -> u32 {
    arrangement.edges[(half >> 1) as usize][(half & 1) as usize]
}

/// The node that `half` reaches.
pub(super) fn head(arrangement: &Arrangement, half: HalfEdge) -> u32 {
    tail(arrangement, half ^ 1)
}

/// Direction of `half`, cells.
pub(super) fn direction(arrangement: &Arrangement, half: HalfEdge) -> (i64, i64) {
    let a = arrangement.points[tail(arrangement, half) as usize];
    let b = arrangement.points[head(arrangement, half) as usize];
    (
        i64::from(b.x) - i64::from(a.x),
        i64::from(b.y) - i64::from(a.y),
    )
}

/// The half-edges that leave each of some nodes.
pub(super) struct Stars {
    /// `start[k]..start[k + 1]` are those of the k-th node.
    pub start: Vec<u32>,
    /// Half-edges, by node.
    pub out: Vec<HalfEdge>,
}

impl Stars {
    /// Of all nodes, in the order of the edges. O(n).
    pub fn of_all(arrangement: &Arrangement) -> Stars {
        let mut start = vec![0u32; arrangement.points.len() + 1];
        for node in arrangement.edges.iter().flatten() {
            start[*node as usize + 1] += 1;
        }
        for node in 1..start.len() {
            start[node] += start[node - 1];
        }
        let mut fill = start.clone();
        let mut out = vec![0; 2 * arrangement.edges.len()];
        for (edge, nodes) in arrangement.edges.iter().enumerate() {
            for (against, &node) in nodes.iter().enumerate() {
                out[fill[node as usize] as usize] = (edge as u32) << 1 | against as u32;
                fill[node as usize] += 1;
            }
        }
        Stars { start, out }
    }

    /// Those that leave the k-th node.
    pub fn of(&self, k: usize) -> &[HalfEdge] {
        &self.out[self.start[k] as usize..self.start[k + 1] as usize]
    }

    /// Sorts the star of each node counter-clockwise from east.
    pub fn sort_by_angle(&mut self, arrangement: &Arrangement) {
        for k in 1..self.start.len() {
            let star = &mut self.out[self.start[k - 1] as usize..self.start[k] as usize];
            star.sort_unstable_by(|&g, &h| {
                by_angle(direction(arrangement, g), direction(arrangement, h))
            });
        }
    }
}
