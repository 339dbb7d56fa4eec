//! The promises of a patch, as code.

use crate::geometry::point::Xy;
use crate::geometry::quad::corner_jacobians;
use crate::meshing::patch::Loops;
use crate::meshing::patch::Patch;

/// What a patch breaks, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Defect {
    /// A sentence.
    pub what: String,
    /// Position, metres.
    pub at_m: Xy,
}

/// Checks all promises of [`Patch`] against its loops. O(n log n).
///
/// That no two quads overlap follows: all are counter-clockwise and their outline is the walks,
/// which wind once around every point of the sub-domain.
pub fn check(loops: &Loops, patch: &Patch) -> Result<(), Defect> {
    let defect = |what: String, node: u32| {
        let at_m = patch.nodes.get(node as usize).copied().unwrap_or([0.0; 2]);
        Err(Defect { what, at_m })
    };
    for (node, at) in loops.nodes.iter().enumerate() {
        if patch.nodes.get(node) != Some(at) {
            return defect(format!("boundary node {node} has moved"), node as u32);
        }
    }
    let mut sides = Vec::with_capacity(4 * patch.quads.len());
    for quad in &patch.quads {
        if let Some(&node) = quad
            .iter()
            .find(|&&node| node as usize >= patch.nodes.len())
        {
            return defect(format!("a quad names node {node}, which is not there"), 0);
        }
        let jacobians = corner_jacobians(&quad.map(|node| patch.nodes[node as usize]));
        for (k, jacobian) in jacobians.into_iter().enumerate() {
            // Written so that NaN fails.
            if jacobian.is_nan() || jacobian <= 0.0 {
                return defect(format!("a corner Jacobian is {jacobian} m2"), quad[k]);
            }
            sides.push((quad[k], quad[(k + 1) % 4]));
        }
    }
    sides.sort_unstable();
    if let Some(pair) = sides.windows(2).find(|pair| pair[0] == pair[1]) {
        return defect(
            "two quads lie on the same side of an edge".into(),
            pair[0].0,
        );
    }
    let walked = walk_edges(loops);
    for edge in &walked {
        if sides.binary_search(edge).is_err() {
            return defect("a walk edge has no quad on its left".into(), edge.0);
        }
    }
    for side in &sides {
        let on_walk = walked.binary_search(side).is_ok();
        let back = (side.1, side.0);
        if !on_walk && (walked.binary_search(&back).is_ok() || sides.binary_search(&back).is_err())
        {
            return defect("an edge off the walks is used once".into(), side.0);
        }
        if on_walk && walked.binary_search(&back).is_err() && sides.binary_search(&back).is_ok() {
            return defect("a quad lies on the right of a walk".into(), side.0);
        }
    }
    Ok(())
}

/// All directed walk edges, sorted.
fn walk_edges(loops: &Loops) -> Vec<(u32, u32)> {
    let mut edges = Vec::new();
    for walk in &loops.walks {
        for k in 0..walk.len() {
            edges.push((walk[k], walk[(k + 1) % walk.len()]));
        }
    }
    edges.sort_unstable();
    edges
}
