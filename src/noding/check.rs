//! The promises of an arrangement, as code.

use crate::geometry::crossing::crossing;
use crate::geometry::point::Point;
use crate::geometry::predicates::on_segment;
use crate::noding::arrangement::Arrangement;
use rstar::AABB;
use rstar::RTree;
use rstar::RTreeObject;
use rstar::primitives::GeomWithData;
use rstar::primitives::Rectangle;
use std::fmt;

/// A broken promise of an arrangement: our mistake, never the input's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Defect {
    /// This point does not follow the one before it in (x, y).
    PointOrder(u32),
    /// This edge names a point that does not exist, or its first node is not the lesser.
    EdgeEnds(u32),
    /// This edge does not follow the one before it.
    EdgeOrder(u32),
    /// No edge uses this point.
    UnusedPoint(u32),
    /// `piece_start` does not fit `edges` and `pieces`, first seen at this edge.
    PieceStart(u32),
    /// The pieces of this edge are not sorted, or one has no length.
    PieceOrder(u32),
    /// These two edges meet elsewhere than at a common node; near this point.
    Meet(u32, u32, Point),
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Defect::PointOrder(point) => write!(f, "point {point} is out of order"),
            Defect::EdgeEnds(edge) => write!(f, "edge {edge} has wrong ends"),
            Defect::EdgeOrder(edge) => write!(f, "edge {edge} is out of order"),
            Defect::UnusedPoint(point) => write!(f, "no edge uses point {point}"),
            Defect::PieceStart(edge) => write!(f, "piece_start is wrong at edge {edge}"),
            Defect::PieceOrder(edge) => write!(f, "the pieces of edge {edge} are out of order"),
            Defect::Meet(s, t, at) => {
                write!(f, "edges {s} and {t} meet near cell ({}, {})", at.x, at.y)
            }
        }
    }
}

/// Checks all invariants of [`Arrangement`]. O(n log n) for line work of even density.
pub fn check(arrangement: &Arrangement) -> Result<(), Defect> {
    check_lists(arrangement)?;
    check_pieces(arrangement)?;
    check_meetings(arrangement)
}

fn check_lists(arrangement: &Arrangement) -> Result<(), Defect> {
    let points = &arrangement.points;
    if let Some(at) = points.windows(2).position(|pair| pair[0] >= pair[1]) {
        return Err(Defect::PointOrder(at as u32 + 1));
    }
    let mut used = vec![false; points.len()];
    for (edge, [a, b]) in arrangement.edges.iter().enumerate() {
        if a >= b || *b as usize >= points.len() {
            return Err(Defect::EdgeEnds(edge as u32));
        }
        used[*a as usize] = true;
        used[*b as usize] = true;
    }
    if let Some(at) = arrangement
        .edges
        .windows(2)
        .position(|pair| pair[0] >= pair[1])
    {
        return Err(Defect::EdgeOrder(at as u32 + 1));
    }
    match used.iter().position(|used| !used) {
        Some(at) => Err(Defect::UnusedPoint(at as u32)),
        None => Ok(()),
    }
}

fn check_pieces(arrangement: &Arrangement) -> Result<(), Defect> {
    let starts = &arrangement.piece_start;
    let edges = arrangement.edges.len();
    if edges == 0 && starts.len() <= 1 && arrangement.pieces.is_empty() {
        return Ok(());
    }
    if starts.len() != edges + 1
        || starts[0] != 0
        || starts[edges] as usize != arrangement.pieces.len()
    {
        return Err(Defect::PieceStart(edges as u32));
    }
    if let Some(edge) = starts.windows(2).position(|pair| pair[0] > pair[1]) {
        return Err(Defect::PieceStart(edge as u32));
    }
    for edge in 0..edges as u32 {
        let pieces = arrangement.pieces_of(edge);
        let sorted = pieces
            .windows(2)
            .all(|pair| pair[0].order(&pair[1]).is_lt());
        if !sorted || pieces.iter().any(|piece| piece.from_m == piece.to_m) {
            return Err(Defect::PieceOrder(edge));
        }
    }
    Ok(())
}

fn check_meetings(arrangement: &Arrangement) -> Result<(), Defect> {
    let ends = |edge: u32| arrangement.edges[edge as usize].map(|n| arrangement.points[n as usize]);
    let boxes = (0..arrangement.edges.len() as u32)
        .map(|edge| {
            let [a, b] = ends(edge);
            GeomWithData::new(Rectangle::from_corners([a.x, a.y], [b.x, b.y]), edge)
        })
        .collect();
    let tree: RTree<GeomWithData<Rectangle<[i32; 2]>, u32>> = RTree::bulk_load(boxes);
    for s in 0..arrangement.edges.len() as u32 {
        let [a, b] = ends(s);
        let around: AABB<[i32; 2]> = Rectangle::from_corners([a.x, a.y], [b.x, b.y]).envelope();
        let met = (tree.locate_in_envelope_intersecting(around))
            .filter(|other| other.data > s)
            .filter_map(|other| meeting([a, b], ends(other.data)).map(|at| (other.data, at)))
            .min();
        if let Some((t, at)) = met {
            return Err(Defect::Meet(s, t, at));
        }
    }
    Ok(())
}

/// A point where two different edges meet and not both end.
fn meeting([a, b]: [Point; 2], [c, d]: [Point; 2]) -> Option<Point> {
    let touches = |p: Point, q: Point, end: Point| end != p && end != q && on_segment(p, q, end);
    [c, d]
        .into_iter()
        .find(|&end| touches(a, b, end))
        .or_else(|| [a, b].into_iter().find(|&end| touches(c, d, end)))
        .or_else(|| crossing(a, b, c, d))
}
