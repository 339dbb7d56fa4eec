//! Candidates: stretches of raster lines that could be seams.

use crate::geometry::point::Point;
use crate::partition::subdomains::SubdomainId;
use crate::seams::clearance::Buckets;
use crate::seams::clearance::distance_between;
use crate::seams::ends::End;
use crate::seams::ends::best_end;
use crate::seams::gaps::Gap;
use crate::seams::raster::LatticeLine;
use crate::seams::walls::Walls;

/// Distance between end pieces of different seams, pitches.
pub(super) const ENDS_APART: f64 = 1.2;

/// Pitches from a crossing of the raster to where a seam leaves its line for a wall.
const STRAIGHT_BEFORE_END: i64 = 2;

/// What the side of a cell of the raster costs, in perfect ends: enough that parts along a wall do
/// not become ribbons only to spare ends.
const SIDE_PRICE: f64 = 2.0;

/// One end of a candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stop {
    /// Its last lattice point.
    pub lattice: Point,
    /// The way on to a wall; none at a crossing of the raster.
    pub end: Option<End>,
}

impl Stop {
    /// The end piece, if there is one.
    pub fn piece(&self) -> Option<[Point; 2]> {
        self.end.map(|end| [self.lattice, end.wall])
    }
}

/// A stretch of a raster line that could be a seam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    /// The sub-domain that it cuts.
    pub face: SubdomainId,
    pub on: LatticeLine,
    pub stops: [Stop; 2],
    /// What its ends and its length cost.
    pub price: f64,
}

/// All candidates in `gaps`; their end pieces keep away from each other.
pub(super) fn propose(walls: &Walls, gaps: &[Gap]) -> Vec<Candidate> {
    let mut all: Vec<Candidate> = Vec::new();
    for gap in gaps {
        propose_in(walls, gap, &mut all);
    }
    // Stable: equal prices stay in the order of the gaps.
    all.sort_by(|p, q| p.price.total_cmp(&q.price));
    let apart = ENDS_APART * f64::from(walls.pitch);
    let mut taken: Vec<[Point; 2]> = Vec::new();
    let mut buckets = Buckets::new(4 * walls.pitch);
    all.retain(|candidate| {
        let pieces: Vec<[Point; 2]> = (candidate.stops.iter()).filter_map(Stop::piece).collect();
        let is_free = pieces.iter().all(|&piece| {
            let near = buckets.near(piece, apart);
            (near.iter()).all(|&id| distance_between(piece, taken[id as usize]) >= apart)
        });
        if is_free {
            for piece in pieces {
                buckets.insert(taken.len() as u32, piece);
                taken.push(piece);
            }
        }
        is_free
    });
    all
}

fn propose_in(walls: &Walls, gap: &Gap, all: &mut Vec<Candidate>) {
    let &Gap {
        on,
        first,
        last,
        step,
        ..
    } = gap;
    let crossing = |k: i64| Stop {
        lattice: on.point(k, walls.pitch),
        end: None,
    };
    let ending = |ahead: i64, least: i64| {
        let until = if ahead > 0 { last } else { first };
        best_end(walls, on, ahead, until, least, step).map(|end| Stop {
            lattice: on.point(end.k, walls.pitch),
            end: Some(end),
        })
    };
    let mut add = |from: Option<Stop>, to: Option<Stop>| {
        if let (Some(from), Some(to)) = (from, to) {
            let ends = [from.end, to.end].into_iter().flatten();
            let length = from.lattice.distance(to.lattice) / f64::from(walls.pitch);
            all.push(Candidate {
                face: gap.face,
                on,
                stops: [from, to],
                price: ends.map(|end| end.price).sum::<f64>() + SIDE_PRICE * length / step as f64,
            });
        }
    };
    let low = first.div_euclid(step) + i64::from(first.rem_euclid(step) != 0);
    let high = last.div_euclid(step);
    if low > high {
        // No crossing: from wall to wall, with something straight between.
        let middle = (first + last).div_euclid(2);
        if first < last {
            add(ending(-1, middle), ending(1, middle + 1));
        }
        return;
    }
    add(
        ending(-1, low * step - STRAIGHT_BEFORE_END),
        Some(crossing(low * step)),
    );
    for k in low..high {
        add(Some(crossing(k * step)), Some(crossing((k + 1) * step)));
    }
    add(
        Some(crossing(high * step)),
        ending(1, high * step + STRAIGHT_BEFORE_END),
    );
}
