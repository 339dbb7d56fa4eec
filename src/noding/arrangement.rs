//! The planar arrangement: what noding makes, clean-up mends and partition walks.

use crate::domain::line::LineId;
use crate::geometry::point::Point;
use std::cmp::Ordering;

/// A stretch of an input line that an edge represents.
///
/// Positions are [stations](crate::domain::line::Domain::stations_m), metres along the line as read.
/// The edge's first node represents `from_m`, its second `to_m`; so `from_m > to_m` where the line
/// was digitised against the edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// The line.
    pub line: LineId,
    /// Station at the edge's first node, metres.
    pub from_m: f64,
    /// Station at the edge's second node, metres.
    pub to_m: f64,
}

impl Piece {
    /// The order of pieces on an edge: by line, from, to.
    pub fn order(&self, other: &Piece) -> Ordering {
        (self.line.cmp(&other.line))
            .then(self.from_m.total_cmp(&other.from_m))
            .then(self.to_m.total_cmp(&other.to_m))
    }
}

/// What makes an edge: the nodes that it runs between, and what it represents, in that direction;
/// nothing if it is a seam.
pub type Stretch = ([u32; 2], Option<Piece>);

/// A planar straight-line graph whose edges remember where they come from.
///
/// Invariants (`noding::check`): points sorted and unique; each edge `[a, b]` has `a < b`; edges
/// sorted and unique; two edges meet only at common nodes; each node is used; pieces of an edge are
/// sorted by (line, from, to). An edge without pieces is a seam. (Once nodes have settled, after `parity`, ids no
/// longer follow the order of points.) Memory: 8 bytes a point, 12 an
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

    /// The part of an edge between two nodes on it, each with its share of the edge's length, as
    /// [`Arrangement::from_parts`] takes it.
    pub fn part_of(&self, edge: u32, from: (u32, f64), to: (u32, f64)) -> ([u32; 2], Vec<Piece>) {
        let at = |piece: &Piece, share: f64| match share {
            // Ends keep their bits.
            0.0 => piece.from_m,
            1.0 => piece.to_m,
            _ => piece.from_m + share * (piece.to_m - piece.from_m),
        };
        let pieces = self.pieces_of(edge).iter().map(|piece| Piece {
            line: piece.line,
            from_m: at(piece, from.1),
            to_m: at(piece, to.1),
        });
        ([from.0, to.0], pieces.collect())
    }

    /// The arrangement of these edges: sorts points and edges, drops unused points and edges of no
    /// length, merges equal edges with all their pieces. `edges[i]` runs from its first to its
    /// second index; pieces are given in that direction and turned where the edge is turned.
    /// O(n log n).
    pub fn from_parts(points: &[Point], edges: Vec<([u32; 2], Vec<Piece>)>) -> Arrangement {
        let mut stretches = Vec::with_capacity(edges.len());
        for (edge, pieces) in edges {
            if pieces.is_empty() {
                stretches.push((edge, None));
            }
            stretches.extend(pieces.into_iter().map(|piece| (edge, Some(piece))));
        }
        Arrangement::from_stretches(points, stretches)
    }

    /// The same from one entry for each edge and piece, in any order; `None` makes the edge without
    /// giving it a piece.
    pub fn from_stretches(points: &[Point], stretches: Vec<Stretch>) -> Arrangement {
        Arrangement::from_sorted(SortedPoints::of(points), stretches)
    }

    /// The same, if the points are in order already; stretches still have the ids of before.
    pub fn from_sorted(nodes: SortedPoints, mut stretches: Vec<Stretch>) -> Arrangement {
        let SortedPoints { points, id } = nodes;
        for (edge, piece) in &mut stretches {
            *edge = edge.map(|node| id[node as usize]);
            if edge[0] > edge[1] {
                edge.swap(0, 1);
                if let Some(piece) = piece {
                    std::mem::swap(&mut piece.from_m, &mut piece.to_m);
                }
            }
        }
        stretches.retain(|(edge, _)| edge[0] != edge[1]);
        let at = |it: u32| &stretches[it as usize];
        let mut order = grouped(&stretches, points.len(), |(edge, _)| edge[0] as usize);
        for from_node in order.chunk_by_mut(|&s, &t| at(s).0[0] == at(t).0[0]) {
            from_node.sort_unstable_by(|&s, &t| {
                let ((e, p), (f, q)) = (at(s), at(t));
                e.cmp(f).then_with(|| match (p, q) {
                    (Some(p), Some(q)) => p.order(q),
                    _ => p.is_some().cmp(&q.is_some()),
                })
            });
        }
        order.dedup_by(|&mut t, &mut s| at(s) == at(t));
        let mut made = Arrangement {
            points,
            edges: Vec::with_capacity(order.len()),
            piece_start: vec![0],
            pieces: Vec::with_capacity(order.len()),
        };
        for same in order.chunk_by(|&s, &t| at(s).0 == at(t).0) {
            made.edges.push(at(same[0]).0);
            made.pieces.extend(same.iter().filter_map(|&it| at(it).1));
            made.piece_start.push(made.pieces.len() as u32);
        }
        made.drop_unused_points();
        made
    }

    /// Renames nodes so that only those remain that an edge uses.
    pub(super) fn drop_unused_points(&mut self) {
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

/// Their places in the order of their keys, which are below `keys`: for keys of which each is on few,
/// so that what is left to sort is short. Equal keys keep their order. O(n + keys).
pub(crate) fn grouped<T>(all: &[T], keys: usize, key: impl Fn(&T) -> usize) -> Vec<u32> {
    let mut next = vec![0_u32; keys + 1];
    for it in all {
        next[key(it) + 1] += 1;
    }
    for k in 0..keys {
        next[k + 1] += next[k];
    }
    let mut order = vec![0_u32; all.len()];
    for (at, it) in (0..).zip(all) {
        let place = &mut next[key(it)];
        order[*place as usize] = at;
        *place += 1;
    }
    order
}

/// The different ones of some points, in order.
pub struct SortedPoints {
    /// Each once.
    pub points: Vec<Point>,
    /// For each given point its place there.
    pub id: Vec<u32>,
}

impl SortedPoints {
    /// O(n log n), and less where long parts of them are in order.
    pub fn of(given: &[Point]) -> SortedPoints {
        let mut order: Vec<(Point, u32)> = given.iter().copied().zip(0..).collect();
        // the stable sort finds such parts
        order.sort();
        let mut points = Vec::with_capacity(given.len());
        let mut id = vec![0; given.len()];
        for (point, old) in order {
            if points.last() != Some(&point) {
                points.push(point);
            }
            id[old as usize] = points.len() as u32 - 1;
        }
        SortedPoints { points, id }
    }
}
