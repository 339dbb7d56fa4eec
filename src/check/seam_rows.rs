//! The cells beside seams: a seam should not be seen in the shapes.
//!
//! A seam of one to three edges is a rung, laid where no row would fit without it; it is meant to be seen.

use crate::chunk::views::FrameView;
use crate::chunk::views::PatchView;

/// Seams of fewer edges are rungs.
const EDGES_MIN: u32 = 4;

/// Rows of cells that count as beside a seam.
const ROWS: usize = 2;

/// Which boundary nodes lie on seams, their ends on lines not among them.
pub(crate) struct SeamRows {
    on_seam: Vec<bool>,
}

impl SeamRows {
    pub fn of(frame: &FrameView) -> SeamRows {
        let mut on_seam = vec![false; frame.nodes.len()];
        let seams = (0..frame.curves())
            .filter(|&curve| frame.is_seam(curve) && frame.count(curve) >= EDGES_MIN);
        for curve in seams {
            let nodes = frame.nodes_of(curve);
            for &node in &nodes[1..nodes.len() - 1] {
                on_seam[node as usize] = true;
            }
        }
        SeamRows { on_seam }
    }

    /// For each node of a patch, whether a cell with it is beside a seam; `None` if no seam is on it.
    pub fn near(&self, patch: &PatchView) -> Option<Vec<bool>> {
        let is_on_seam = |&id: &u32| self.on_seam[id as usize];
        if !patch.boundary.iter().any(is_on_seam) {
            return None;
        }
        let mut near: Vec<bool> = patch.boundary.iter().map(is_on_seam).collect();
        near.resize(patch.nodes(), false);
        for _ in 1..ROWS {
            near = a_row_on(patch, &near);
        }
        Some(near)
    }
}

/// For each node of a patch, whether it is in a cell with one of these nodes.
pub(crate) fn a_row_on(patch: &PatchView, these: &[bool]) -> Vec<bool> {
    let mut reached = vec![false; patch.nodes()];
    for quad in patch.quads {
        if quad.iter().any(|&node| these[node as usize]) {
            for &node in quad {
                reached[node as usize] = true;
            }
        }
    }
    reached
}
