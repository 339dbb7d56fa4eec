//! The four operations on the graph, each refused unless it is legal: the way is clear, and every
//! stretch of input that it touches stays within tolerance of its edge.

use smallvec::SmallVec;
use smallvec::smallvec;

use crate::cleanup::attempt::Deed;
use crate::cleanup::changes::Reason;
use crate::cleanup::clear::Room;
use crate::cleanup::clear::Sweep;
use crate::cleanup::edge::Draft;
use crate::cleanup::edge::Fused;
use crate::cleanup::graph::Graph;
use crate::cleanup::measure::NEAR;
use crate::cleanup::measure::ROUNDING_M;
use crate::cleanup::stations::Absorbed;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::geometry::predicates::orient;
use crate::noding::arrangement::Piece;

/// What a bent edge is bent to.
#[derive(Clone, Copy, Debug)]
pub(super) enum Bend {
    /// A node that is there.
    To(u32),
    /// A new node at a free point.
    At(Point),
}

/// What became of a node that was to move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shift {
    Done,
    /// Stretches would be too far away.
    Unfit,
    /// It may not lie there, whatever its stretches allow.
    Blocked,
}

type Drafts = SmallVec<[Draft; 6]>;

impl Graph<'_> {
    /// Moves node `v` to the free point `p`. `share`: of the tolerance.
    pub(super) fn shift(&mut self, v: u32, p: Point, share: f64) -> bool {
        self.try_shift(v, p, share) == Shift::Done
    }

    /// The same, telling why not.
    pub(super) fn try_shift(&mut self, v: u32, p: Point, share: f64) -> Shift {
        let measure = self.measure;
        self.shift_if(v, p, |piece, a, b| measure.fits(piece, a, b, share))
    }

    /// The same with a share above [`NEAR`] of it, if no more than `most_m` of its stretches comes farther away than
    /// that.
    pub(super) fn shift_near(&mut self, v: u32, p: Point, share: f64, most_m: f64) -> Shift {
        let measure = self.measure;
        let mut left_m = most_m + ROUNDING_M;
        self.shift_if(v, p, |piece, a, b| {
            let Some(away_m) = measure.deviation_within_m(piece, a, b, share) else {
                return false;
            };
            if away_m > NEAR * measure.tolerance_m(piece.line) {
                left_m -= measure.parts_beyond_m(piece, a, b);
            }
            left_m >= 0.0
        })
    }

    /// How much of the stretches at a node is farther away than half of their tolerance, metres.
    pub(super) fn beyond_m(&self, node: u32) -> f64 {
        let star = self.star[node as usize].iter();
        star.map(|&edge| self.edge_beyond_m(edge)).sum()
    }

    /// The same of an edge.
    pub(super) fn edge_beyond_m(&self, edge: u32) -> f64 {
        let (a, b) = self.ends_m(edge);
        let pieces = self.pieces[edge as usize].iter();
        pieces.map(|piece| self.measure.beyond_m(piece, a, b)).sum()
    }

    /// Moves node `v` to the free point `p` if `fits` holds for all its stretches and the edges that
    /// they would have, asked in the order of its star.
    pub(super) fn shift_if(
        &mut self,
        v: u32,
        p: Point,
        fits: impl FnMut(&Piece, Xy, Xy) -> bool,
    ) -> Shift {
        if p == self.point(v) || !self.is_free(v) || !self.reaches(p) {
            return Shift::Blocked;
        }
        let stations = self.restation_star(v, self.measure.metres(p));
        let fits = self.star_fits(v, p, fits);
        if !fits || !self.star_is_clear(v, p, &self.neighbours(v), Some(p)) {
            self.set_stations(&stations);
            return if fits { Shift::Blocked } else { Shift::Unfit };
        }
        let from = self.point(v);
        self.place(v, p);
        self.touch(v);
        for end in self.neighbours(v) {
            self.touch(end);
        }
        self.did(Deed::Shifted {
            node: v,
            from,
            stations,
        });
        Shift::Done
    }

    /// True if all stretches at `v` fit when it is at `p`.
    fn star_fits(&self, v: u32, p: Point, mut fits: impl FnMut(&Piece, Xy, Xy) -> bool) -> bool {
        let p = self.measure.metres(p);
        self.star[v as usize].iter().all(|&edge| {
            let it = &self.edges[edge as usize];
            let [a, b] = it
                .ends
                .map(|end| if end == v { p } else { self.metres(end) });
            let mut pieces = self.pieces[edge as usize].iter();
            pieces.all(|piece| fits(piece, a, b))
        })
    }

    /// False if node `v` cannot be merged with any node at `p` that it has no edge to, as stretches
    /// would be too far away.
    pub(super) fn would_fit(&self, v: u32, p: Point, share: f64) -> bool {
        let mut drafts = self.drafts(v);
        self.is_free(v)
            && self.restation(&mut drafts, self.measure.metres(p), share)
            && self.all_fit(&drafts, p, share)
    }

    /// Moves node `v` onto node `w`: an edge between them is contracted, edges to the same
    /// neighbour become one.
    pub(super) fn merge(&mut self, v: u32, w: u32, share: f64) -> bool {
        if !self.is_free(v) || !self.is_free(w) {
            return false;
        }
        let (q, p) = (self.point(v), self.point(w));
        let contracted = self.find(v, w);
        let along_rim = contracted.is_some_and(|edge| self.edges[edge as usize].is_rim());
        if !along_rim && self.is_on_rim(v) && self.is_on_rim(w) {
            return false;
        }
        let mut drafts = self.drafts(v);
        drafts.retain(|draft| draft.to != w);
        let absorbed = contracted.map_or_else(Absorbed::default, |edge| {
            self.absorb(edge, v, w, &mut drafts)
        });
        if !self.restation(&mut drafts, self.measure.metres(p), share) {
            return false;
        }
        let ends: SmallVec<[u32; 6]> = drafts.iter().map(|draft| draft.to).collect();
        if !self.all_fit(&drafts, p, share)
            || !self.absorbed_fits(&absorbed, share)
            || !self.star_is_clear(v, p, &ends, None)
        {
            return false;
        }
        let Some(fused) = self.fusions(w, &drafts, |to| orient(p, to, q) > 0) else {
            return false;
        };
        let gone: SmallVec<[u32; 6]> = self.star[v as usize].iter().copied().collect();
        for &edge in &gone {
            self.remove(edge);
        }
        for (edge, k, piece) in absorbed.stretched {
            self.pieces[edge as usize][k] = piece;
        }
        for (draft, fused) in drafts.into_iter().zip(fused) {
            self.add_or_fuse(w, draft, fused);
        }
        for piece in absorbed.lost {
            if !self.lodge(&piece, w) {
                let reason = self.reason_for(piece.line);
                self.drop_piece(&piece, reason);
            }
        }
        true
    }

    /// True if an edge of the outline ends at `node`. Two such nodes only become one along the
    /// outline: elsewhere the domain would touch itself in a point, a door that is no door.
    pub(super) fn is_on_rim(&self, node: u32) -> bool {
        let star = self.star[node as usize].iter();
        star.into_iter()
            .any(|&edge| self.edges[edge as usize].is_rim())
    }

    /// Replaces an edge by two that meet in `bend`; returns the node there.
    pub(super) fn bend(&mut self, edge: u32, bend: Bend, share: f64) -> Option<u32> {
        let [a, b] = self.edges[edge as usize].ends;
        let (a_at, b_at) = (self.point(a), self.point(b));
        let (p, vacant) = match bend {
            Bend::To(node) => (self.point(node), None),
            Bend::At(p) => (p, Some(p)),
        };
        if !self.is_there(edge) || p == a_at || p == b_at || !self.may_bend(edge, bend) {
            return None;
        }
        if let Bend::To(node) = bend
            && self.edges[edge as usize].is_rim()
            && self.is_on_rim(node)
            && self.find(node, a).or(self.find(node, b)).is_none()
        {
            return None;
        }
        let (to_a, to_b) = self.split(edge, self.measure.metres(p));
        let inside = self.edges[edge as usize].inside;
        let drafts: Drafts = smallvec![
            Draft {
                to: a,
                pieces: to_a,
                inside: [inside[1], inside[0]],
            },
            Draft {
                to: b,
                pieces: to_b,
                inside,
            },
        ];
        let sweep = Sweep {
            triangle: [a_at, b_at, p],
            fresh: smallvec![(a_at, p), (p, b_at)],
        };
        let room = Room {
            gone: &[edge],
            mover: None,
            vacant,
        };
        if !self.all_fit(&drafts, p, share) || !self.is_clear(&[sweep], &room) {
            return None;
        }
        let fused = match bend {
            Bend::At(_) => smallvec![None, None],
            // seen along the new edge from p to one end, the old edge was on the side of the other
            Bend::To(node) => self.fusions(node, &drafts, |to| {
                let other = if to == a_at { b_at } else { a_at };
                orient(p, to, other) > 0
            })?,
        };
        if !gains(
            &fused,
            [p.distance2(a_at), p.distance2(b_at)],
            a_at.distance2(b_at),
        ) {
            return None;
        }
        self.remove(edge);
        let node = match bend {
            Bend::To(node) => node,
            Bend::At(p) => self.add_node(p),
        };
        for (draft, fused) in drafts.into_iter().zip(fused) {
            self.add_or_fuse(node, draft, fused);
        }
        Some(node)
    }

    /// Removes a node of degree two that all lines at it pass; returns the edge that replaces its
    /// two. With `close`, that edge may fall onto one that is there.
    pub(super) fn straighten(&mut self, v: u32, share: f64, close: bool) -> Option<u32> {
        let (a, b, pieces) = self.is_free(v).then(|| self.passing(v))??;
        let (p, q) = (self.point(a), self.point(b));
        let chord = (self.metres(a), self.metres(b));
        let fits = |piece| self.measure.fits(piece, chord.0, chord.1, share);
        if (!close && self.find(a, b).is_some()) || !pieces.iter().all(fits) {
            return None;
        }
        let [e, f] = [self.star[v as usize][0], self.star[v as usize][1]];
        let leaving = if self.edges[e as usize].other(v) == b {
            e
        } else {
            f
        };
        let draft = Draft {
            to: b,
            pieces,
            inside: self.edges[leaving as usize].inside_from(v),
        };
        let at = self.point(v);
        let sweep = Sweep {
            triangle: [p, q, at],
            fresh: smallvec![(p, q)],
        };
        let room = Room {
            gone: &[e, f],
            mover: Some(at),
            vacant: None,
        };
        if !self.is_clear(&[sweep], &room) {
            return None;
        }
        let on_left = orient(p, q, at) > 0;
        let fused = self.fuse(a, &draft, on_left).ok()?;
        self.remove(e);
        self.remove(f);
        Some(self.add_or_fuse(a, draft, fused))
    }

    fn may_bend(&self, edge: u32, bend: Bend) -> bool {
        let is_in = match bend {
            Bend::To(node) => self.is_free(node),
            Bend::At(p) => self.reaches(p),
        };
        is_in && self.may_change(edge)
    }

    /// The edges of `v` as drafts away from it.
    fn drafts(&self, v: u32) -> Drafts {
        let star = self.star[v as usize].iter();
        star.map(|&edge| {
            let it = &self.edges[edge as usize];
            Draft {
                to: it.other(v),
                pieces: self.pieces_from(edge, v),
                inside: it.inside_from(v),
            }
        })
        .collect()
    }

    fn all_fit(&self, drafts: &[Draft], from: Point, share: f64) -> bool {
        let a = self.measure.metres(from);
        drafts.iter().all(|draft| {
            let b = self.metres(draft.to);
            (draft.pieces.iter()).all(|piece| self.measure.fits(piece, a, b, share))
        })
    }

    /// For each draft at `node` the edge that takes it up; `None` if that may not be.
    fn fusions(
        &self,
        node: u32,
        drafts: &[Draft],
        on_left: impl Fn(Point) -> bool,
    ) -> Option<SmallVec<[Option<Fused>; 6]>> {
        let fused = drafts.iter().map(|draft| {
            let end = self.point(draft.to);
            self.fuse(node, draft, on_left(end))
        });
        fused.collect::<Result<_, ()>>().ok()
    }

    fn reason_for(&self, line: u32) -> Reason {
        if self.measure.is_closed(line) {
            Reason::SmallLoop
        } else {
            Reason::ShortEnd
        }
    }
}

/// An edge that falls onto one side of its triangle only flips over to the other side. It might
/// flip back, unless it must become shorter each time.
fn gains(fused: &[Option<Fused>], sides2: [i64; 2], before2: i64) -> bool {
    match fused {
        [Some(_), None] => sides2[1] < before2,
        [None, Some(_)] => sides2[0] < before2,
        _ => true,
    }
}
