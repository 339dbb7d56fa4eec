//! Trial meshes + Arrangement -> Arrangement whose nodes lie where the elements around them are better.
//!
//! Clean-up pushes nodes and edges apart without knowing what elements will lie between them, and
//! meshing may move no node of a line. So the poorest elements of dense line work are those that no
//! node inside a sub-domain can help. Here the nodes of the line work are moved for them.
//!
//! # Promises
//! 1. Topology, ids and counts stay: edges join the same nodes and carry the same lines. Only points
//!    and the stations of stretches change, so points may be out of their order afterwards.
//! 2. What clean-up promises of distances holds: no stretch comes farther from its edge than four fifths of its
//!    tolerance, or than clean-up had left it; no more than .97 % of their length comes farther away than half of it (a
//!    quarter of the size), or than clean-up had left; and what covers a stretch for an edge that is too far away stays.
//!    Corners of the outline and the ends of seams and rungs stay; other nodes of the outline move along it.
//! 3. A node moves by at most [`REACH`] of the size in one round.
//! 4. The poorest quad of the trial meshes is no poorer afterwards, and no edge becomes shorter than
//!    the least that is asked for along the finest line beside it.
//! 5. Same input, same bits. Where clean-up was to change nothing, nothing changes here.
//!
//! # Needs
//! Line work as `cleanup` leaves it, its partition, and counts (`parity`).
//!
//! # Method
//! 1. [`trial`]: each sub-domain is meshed as it will be; kept are the quads at nodes of the line work
//!    (`rings`), from both sides of each line.
//! 2. `search`: nodes at quads of little worth (shape, size and shortest side in one number, that of
//!    `meshing`) are moved by compass search, interior nodes and all other nodes staying, as long as the
//!    least worth around the node grows. Each step is refused unless [`cleanup::shifts`] finds the way
//!    clear and all stretches near enough: within half of their tolerance, but for the poorest quads while lines have
//!    some of their 1 % to spare.
//! 3. The same in a second round, after sub-domains of moderate size that were touched have been
//!    meshed anew.
//!
//! Measured on 36 runs of 18 cities with earlier clean-up, without and with: the 1 % quantile of shapes .703 and .746,
//! their mean .960 and .965, the .1 % quantile of the time-step proxy .397 and .413, of edges .342 and .354, irregular
//! nodes 5.57 and 5.25 %. The displacement that 99 % of the lines stay below grew from .219 to .245 of the size; no run
//! comes beyond a quarter by it. On the twelve with the densest lines the proxy and edges grow by 4 %.
//! One round gains four fifths of it, a third a tenth more. Interior nodes moved along with
//! the others gain nothing. Nodes of the poorest quads moved by up to .4 of the size, however much of the lines that
//! took: 2 % more of the proxy, but .006 more of the displacement.
//!
//! The idea is that of mesh smoothing with boundary nodes on curves (Knupp 2000, algebraic quality
//! measures; here with a tolerance band in place of the curve).
//!
//! # Cost
//! A round meshes, and a second one what the first one touched; nodes move on one core: one to four times the time
//! of meshing in all. Memory: 130 bytes for each quad at a node of the line work or next to one, which follows the
//! input.
//!
//! # Not here
//! Threads (`pipeline` runs trials in parallel). Counts: those of the line work before. The mesh itself:
//! `meshing` makes it anew from where nodes are then.

pub mod check;

mod rings;
mod search;
mod trial;

use crate::cleanup;
use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::noding::arrangement::Arrangement;
use crate::settling::rings::Rings;

pub use crate::settling::search::REACH;
pub use crate::settling::trial::Trial;
pub use crate::settling::trial::trial;

/// Rounds, unless the job says otherwise.
pub const ROUNDS: u32 = 2;

/// Sub-domains with more quads than this are tried once: most of theirs are far from all lines.
pub const LARGE_QUADS: f64 = 2000.0;

/// What one round did.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled {
    /// By node: has it moved?
    pub moved: Vec<bool>,
    /// The least worth of all rings, before and after.
    pub poorest: [f64; 2],
}

impl Settled {
    /// How many nodes have moved.
    pub fn moves(&self) -> usize {
        self.moved.iter().filter(|&&it| it).count()
    }
}

/// Moves the nodes of `arrangement` to where the rings of `trials` are better, the rings with them.
pub fn settle(
    domain: &Domain,
    sizes: &SizeWish,
    options: &cleanup::Options,
    arrangement: &mut Arrangement,
    trials: &mut [Trial],
) -> Settled {
    let mut settled = Settled {
        moved: vec![false; arrangement.points.len()],
        poorest: [f64::INFINITY; 2],
    };
    cleanup::shifts::shift(domain, sizes, options, arrangement, |shifts| {
        let size_at_m: Vec<f64> = (0..shifts.nodes())
            .map(|node| shifts.size_at_m(node))
            .collect();
        let mut rings = Rings::new(trials, &size_at_m);
        let before = rings.poorest();
        settled.moved = search::search(&mut rings, shifts, options.min_edge);
        settled.poorest = [before, rings.poorest()];
        let way = rings.way;
        for ring in trials.iter_mut().flat_map(|it| &mut it.rings) {
            ring.corners = ring.moved(&way);
        }
    });
    settled
}
