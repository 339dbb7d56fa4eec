//! Partition + SizeWish -> Arrangement with rungs: short seams straight across narrow places.
//!
//! Where two lines run side by side, nearer than a size, there is room for one row of quads, and
//! only if the nodes on one side face those on the other. Left to themselves the two sides have
//! nodes where their own corners and junctions are, and counts that may differ by two: the mesher
//! has to fill such a place with half rows and irregular nodes. A rung from each node to the place
//! that faces it makes a ladder of blocks. Each is a sub-domain of its own, so parity lets the
//! counts of its two sides differ by even numbers only, both have the same wish, and so nearly all
//! are mapped.
//!
//! # Promises
//! 1. A rung is one edge without pieces between two nodes of lines, .25 to
//!    [`Options::longest`] sizes long; the size is the least of the default and of those of the lines
//!    at its ends. From and to feet of other rungs it is no longer than [`RUN_ON`].
//! 2. At both ends it leaves 50 degrees or more to each neighbour, and it keeps 0.3 sizes away from
//!    every edge that it does not touch.
//! 3. A line is split only at a rung's end, 0.4 sizes or more from the ends of its edge; it moves
//!    by the rounding to the grid, less than a cell.
//! 4. Each walk of up to [`LONGEST_WALK`] edges that a rung closes has four corners or more, or it is a
//!    long tip: the rung is short enough for one interval ([`ONE_ROW`]), and the other two of its three
//!    sides are [`LONG`]. A lesser triangle would need two intervals on the rung. (Without this, the
//!    1 % quantile of the scaled Jacobian falls by .01 to .02, and the time-step proxy by a quarter;
//!    without long tips, both are up to 3 % less where streets meet at acute angles.)
//! 5. Nodes, lines and tags are as before; the same input gives the same rungs.
//! 6. There are not more small odd rooms than before: walks of at most [`SMALL_WALK`] edges, together
//!    shorter than [`AROUND`] sizes, whose number is odd. Parity would have to halve a short edge of
//!    each, and of every room on the way to the next odd one. (Measured on eight cities: the .1 %
//!    quantile of the time-step proxy grows by up to 7 %, that of edges by up to 3 %, and up to 1 % of
//!    the quads go; the 1 % quantile of shapes grows or falls by up to .006. For larger rooms, too, it falls by
//!    .01 to .02.)
//!
//! # Needs
//! A cleaned arrangement, with or without lattice seams, and its partition.
//!
//! # Method
//! 1. `propose`: from each node with room, the edges near it.
//! 2. `ladder`: takes them one by one, the shortest first, and lays those that keep the promises
//!    with all laid before; those that break the last one only come again at the end. A rung goes to the foot of its node, or to the end of the edge if that
//!    is near. `web`: the faces as half-edges that can be split and bridged, so that the walks that
//!    a rung would close are known before it is laid.
//!
//! # Cost
//! O(n log n) in the edges; about 100 bytes an edge while it runs. On a city of 70 000 curves and 9000
//! rungs, the user CPU of whole builds (10M quads, two runs each) is the same with and without.
//!
//! # Not here
//! Counts on rungs (`intervals`: nearly always one). Long seams through open country (`seams`).

pub mod check;

mod ladder;
mod propose;
mod web;

use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::Partition;
use crate::rungs::ladder::Ladder;
use crate::rungs::propose::propose;
use crate::seams::pitch_cells;

/// How narrow a place must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Longest rung, sizes; none are laid if it is zero. Above about one, a place has room for two
    /// rows.
    pub longest: f64,
    /// Edges that turn by more than this are two sides of a block, as `intervals` has it, degrees.
    pub corner_deg: f64,
}

/// The arrangement with rungs.
#[derive(Clone, Debug, PartialEq)]
pub struct Runged {
    /// As given, with lines split where rungs end, and with the rungs.
    pub arrangement: Arrangement,
    /// Number of rungs.
    pub rungs: u64,
}

/// A rung leaves at least this angle to each neighbour at both ends, degrees. Wider ones find
/// fewer places, narrower ones make skewed blocks.
pub(crate) const ANGLE_DEG: f64 = 50.0;

/// Shortest rung, sizes: no mesh edge should be shorter.
pub(crate) const SHORTEST: f64 = 0.25;

/// What a rung keeps from edges that it does not touch, sizes.
pub(crate) const CLEAR: f64 = 0.3;

/// A foot nearer than this to an end of its edge gives way to that end, sizes. Measured on four
/// cities from .33 to .6: smaller means more rungs, squarer blocks and more short edges.
pub(crate) const SNAP: f64 = 0.4;

/// Longest walk whose corners are counted; along longer ones they must be found within it.
pub const LONGEST_WALK: usize = 256;

/// A block has at least so many corners.
pub(crate) const CORNERS: usize = 4;

/// The longest side across the wide end of a tip that is given one interval, sizes.
pub const ONE_ROW: f64 = 0.75;

/// The least length of the other two sides of a tip whose wide end has one interval, sizes: nearer
/// to the tip the row becomes two, because a tip has one corner. Figures are the same from 2 to 6.
pub const LONG: f64 = 3.0;

/// The longest rung from a foot or to one, sizes. Measured on six cities: up to .8 there are more irregular
/// nodes beside open country, and without any the mean of dense places is .002 less.
pub const RUN_ON: f64 = 0.65;

/// A walk of at most so many edges, together shorter than [`AROUND`], is a small room: each edge has
/// one interval, so that parity must halve one if they are odd in number.
pub const SMALL_WALK: usize = 8;

/// The circumference of a small room, sizes: in a larger one, half an edge makes no tiny cells.
pub const AROUND: f64 = 3.0;

/// Lays rungs wherever they fit.
pub fn lay(
    domain: &Domain,
    sizes: &SizeWish,
    arrangement: &Arrangement,
    partition: &Partition,
    options: &Options,
) -> Runged {
    if options.longest <= SHORTEST {
        return Runged {
            arrangement: arrangement.clone(),
            rungs: 0,
        };
    }
    let size_of = edge_sizes(domain, sizes, arrangement);
    let mut ladder = Ladder::new(arrangement, partition, &size_of, options);
    let given = arrangement.points.len() as u32;
    ladder.lay_all(propose(&ladder, 0..given));
    let feet = given..ladder.web.points.len() as u32;
    ladder.lay_all(propose(&ladder, feet));
    Runged {
        rungs: ladder.rungs() as u64,
        arrangement: ladder.arrangement(),
    }
}

/// The size at each edge, cells: the least of its lines' and the default one.
pub(crate) fn edge_sizes(domain: &Domain, sizes: &SizeWish, arrangement: &Arrangement) -> Vec<f64> {
    let default = f64::from(pitch_cells(domain, sizes));
    let size_of = |edge: u32| {
        let pieces = arrangement.pieces_of(edge).iter();
        let kinds = pieces.map(|piece| domain.lines[piece.line as usize].kind);
        kinds
            .map(|kind| sizes.by_kind_m[usize::from(kind)] / domain.grid.cell_m)
            .fold(default, f64::min)
    };
    (0..arrangement.edges.len() as u32).map(size_of).collect()
}
