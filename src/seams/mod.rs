//! Partition + SizeWish -> Arrangement with large sub-domains cut into parts.
//!
//! # Promises
//! 1. A part has at most 1.5 x `budget_quads` quads, or there is a finding with its place.
//! 2. Each seam is a polyline from wall to wall or to another seam: along the lattice (points whose
//!    coordinates are multiples of the pitch, axis-aligned lines) but for an end piece of 0.9 to
//!    2.4 sizes at each wall; all its nodes but those on walls are lattice points.
//! 3. An end piece meets the edges at its wall node at 50 degrees or more, at 60 or more where it
//!    splits an edge, and then no nearer to the ends of the edge than 0.8 sizes; it turns off the
//!    lattice by at most 75 degrees. A wall node has at most one seam.
//! 4. On the lattice, a seam keeps 1.2 sizes away from all walls, and end pieces keep 1.2 sizes
//!    away from each other.
//! 5. Lines and sub-domains below the budget are as before; the area is, but for the rounding of
//!    nodes on slanted edges of the rim (less than a cell across).
//!
//! # Needs
//! An arrangement after `cleanup` and its partition.
//!
//! # Method
//! The largest faces of a city are full of slits, islands and bays, so no single straight cut is
//! good at both ends. We propose many more cuts than needed, all of them good, and drop most:
//! 1. `gaps`: a raster of lattice lines, eight or more pitches apart; on each the stretches farther
//!    than 1.25 sizes from all walls of large sub-domains. Computed from the walls near the line,
//!    never from lattice points, so that the cost does not follow the number of quads.
//! 2. `ends`: where a stretch comes near a wall, the best way to it among its nodes and places on
//!    its edges; a price for bad angles, bends and lengths.
//! 3. `propose`: stretches between crossings of the raster and ends at walls are the candidates; of
//!    two whose ends are near each other the cheaper one stays.
//! 4. `cells`, `merge`: the candidates divide the faces into small cells; the smallest cell joins
//!    the neighbour with which it shares the costliest candidates, again and again, while the
//!    budget holds. What still lies between two parts is kept.
//! 5. `splice`: kept seams become edges without pieces, walls are split at their ends.
//!
//! Faces of which a part stays too large are done again with a finer raster.
//!
//! # Cost
//! O(n log n) time and memory in the edges and the cells of the raster, about one per 2000 quads.
//!
//! # Not here
//! Counts on seams (`intervals`: a seam edge between lattice points is fixed), their nodes
//! (`boundary`), the lattice inside the parts (`meshing`).

pub mod check;

mod cells;
pub mod clearance;
mod ends;
mod gaps;
mod merge;
mod propose;
mod raster;
mod splice;
mod walls;

use crate::domain::finding::Finding;
use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::Partition;
use crate::seams::cells::Cells;
use crate::seams::cells::quads;
use crate::seams::gaps::gaps;
use crate::seams::merge::merge;
use crate::seams::propose::Candidate;
use crate::seams::propose::propose;
use crate::seams::raster::steps;
use crate::seams::splice::joined_straights;
use crate::seams::splice::splice;
use crate::seams::walls::Walls;

/// How large a part may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Quads that a part should have at most; more than 1.5 times as many are a finding.
    pub budget_quads: f64,
}

/// The arrangement with seams.
#[derive(Clone, Debug, PartialEq)]
pub struct Seamed {
    /// As given, with walls split where seams end and with seam edges.
    pub arrangement: Arrangement,
    /// Number of seam edges.
    pub cuts: u64,
    /// Parts that are still too large.
    pub findings: Vec<Finding>,
}

/// The most that a part may have, in budgets, by its area: a mesh has up to 7 % more quads than
/// area / size², and none may have more than 1.5 budgets.
const SLACK: f64 = 1.4;

/// Edge length of the lattice, cells: the default size in whole cells. Lattice points are its
/// multiples; so are those of the parts' meshes.
pub fn pitch_cells(domain: &Domain, sizes: &SizeWish) -> i32 {
    (sizes.default_m / domain.grid.cell_m)
        .round()
        .clamp(1.0, f64::from(1 << 29)) as i32
}

/// Cuts every sub-domain of more than [`SLACK`] budgets.
pub fn cut(
    domain: &Domain,
    sizes: &SizeWish,
    arrangement: &Arrangement,
    partition: &Partition,
    options: &Options,
) -> Seamed {
    let pitch = pitch_cells(domain, sizes);
    let most = SLACK * options.budget_quads;
    // Which raster a face has, coarse ones first; none for a face that is small enough.
    let mut level: Vec<Option<usize>> = (partition.subdomains.iter())
        .map(|face| (quads(domain, pitch, face) > most).then_some(0))
        .collect();
    if level.iter().all(Option::is_none) {
        return Seamed {
            arrangement: arrangement.clone(),
            cuts: 0,
            findings: Vec::new(),
        };
    }
    let steps = steps(options.budget_quads);
    let walls = Walls::of(arrangement, partition, pitch);
    let (candidates, cells) = loop {
        let step: Vec<Option<i64>> = level.iter().map(|it| it.map(|it| steps[it])).collect();
        let candidates = propose(&walls, &gaps(&walls, partition, &step));
        let cells = Cells::of(domain, arrangement, &candidates, pitch);
        if !refine(&mut level, steps.len(), &candidates, &cells, most) {
            break (candidates, cells);
        }
    };
    let part = merge(&cells.quads, &cells.borders, options.budget_quads, SLACK);
    let between_parts = candidates.iter().zip(&cells.borders).filter(|(_, border)| {
        let [left, right] = border.cells.map(|cell| part[cell as usize]);
        left != right
    });
    let kept: Vec<Candidate> = between_parts.map(|(&candidate, _)| candidate).collect();
    let arrangement = splice(arrangement, &kept, &joined_straights(&kept));
    let cuts = (arrangement.piece_start.windows(2)).filter(|it| it[0] == it[1]);
    Seamed {
        cuts: cuts.count() as u64,
        findings: cells.too_large(domain, &part, most),
        arrangement,
    }
}

/// Gives a finer raster to each face with a cell of more than `most` quads; false if there is none
/// that could have it.
fn refine(
    level: &mut [Option<usize>],
    levels: usize,
    candidates: &[Candidate],
    cells: &Cells,
    most: f64,
) -> bool {
    // A face without candidates is a cell itself.
    let mut is_too_large: Vec<bool> = level.iter().map(Option::is_some).collect();
    for candidate in candidates {
        is_too_large[candidate.face as usize] = false;
    }
    for (candidate, border) in candidates.iter().zip(&cells.borders) {
        let mut sizes = border.cells.iter().map(|&cell| cells.quads[cell as usize]);
        is_too_large[candidate.face as usize] |= sizes.any(|quads| quads > most);
    }
    let mut is_finer = false;
    for (at, is_too_large) in level.iter_mut().zip(is_too_large) {
        if let Some(at) = at
            && is_too_large
            && *at + 1 < levels
        {
            *at += 1;
            is_finer = true;
        }
    }
    is_finer
}
