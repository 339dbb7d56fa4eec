//! The plan of a city -> the frame of its mesh: nodes on curves, and the stretch of a line on each
//! mesh edge.

use crate::boundary::walks::Site;
use crate::boundary::walks::curve_nodes;
use crate::chunk::frame::Certificate;
use crate::chunk::frame::Frame;
use crate::chunk::frame::Patterns;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::Piece;
use crate::partition::subdomains::Curve;
use crate::pipeline::plan::Plan;

/// The frame of the mesh that `plan` describes.
pub(super) fn frame(plan: &Plan) -> Frame {
    let site = plan.site();
    let grid = &plan.domain.grid;
    let fixed = plan.city.arrangement.points.len();
    let total = plan.first[plan.first.len() - 1] as usize;
    let mut nodes = vec![[0.0; 2]; total];
    for (node, &point) in nodes.iter_mut().zip(&plan.city.arrangement.points) {
        *node = grid.local_m(point);
    }
    let mut frame = Frame {
        fixed_nodes: fixed as u32,
        curve_start: vec![0],
        piece_start: vec![0],
        subdomains: plan.city.partition.subdomains.clone(),
        size_m: vec![plan.sizes.default_m; plan.city.partition.subdomains.len()],
        goals: plan.city.goals.clone(),
        patterns: Patterns::of(&plan.city.balance.structure),
        certificate: Some(Certificate::from(plan.city.balance.clone())),
        ..Frame::default()
    };
    for (c, curve) in plan.city.partition.curves.iter().enumerate() {
        let (ids, places) = curve_nodes(&site, c as u32);
        for (&id, &place) in ids.iter().zip(&places) {
            nodes[id as usize] = place;
        }
        push_pieces(&mut frame, &plan.city.arrangement, &site, c, &ids, curve);
        frame.curve_nodes.extend(ids.iter().map(|&id| id as u32));
        frame.curve_start.push(frame.curve_nodes.len() as u32);
        frame.left.push(curve.left);
        frame.right.push(curve.right);
        frame.is_seam.push(curve.is_seam);
    }
    frame.nodes = nodes;
    frame
}

/// The pieces of each mesh edge of curve `c`, whose nodes are `ids`: those of the edge of the arrangement that it is a part of,
/// with stations in proportion.
fn push_pieces(
    frame: &mut Frame,
    arrangement: &Arrangement,
    site: &Site,
    c: usize,
    ids: &[u64],
    curve: &Curve,
) {
    let is_fixed = |id: u64| id < arrangement.points.len() as u64;
    let mut from = 0;
    for (step, &edge) in curve.edges.iter().enumerate() {
        let parts = 1
            + (ids[from + 1..].iter())
                .take_while(|&&id| !is_fixed(id))
                .count();
        let turned = curve.nodes[step] > curve.nodes[step + 1];
        debug_assert_eq!(ids[from], u64::from(curve.nodes[step]));
        for k in 0..parts {
            for piece in arrangement.pieces_of(edge) {
                frame.pieces.push(part_of(piece, turned, k, parts));
            }
            frame.piece_start.push(frame.pieces.len() as u32);
        }
        from += parts;
    }
    debug_assert_eq!(from as u32, site.counts[c]);
}

/// Part `k` of `parts` of `piece`, in the direction of the edge or `turned` against it.
fn part_of(piece: &Piece, turned: bool, k: usize, parts: usize) -> Piece {
    let (from_m, to_m) = match turned {
        false => (piece.from_m, piece.to_m),
        true => (piece.to_m, piece.from_m),
    };
    let at = |n: usize| match n {
        0 => from_m,
        n if n == parts => to_m,
        n => from_m + (to_m - from_m) * n as f64 / parts as f64,
    };
    Piece {
        line: piece.line,
        from_m: at(k),
        to_m: at(k + 1),
    }
}
