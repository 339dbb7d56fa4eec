//! Where rungs could be: from a node with room, the edges near it.

use crate::geometry::point::Point;
use crate::rungs::ANGLE_DEG;
use crate::rungs::ladder::Ladder;
use std::ops::Range;

/// A possible rung: from a node to the nearest place on an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    /// Squared distance between them, cells^2.
    length2: f64,
    pub node: u32,
    /// An edge of the arrangement as given.
    pub edge: u32,
}

/// All candidates from these nodes, the shortest first.
pub(super) fn propose(ladder: &Ladder, nodes: Range<u32>) -> Vec<Candidate> {
    let mut found = Vec::new();
    for node in nodes {
        if has_room(ladder, node) {
            propose_from(ladder, node, &mut found);
        }
    }
    found.sort_by(|p, q| {
        p.length2
            .total_cmp(&q.length2)
            .then((p.node, p.edge).cmp(&(q.node, q.edge)))
    });
    found
}

/// True if a rung could leave enough to its neighbours.
fn has_room(ladder: &Ladder, node: u32) -> bool {
    let widest = 2.0 * ANGLE_DEG.to_radians();
    (ladder.web.out[node as usize].iter())
        .any(|&half| ladder.web.is_inside(half) && ladder.web.angle_rad(half) >= widest)
}

fn propose_from(ladder: &Ladder, node: u32, found: &mut Vec<Candidate>) {
    let at = ladder.web.points[node as usize];
    let reach = ladder.reach(node);
    for edge in ladder.walls.near([at, at], reach) {
        let is_seam = ladder.arrangement.pieces_of(edge).is_empty();
        if is_seam || ladder.is_at(node, edge) {
            continue;
        }
        let (_, length2) = nearest(at, ladder.web.ends(edge));
        if length2 <= reach * reach {
            found.push(Candidate {
                length2,
                node,
                edge,
            });
        }
    }
}

/// The grid point nearest to `p` on a segment, and the squared distance to the exact place.
pub(super) fn nearest(p: Point, [a, b]: [Point; 2]) -> (Point, f64) {
    let step = |u: i32, v: i32| (i64::from(v) - i64::from(u)) as f64;
    let (dx, dy) = (step(a.x, b.x), step(a.y, b.y));
    let (px, py) = (step(a.x, p.x), step(a.y, p.y));
    let share = ((px * dx + py * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    let (x, y) = (share * dx, share * dy);
    let foot = Point::new(a.x + x.round() as i32, a.y + y.round() as i32);
    (foot, (px - x).powi(2) + (py - y).powi(2))
}
