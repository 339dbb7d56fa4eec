//! A mesh in the making: what each method hands to the finish.

use crate::geometry::point::Xy;
use crate::meshing::patch::Method;

/// A quad mesh over [`Visits`](crate::meshing::visits::Visits), not yet promised to be well shaped
/// or even valid.
///
/// Combinatorially sound: its edges used once are exactly the edges of the walks, all others are
/// used twice in opposite directions.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Draft {
    /// The visits, then interior nodes, metres.
    pub nodes: Vec<Xy>,
    /// Number of visits: these nodes never move.
    pub visits: usize,
    /// Quads, counter-clockwise, indices into `nodes`.
    pub quads: Vec<[u32; 4]>,
    /// `quads[..settled]` are perfect lattice cells far from the walk: they keep their shape, and
    /// so do all their nodes. The finish works on the others.
    pub settled: usize,
    /// The method that made it.
    pub method: Method,
}
