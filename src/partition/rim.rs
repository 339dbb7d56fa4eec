//! Which side of an edge is outside.

use crate::domain::line::Domain;
use crate::domain::line::Role;
use crate::noding::arrangement::Piece;

/// +1 if only the left of edge `a -> b` is inside the domain, -1 if only the right, 0 if both.
pub(super) fn rim_side(domain: &Domain, pieces: &[Piece]) -> i32 {
    let sides = pieces.iter().map(|piece| {
        let along = if piece.to_m > piece.from_m { 1 } else { -1 };
        match domain.lines[piece.line as usize].role {
            Role::Constraint => 0,
            Role::Boundary => along,
            Role::Hole => -along,
        }
    });
    sides.sum::<i32>().signum()
}
