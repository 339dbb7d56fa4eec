//! What becomes of the stretches of lines when an edge is split, contracted or joined to the next.

use smallvec::SmallVec;

use crate::cleanup::attempt::Stations;
use crate::cleanup::edge::Draft;
use crate::cleanup::edge::Pieces;
use crate::cleanup::edge::turned;
use crate::cleanup::graph::Graph;
use crate::cleanup::measure::ROUNDING_M;
use crate::geometry::point::Xy;
use crate::noding::arrangement::Piece;

/// Least share of a stretch that is left to either half when it is split: a stretch of no length
/// would lose its direction, and with it the side of a ring.
const SHARE_LEFT: f64 = 0.05;

/// Where the stretches of a contracted edge went, apart from those that a moving edge took up.
#[derive(Debug, Default)]
pub(super) struct Absorbed {
    /// Pieces of standing edges that become longer: edge, index, the new piece (as stored).
    pub(super) stretched: SmallVec<[(u32, usize, Piece); 2]>,
    /// Lines that ended at both nodes.
    pub(super) lost: Pieces,
}

impl Graph<'_> {
    /// The pieces of `edge` on either side of the place nearest to `p`, both away from `p`.
    pub(super) fn split(&self, edge: u32, p: Xy) -> (Pieces, Pieces) {
        let mut halves = (Pieces::new(), Pieces::new());
        for piece in &self.pieces[edge as usize] {
            let (low, high) = (piece.from_m.min(piece.to_m), piece.from_m.max(piece.to_m));
            let station = self.measure.nearest(piece.line, low, high, p).0;
            let station = kept_inside(station, low, high);
            let line = piece.line;
            halves.0.push(Piece {
                line,
                from_m: station,
                to_m: piece.from_m,
            });
            halves.1.push(Piece {
                line,
                from_m: station,
                to_m: piece.to_m,
            });
        }
        halves
    }

    /// Hands the stretches of the edge `v w` to those that continue them: to edges of `v`, which
    /// move with it, or else to edges of `w`.
    pub(super) fn absorb(&self, edge: u32, v: u32, w: u32, drafts: &mut [Draft]) -> Absorbed {
        let mut absorbed = Absorbed::default();
        for lost in self.pieces_from(edge, v) {
            let mut moving = drafts.iter_mut().flat_map(|draft| draft.pieces.iter_mut());
            if let Some(piece) = moving.find(|piece| continues(piece, &lost)) {
                piece.from_m = lost.to_m;
                continue;
            }
            match self.continuation(&turned(&lost), w, edge, &absorbed) {
                Some(stretched) => absorbed.stretched.push(stretched),
                None => absorbed.lost.push(lost),
            }
        }
        absorbed
    }

    /// The piece at node `w` that goes on where `lost` (away from `w`) ends, made longer by it.
    fn continuation(
        &self,
        lost: &Piece,
        w: u32,
        contracted: u32,
        absorbed: &Absorbed,
    ) -> Option<(u32, usize, Piece)> {
        for &edge in self.star[w as usize]
            .iter()
            .filter(|&&edge| edge != contracted)
        {
            let starts_here = self.edges[edge as usize].ends[0] == w;
            for (k, piece) in self.pieces[edge as usize].iter().enumerate() {
                let away = if starts_here { *piece } else { turned(piece) };
                let taken = (absorbed.stretched.iter()).any(|&(e, i, _)| (e, i) == (edge, k));
                if continues(&away, lost) && !taken {
                    let longer = Piece {
                        from_m: lost.to_m,
                        ..away
                    };
                    let stored = if starts_here { longer } else { turned(&longer) };
                    return Some((edge, k, stored));
                }
            }
        }
        None
    }

    /// True if all stretched pieces are within `share` of their tolerance, and no lost one is longer
    /// than the mesh size, but loops: those may be small and long.
    pub(super) fn absorbed_fits(&self, absorbed: &Absorbed, share: f64) -> bool {
        let stretched = absorbed.stretched.iter().all(|(edge, _, piece)| {
            let (a, b) = self.ends_m(*edge);
            self.measure.fits(piece, a, b, share)
        });
        stretched
            && absorbed.lost.iter().all(|piece| {
                let length_m = (piece.to_m - piece.from_m).abs();
                length_m <= self.measure.size_m[piece.line as usize]
                    || self.measure.is_closed(piece.line)
            })
    }

    /// Finds a home for a stretch that lost its edge: the edge at `w` that it fits best. A line
    /// much shorter than the mesh size lives on with its neighbours this way, if they are not much
    /// longer themselves. False if there is none within tolerance.
    pub(super) fn lodge(&mut self, lost: &Piece, w: u32) -> bool {
        let mut best: Option<(f64, u32, Piece)> = None;
        let limit = self.measure.tolerance_m(lost.line);
        for &edge in &self.star[w as usize] {
            let (a, b) = self.ends_m(edge);
            for piece in [*lost, turned(lost)] {
                let away = self.measure.deviation_m(&piece, a, b);
                if away <= limit && best.is_none_or(|(least, ..)| away < least) {
                    best = Some((away, edge, piece));
                }
            }
        }
        if let Some((_, edge, piece)) = best {
            self.pieces[edge as usize].push(piece);
        }
        best.is_some()
    }

    /// Lines that pass the moving node get there at the station nearest to its new place `p`. False,
    /// with the drafts half done, if one of them surely stays too far away from there.
    pub(super) fn restation(&self, drafts: &mut [Draft], p: Xy, share: f64) -> bool {
        for i in 0..drafts.len() {
            for j in i + 1..drafts.len() {
                let (head, tail) = drafts.split_at_mut(j);
                for one in &mut head[i].pieces {
                    let next = tail[0].pieces.iter_mut().find(|it| continues(it, one));
                    if let Some(other) = next {
                        let (station_m, least_m) = self.passing_m(one, other, p);
                        let limit_m = share * self.measure.tolerance_m(one.line);
                        if least_m > limit_m + ROUNDING_M {
                            return false;
                        }
                        (one.from_m, other.from_m) = (station_m, station_m);
                    }
                }
            }
        }
        true
    }

    /// The same for the edges of node `v` themselves. Returns the stations as they were.
    pub(super) fn restation_star(&mut self, v: u32, p: Xy) -> Stations {
        let star = self.star[v as usize].clone();
        let mut was = Stations::new();
        for (i, &e) in star.iter().enumerate() {
            for k in 0..self.pieces[e as usize].len() {
                let one = self.away(e, k, v);
                let next = star[i + 1..].iter().find_map(|&f| {
                    let all = 0..self.pieces[f as usize].len();
                    let mut all = all.map(|l| (f, l, self.away(f, l, v)));
                    all.find(|(.., it)| continues(it, &one))
                });
                if let Some((f, l, other)) = next {
                    let station_m = self.passing_m(&one, &other, p).0;
                    for (edge, piece) in [(e, k), (f, l)] {
                        let is_end = self.edges[edge as usize].ends[1] == v;
                        was.push((edge, piece as u32, is_end, one.from_m));
                        self.set_stations(&[(edge, piece as u32, is_end, station_m)]);
                    }
                }
            }
        }
        was
    }

    /// A piece of an edge, away from `node`.
    fn away(&self, edge: u32, piece: usize, node: u32) -> Piece {
        let it = &self.pieces[edge as usize][piece];
        if self.edges[edge as usize].ends[0] == node {
            *it
        } else {
            turned(it)
        }
    }

    /// The first of several for one place holds: it was there first.
    pub(super) fn set_stations(&mut self, stations: &[(u32, u32, bool, f64)]) {
        for &(edge, piece, is_end, station_m) in stations.iter().rev() {
            let piece = &mut self.pieces[edge as usize][piece as usize];
            if is_end {
                piece.to_m = station_m;
            } else {
                piece.from_m = station_m;
            }
        }
    }

    /// Where a line passes a node at `p`, and what it is away from there at least; its two pieces
    /// are away from there.
    fn passing_m(&self, one: &Piece, other: &Piece, p: Xy) -> (f64, f64) {
        let (low, high) = (one.to_m.min(other.to_m), one.to_m.max(other.to_m));
        let (station_m, away_m, is_part) =
            (self.measure).nearest_around(one.line, one.from_m, [low, high], p);
        let kept_m = kept_inside(station_m, low, high);
        // the nearest place of a part: elsewhere the line may be nearer
        let is_known = kept_m == station_m && is_part;
        (kept_m, if is_known { away_m } else { 0.0 })
    }

    /// The neighbours `a`, `b` of a node of degree two and the pieces from `a` to `b`: lines that
    /// pass the node are joined; a line that ends there keeps its stretch.
    pub(super) fn passing(&self, v: u32) -> Option<(u32, u32, Pieces)> {
        let &[e, f] = self.star[v as usize].as_slice() else {
            return None;
        };
        let (a, b) = (
            self.edges[e as usize].other(v),
            self.edges[f as usize].other(v),
        );
        let mut rest = self.pieces_from(f, v);
        let mut joined = Pieces::new();
        for piece in self.pieces_from(e, v) {
            let next = rest.iter().position(|it| continues(it, &piece));
            let to_m = next.map_or(piece.from_m, |k| rest.remove(k).to_m);
            joined.push(Piece {
                line: piece.line,
                from_m: piece.to_m,
                to_m,
            });
        }
        joined.extend(rest);
        Some((a, b, joined))
    }

    /// True if every line at a node of degree two passes it.
    pub(super) fn all_pass(&self, v: u32) -> bool {
        let &[e, f] = self.star[v as usize].as_slice() else {
            return false;
        };
        let from = self.pieces_from(e, v);
        let mut rest = self.pieces_from(f, v);
        from.len() == rest.len()
            && from.iter().all(|piece| {
                let next = rest.iter().position(|it| continues(it, piece));
                next.map(|k| rest.remove(k)).is_some()
            })
    }
}

/// True if the pieces, both away from one node, are the two halves of one line that passes there.
fn continues(piece: &Piece, other: &Piece) -> bool {
    piece.line == other.line
        && piece.from_m == other.from_m
        && (piece.to_m > piece.from_m) != (other.to_m > other.from_m)
}

fn kept_inside(station: f64, low: f64, high: f64) -> f64 {
    let left = SHARE_LEFT * (high - low);
    station.clamp(low + left, high - left)
}
