//! Drops what lies outside the domain; leaves ring pieces on the rim only.

use crate::domain::line::Domain;
use crate::domain::line::Role;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::Piece;
use crate::noding::rim::vote;
use crate::noding::winding::sides_inside;

/// The part of `arrangement` in the domain, and the stretches of constraint lines that lie outside
/// (`from_m < to_m`, by line, joined where they touch).
///
/// The domain is where boundary rings wind around at least once and hole rings do not. An edge with
/// both sides outside goes. One with both sides inside (a wall between two boundary polygons, a
/// ring that snapping closed) loses its ring pieces, and goes if nothing else runs there. On the
/// rim those ring pieces stay that have the domain on the side where it is.
pub fn clip(domain: &Domain, arrangement: Arrangement) -> (Arrangement, Vec<Piece>) {
    let inside = sides_inside(domain, &arrangement);
    let mut kept = Arrangement {
        points: Vec::new(),
        edges: Vec::with_capacity(arrangement.edges.len()),
        piece_start: Vec::with_capacity(arrangement.piece_start.len()),
        pieces: Vec::with_capacity(arrangement.pieces.len()),
    };
    kept.piece_start.push(0);
    let mut outside = Vec::new();
    for (edge, sides) in inside.into_iter().enumerate() {
        let pieces = arrangement.pieces_of(edge as u32);
        if sides == [false, false] {
            outside.extend(pieces.iter().filter(|piece| is_constraint(domain, piece)));
            continue;
        }
        let rim = i32::from(sides[0]) - i32::from(sides[1]);
        let stays = |piece: &&Piece| {
            is_constraint(domain, piece) || (rim != 0 && vote(domain, piece) == rim)
        };
        let before = kept.pieces.len();
        kept.pieces.extend(pieces.iter().filter(stays));
        if kept.pieces.len() > before {
            kept.edges.push(arrangement.edges[edge]);
            kept.piece_start.push(kept.pieces.len() as u32);
        }
    }
    kept.points = arrangement.points;
    kept.drop_unused_points();
    (kept, joined(outside))
}

fn is_constraint(domain: &Domain, piece: &Piece) -> bool {
    domain.lines[piece.line as usize].role == Role::Constraint
}

/// Turns each stretch forward and joins those of one line that touch.
fn joined(mut stretches: Vec<Piece>) -> Vec<Piece> {
    for stretch in &mut stretches {
        (stretch.from_m, stretch.to_m) = (
            stretch.from_m.min(stretch.to_m),
            stretch.from_m.max(stretch.to_m),
        );
    }
    stretches.sort_unstable_by(Piece::order);
    let mut made: Vec<Piece> = Vec::new();
    for stretch in stretches {
        match made.last_mut() {
            Some(last) if last.line == stretch.line && stretch.from_m <= last.to_m => {
                last.to_m = last.to_m.max(stretch.to_m);
            }
            _ => made.push(stretch),
        }
    }
    made
}
