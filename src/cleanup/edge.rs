//! An edge of the changing graph, what it carries, and what it is made of or taken up by.

use smallvec::SmallVec;

use crate::domain::line::Domain;
use crate::geometry::point::Point;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::Piece;
use crate::noding::rim::rim_side;

pub(super) type Pieces = SmallVec<[Piece; 2]>;

/// An edge of the changing graph.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub(super) ends: [u32; 2],
    /// Is the domain on its left, on its right? Kept through all merges: the pieces alone could not
    /// tell a closed gap from a closed wall.
    pub(super) inside: [bool; 2],
    /// Least wished edge length of its lines, metres.
    pub(super) size_m: f64,
    /// Highest rank of its lines.
    pub(super) rank: f64,
    pub(super) alive: bool,
}

impl Edge {
    #[inline]
    pub(super) fn other(&self, node: u32) -> u32 {
        self.ends[usize::from(self.ends[0] == node)]
    }

    /// Which of its ends `node` is; so is the side on the left of the way from there.
    #[inline]
    pub(super) fn end_at(&self, node: u32) -> usize {
        usize::from(self.ends[0] != node)
    }

    pub(super) fn is_rim(&self) -> bool {
        self.inside[0] != self.inside[1]
    }

    /// Its sides (left, right) in the direction away from `node`.
    pub(super) fn inside_from(&self, node: u32) -> [bool; 2] {
        let [left, right] = self.inside;
        if self.ends[0] == node {
            [left, right]
        } else {
            [right, left]
        }
    }
}

pub(super) fn turned(piece: &Piece) -> Piece {
    Piece {
        line: piece.line,
        from_m: piece.to_m,
        to_m: piece.from_m,
    }
}

/// An edge that is about to be added: away from a node that the operation knows.
#[derive(Clone, Debug)]
pub(super) struct Draft {
    pub(super) to: u32,
    pub(super) pieces: Pieces,
    pub(super) inside: [bool; 2],
}

/// An edge that stands for itself, outside of any graph.
#[derive(Clone, Debug)]
pub(super) struct Loose {
    pub(super) ends: [Point; 2],
    pub(super) pieces: Pieces,
    pub(super) inside: [bool; 2],
}

/// What an edge of the arrangement brings to a graph: its pieces, and its sides.
pub(super) fn as_cut(arrangement: &Arrangement, domain: &Domain, edge: u32) -> (Pieces, [bool; 2]) {
    let pieces: Pieces = arrangement.pieces_of(edge).into();
    let rim = rim_side(domain, &pieces);
    (pieces, [rim >= 0, rim <= 0])
}

/// Keeps at most two stretches of each line in each direction, the longest. Where a line meanders
/// within one edge, its stretches would multiply with each split; what goes here is covered by the
/// same line on the same edge, and the audit looks at it again.
pub(super) fn thin_out(pieces: &mut Pieces) {
    if pieces.len() <= 2 {
        return;
    }
    let length = |piece: &Piece| (piece.to_m - piece.from_m).abs();
    let group = |piece: &Piece| (piece.line, piece.from_m < piece.to_m);
    pieces.sort_by(|p, q| {
        (group(p).cmp(&group(q)))
            .then_with(|| length(q).total_cmp(&length(p)))
            .then_with(|| p.order(q))
    });
    let mut same = 0;
    let mut last = None;
    pieces.retain(|piece| {
        same = if last == Some(group(piece)) {
            same + 1
        } else {
            0
        };
        last = Some(group(piece));
        same < 2
    });
}

/// An edge that takes up a draft, and its sides afterwards, away from the draft's first node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fused {
    pub(super) edge: u32,
    pub(super) inside: [bool; 2],
}
