//! Drops what lies outside the domain; leaves ring pieces on the rim only.

use crate::domain::line::Domain;
use crate::domain::line::Role;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::Piece;
use crate::noding::rim::vote;
use crate::noding::winding::Rings;

/// The part of `arrangement` in the domain, and the stretches of constraint lines that lie outside
/// (`from_m < to_m`, by line, joined where they touch).
///
/// The domain is where boundary rings wind around at least once and hole rings do not. An edge with
/// both sides outside goes. One with both sides inside (a wall between two boundary polygons, a
/// ring that snapping closed) loses its ring pieces, and goes if nothing else runs there. On the
/// rim those ring pieces stay that have the domain on the side where it is.
pub fn clip(domain: &Domain, arrangement: Arrangement) -> (Arrangement, Vec<Piece>) {
    let all = 0..arrangement.edges.len() as u32;
    let inside = Rings::of(domain, &arrangement).sides_inside(&arrangement, all);
    clip_to(domain, arrangement, &inside)
}

/// The same, if the sides of all edges are known.
pub fn clip_to(
    domain: &Domain,
    arrangement: Arrangement,
    inside: &[[bool; 2]],
) -> (Arrangement, Vec<Piece>) {
    let mut made = arrangement;
    let mut outside = Vec::new();
    // nearly everything stays: it moves up in the arrays where it is
    let (mut edges, mut pieces, mut from) = (0, 0, 0);
    for (edge, &sides) in inside.iter().enumerate() {
        let of_edge = from..made.piece_start[edge + 1] as usize;
        from = of_edge.end;
        if sides == [false, false] {
            let gone = made.pieces[of_edge].iter();
            outside.extend(gone.filter(|piece| is_constraint(domain, piece)));
            continue;
        }
        let rim = i32::from(sides[0]) - i32::from(sides[1]);
        let before = pieces;
        for at in of_edge {
            let piece = made.pieces[at];
            if is_constraint(domain, &piece) || (rim != 0 && vote(domain, &piece) == rim) {
                made.pieces[pieces] = piece;
                pieces += 1;
            }
        }
        if pieces > before {
            made.edges[edges] = made.edges[edge];
            edges += 1;
            made.piece_start[edges] = pieces as u32;
        }
    }
    made.edges.truncate(edges);
    made.piece_start.truncate(edges + 1);
    made.pieces.truncate(pieces);
    made.drop_unused_points();
    (made, joined(outside))
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
