//! The planar arrangement: what noding makes, clean-up mends and partition walks.

use crate::domain::line::LineId;
use crate::geometry::point::Point;

/// A stretch of an input line that an edge represents.
///
/// Positions are [stations](crate::domain::line::Domain::stations_m), metres along the line as read. The edge's
/// first node represents `from_m`, its second `to_m`; so `from_m > to_m` where the line was
/// digitised against the edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// The line.
    pub line: LineId,
    /// Station at the edge's first node, metres.
    pub from_m: f64,
    /// Station at the edge's second node, metres.
    pub to_m: f64,
}

/// A planar straight-line graph whose edges remember where they come from.
///
/// Invariants (`noding::check`): points sorted and unique; each edge `[a, b]` has `a < b`; edges
/// sorted and unique; two edges meet only at common nodes; each node is used; pieces of an edge are
/// sorted by (line, from, to). An edge without pieces is a seam. Memory: 8 bytes a point, 12 an
/// edge, 24 a piece.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrangement {
    /// Nodes, sorted by (x, y).
    pub points: Vec<Point>,
    /// Edges `[a, b]`, `a < b`, sorted.
    pub edges: Vec<[u32; 2]>,
    /// `piece_start[e]..piece_start[e + 1]` are the pieces of edge `e`; one longer than `edges`.
    pub piece_start: Vec<u32>,
    /// Pieces, by edge.
    pub pieces: Vec<Piece>,
}

impl Arrangement {
    /// The pieces of edge `edge`.
    pub fn pieces_of(&self, edge: u32) -> &[Piece] {
        let e = edge as usize;
        &self.pieces[self.piece_start[e] as usize..self.piece_start[e + 1] as usize]
    }

    /// The arrangement of these edges: sorts points and edges, drops unused points and edges of no
    /// length, merges equal edges with all their pieces. `edges[i]` runs from its first to its
    /// second index; pieces are given in that direction and turned where the edge is turned.
    /// O(n log n).
    pub fn from_parts(points: &[Point], edges: Vec<([u32; 2], Vec<Piece>)>) -> Arrangement {
        let mut order: Vec<Point> = Vec::with_capacity(points.len());
        for ([a, b], _) in &edges {
            order.push(points[*a as usize]);
            order.push(points[*b as usize]);
        }
        order.sort_unstable();
        order.dedup();
        let id = |old: u32| order.binary_search(&points[old as usize]).unwrap() as u32;
        let mut turned: Vec<([u32; 2], Vec<Piece>)> = edges
            .into_iter()
            .filter_map(|([a, b], mut pieces)| {
                let (a, b) = (id(a), id(b));
                if a > b {
                    for piece in &mut pieces {
                        std::mem::swap(&mut piece.from_m, &mut piece.to_m);
                    }
                }
                (a != b).then(|| ([a.min(b), a.max(b)], pieces))
            })
            .collect();
        turned.sort_by_key(|(edge, _)| *edge);
        let mut made = Arrangement {
            points: order,
            piece_start: vec![0],
            ..Arrangement::default()
        };
        let mut at = 0;
        while at < turned.len() {
            let edge = turned[at].0;
            let mut pieces = Vec::new();
            while at < turned.len() && turned[at].0 == edge {
                pieces.append(&mut turned[at].1);
                at += 1;
            }
            pieces.sort_by(|p, q| {
                (p.line.cmp(&q.line))
                    .then(p.from_m.total_cmp(&q.from_m))
                    .then(p.to_m.total_cmp(&q.to_m))
            });
            pieces.dedup();
            made.edges.push(edge);
            made.pieces.append(&mut pieces);
            made.piece_start.push(made.pieces.len() as u32);
        }
        made.drop_unused_points();
        made
    }

    fn drop_unused_points(&mut self) {
        let mut used = vec![false; self.points.len()];
        for edge in &self.edges {
            for &node in edge {
                used[node as usize] = true;
            }
        }
        if used.iter().all(|&it| it) {
            return;
        }
        let mut renamed = vec![0; self.points.len()];
        let mut kept = 0;
        for node in 0..used.len() {
            renamed[node] = kept;
            kept += u32::from(used[node]);
        }
        for edge in &mut self.edges {
            *edge = edge.map(|node| renamed[node as usize]);
        }
        let mut node = 0;
        self.points.retain(|_| {
            node += 1;
            used[node - 1]
        });
    }
}
