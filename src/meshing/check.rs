//! The promises of a patch, as code.

use crate::geometry::point::Xy;
use crate::geometry::quad::corner_jacobians;
use crate::meshing::buckets::sorted_by_node;
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

/// Checks all promises of [`Patch`] against its loops. O(n).
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
            sides.push(key(quad[k], quad[(k + 1) % 4], QUAD));
        }
    }
    for walk in &loops.walks {
        let ends = walk.iter().skip(1).chain(walk.first());
        sides.extend(
            walk.iter()
                .zip(ends)
                .map(|(&from, &to)| key(from, to, WALK)),
        );
    }
    let sides = sorted_by_node(&sides, patch.nodes.len(), |side| (side >> 33) as usize);
    for edge in sides.chunk_by(|a, b| a >> 2 == b >> 2) {
        if let Some(what) = misuse(edge) {
            return defect(what.into(), (edge[0] >> 33) as u32);
        }
    }
    Ok(())
}

const QUAD: u64 = 0;
const WALK: u64 = 2;

/// A directed side to sort by edge: lower node, higher node, then who has it, then its direction.
/// Node numbers are below 2^31, as a sub-domain has far fewer nodes.
fn key(from: u32, to: u32, owner: u64) -> u64 {
    let edge = u64::from(from.min(to)) << 33 | u64::from(from.max(to)) << 2;
    edge | owner | u64::from(from > to)
}

/// What is wrong with an edge, given all sides on it.
fn misuse(edge: &[u64]) -> Option<&'static str> {
    let count = |kind: u64| edge.iter().filter(|&&side| side & 3 == kind).count();
    let quads = [count(QUAD), count(QUAD | 1)];
    let walks = [count(WALK), count(WALK | 1)];
    if quads[0] > 1 || quads[1] > 1 {
        Some("two quads lie on the same side of an edge")
    } else if walks == [0, 0] {
        (quads != [1, 1]).then_some("an edge off the walks is used once")
    } else if quads[0] < walks[0] || quads[1] < walks[1] {
        Some("a walk edge has no quad on its left")
    } else {
        (quads != walks).then_some("a quad lies on the right of a walk")
    }
}
