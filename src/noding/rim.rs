//! On which side of an edge of the rim the domain lies.

use crate::domain::line::Domain;
use crate::domain::line::Role;
use crate::noding::arrangement::Piece;

/// What one ring piece says: +1 if the domain lies on the left of the edge (from its first node to
/// its second), -1 if on the right; 0 for a piece of a constraint line.
///
/// A boundary ring has its polygon on the left of its own direction, a hole ring has it on the
/// right.
pub fn vote(domain: &Domain, piece: &Piece) -> i32 {
    let forward = if piece.from_m < piece.to_m { 1 } else { -1 };
    match domain.lines[piece.line as usize].role {
        Role::Constraint => 0,
        Role::Boundary => forward,
        Role::Hole => -forward,
    }
}

/// +1 if the domain lies on the left of an edge with these pieces, -1 if on the right, 0 if the
/// edge is not on the rim (both sides are inside). For arrangements that
/// [`clip`](fn@crate::noding::clip) has seen: there all ring pieces of an edge agree.
pub fn rim_side(domain: &Domain, pieces: &[Piece]) -> i32 {
    pieces
        .iter()
        .map(|piece| vote(domain, piece))
        .sum::<i32>()
        .signum()
}
