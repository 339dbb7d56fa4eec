//! The method that cannot fail: any join of any triangulation, with a ring where a pair is bent.
//!
//! **Why it cannot fail.** The walks have an even number of edges in total, so every triangulation
//! of the sub-domain has an even number of triangles, so it has a [`Join`]: all quads, each made of
//! two triangles (or thirds of triangles) on the two sides of a shared edge v1 v3. Such a quad
//! v0 v1 v2 v3 may be bent, but any point k inside its shared edge sees all of it. Put p_i on the
//! segment from k to v_i, all four at the same distance r from k, closer than any v_i. Then
//!
//! - v_i v_i+1 p_i+1 p_i is the triangle k v_i v_i+1 with its tip cut off along a chord: strictly
//!   convex, since k is not on the line through v_i and v_i+1 (both triangles have area);
//! - p_0 p_1 p_2 p_3 lie on one circle in this order and so form a strictly convex quad.
//!
//! Five strictly convex quads, with no new node on the outline: neighbours need not know. Floating
//! point has the last word, so k and r are those of a few that give the best least Jacobian.

use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::geometry::quad::scaled_jacobian;
use crate::meshing::draft::Draft;
use crate::meshing::join::Join;
use crate::meshing::patch::Method;

/// A pair this good stays one quad; smoothing will do the rest.
const STRAIGHT_ENOUGH: f64 = 0.1;

/// Turns a join into quads that are all strictly convex.
pub(crate) fn mesh(join: &Join) -> Draft {
    let mut draft = join.draft(Method::LastResort);
    let quads = std::mem::take(&mut draft.quads);
    for quad in quads {
        let corners = quad.map(|node| draft.nodes[node as usize]);
        if scaled_jacobian(&corners) >= STRAIGHT_ENOUGH {
            draft.quads.push(quad);
        } else {
            ring(&mut draft, quad, best_ring(&corners));
        }
    }
    draft
}

/// Cuts `quad` into the four quads between it and `inner`, and `inner`.
fn ring(draft: &mut Draft, quad: [u32; 4], inner: [Xy; 4]) {
    let first = draft.nodes.len() as u32;
    draft.nodes.extend(inner);
    for i in 0..4_u32 {
        let next = (i + 1) % 4;
        draft.quads.push([
            quad[i as usize],
            quad[next as usize],
            first + next,
            first + i,
        ]);
    }
    draft.quads.push([first, first + 1, first + 2, first + 3]);
}

/// The inner quad of the best ring among 5 x 5 choices of k and r, with k on the diagonal from
/// corner 1 to corner 3.
pub(crate) fn best_ring(corners: &[Xy; 4]) -> [Xy; 4] {
    let mut best = (f64::NEG_INFINITY, *corners);
    for along in [0.5, 0.35, 0.65, 0.2, 0.8] {
        let k: Xy =
            std::array::from_fn(|x| corners[1][x] + along * (corners[3][x] - corners[1][x]));
        let reach = corners.map(|v| distance(k, v));
        let nearest = reach.iter().fold(f64::INFINITY, |least, &d| least.min(d));
        for share in [0.5, 0.35, 0.65, 0.2, 0.8] {
            let r = share * nearest;
            let inner: [Xy; 4] = std::array::from_fn(|i| {
                std::array::from_fn(|x| k[x] + r / reach[i] * (corners[i][x] - k[x]))
            });
            let least = least_of_ring(corners, &inner);
            if least > best.0 {
                best = (least, inner);
            }
        }
    }
    best.1
}

fn least_of_ring(outer: &[Xy; 4], inner: &[Xy; 4]) -> f64 {
    let side = |i: usize| {
        let next = (i + 1) % 4;
        scaled_jacobian(&[outer[i], outer[next], inner[next], inner[i]])
    };
    (0..4).map(side).fold(scaled_jacobian(inner), f64::min)
}
