//! What meshing gets and gives: the discretised walks of one sub-domain, and its mesh.

use crate::boundary::walks::Walks;
use crate::geometry::point::Xy;

/// The discretised walks of one sub-domain.
///
/// Promised by `boundary`: the walks are planar with each other and simple, except that free lines
/// are walked on both sides (a node then occurs several times); walk 0 is the outer one and runs
/// counter-clockwise, the others clockwise: the sub-domain is always on the left. The total number
/// of edges over all walks is even and at least 4. An isolated free line is a walk of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Loops {
    /// The distinct boundary nodes, metres. Two entries never have the same position.
    pub nodes: Vec<Xy>,
    /// Walks as closed sequences of indices into `nodes` (the first is not repeated at the end).
    pub walks: Vec<Vec<u32>>,
    /// Wished edge length in the interior, metres.
    pub size_m: f64,
    /// Set if the sub-domain is a part of a larger one that was cut by seams: lattice nodes must
    /// then lie at whole multiples of `size_m` from this point (axis-aligned), as the seams' do.
    pub lattice_origin: Option<Xy>,
    /// For each walk, for each of its edges `walk[k] -> walk[k + 1]`: true if it lies on a seam.
    pub on_seam: Vec<Vec<bool>>,
    /// For each walk, for each of its edges: how deep the quads across it are likely to be, metres; 0 if that is
    /// unknown or there are none. May be empty.
    pub across_m: Vec<Vec<f64>>,
}

impl Loops {
    /// The walks of `boundary`, with this wished edge length.
    pub fn of(walked: &Walks, size_m: f64) -> Loops {
        let is_part = walked.on_seam.iter().flatten().any(|&it| it);
        Loops {
            nodes: walked.nodes.clone(),
            walks: walked.walks.clone(),
            size_m,
            lattice_origin: is_part.then_some([0.0, 0.0]),
            on_seam: walked.on_seam.clone(),
            across_m: walked.across_m.clone(),
        }
    }
}

/// How a patch was made. The order is that of the tables in the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Method {
    /// One pattern over the whole: by sides and counts, or from the catalogue of small loops.
    Mapping = 0,
    /// Recursive splitting by the best line down to loops of four or six nodes.
    Looping = 1,
    /// Lattice core with a strip of matched triangles to the walk.
    Strip = 2,
    /// Matched triangles of a constrained triangulation, no core.
    Indirect = 3,
    /// The method that cannot fail: pairs of triangles, each with a ring of its own.
    LastResort = 4,
}

impl Method {
    /// The methods' names, by number, as exports and summaries write them.
    pub const NAMES: [&'static str; 5] = ["mapping", "looping", "strip", "indirect", "last_resort"];
}

/// The mesh of one sub-domain.
///
/// Promises: `nodes[..loops.nodes.len()]` are the boundary nodes, unmoved; every quad is
/// counter-clockwise with four positive corner Jacobians; the edges used once are exactly the edges
/// of the walks (an edge of a free line is used by two quads, one from each side).
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Boundary nodes as given, then interior nodes, metres.
    pub nodes: Vec<Xy>,
    /// Quads, counter-clockwise, indices into `nodes`.
    pub quads: Vec<[u32; 4]>,
    /// The method that won.
    pub method: Method,
    /// Quads that the last resort made: all of them if it won, else those in the holes that it
    /// filled where the winner failed.
    pub last_resort_quads: u32,
}
