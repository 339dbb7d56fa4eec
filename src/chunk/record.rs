//! One patch as it is written, and the receipts for what was written.

use crate::geometry::point::Xy;
use crate::meshing::patch::Method;
use crate::meshing::patch::Patch;
use crate::partition::subdomains::SubdomainId;

/// A patch with global ids for its boundary nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchRecord {
    /// The sub-domain that it fills.
    pub subdomain: SubdomainId,
    /// How it was made.
    pub method: Method,
    /// Quads that the last resort made.
    pub last_resort_quads: u32,
    /// Local node -> global id for the boundary nodes, which have the first local ids.
    pub boundary: Vec<u32>,
    /// Positions of interior nodes, local metres; local ids go on from `boundary`.
    pub interior: Vec<Xy>,
    /// Quads, counter-clockwise, local ids.
    pub quads: Vec<[u32; 4]>,
}

impl PatchRecord {
    /// The record of `patch`, whose first nodes are the boundary nodes with these global ids.
    pub fn new(subdomain: SubdomainId, boundary: Vec<u32>, patch: Patch) -> PatchRecord {
        let mut interior = patch.nodes;
        interior.drain(..boundary.len());
        PatchRecord {
            subdomain,
            method: patch.method,
            last_resort_quads: patch.last_resort_quads,
            boundary,
            interior,
            quads: patch.quads,
        }
    }

    /// What it takes in a chunk file, bytes.
    pub fn bytes(&self) -> usize {
        // 21: a row in each vector that has one row a patch.
        21 + 4 * self.boundary.len() + 16 * (self.interior.len() + self.quads.len())
    }
}

/// What the index says of one patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PatchEntry {
    /// Its sub-domain.
    pub subdomain: SubdomainId,
    /// How it was made, as in `Method`.
    pub method: u8,
    /// Number of interior nodes.
    pub interior: u64,
    /// Number of quads.
    pub quads: u64,
}

/// What `seal` must know of a chunk that was written; can be read again from the file
/// ([`Writer::receipt`](crate::chunk::writer::Writer::receipt)).
#[derive(Clone, Debug, PartialEq)]
pub struct ChunkReceipt {
    /// The chunk's number.
    pub number: u32,
    /// Length of the file, bytes.
    pub bytes: u64,
    /// Its closing CRC-32.
    pub crc32: u32,
    /// Its patches in order.
    pub patches: Vec<PatchEntry>,
    /// Box around its interior nodes, local metres: min x, min y, max x, max y; reversed
    /// infinities if it has none.
    pub box_m: [f64; 4],
}

/// An empty box, ready to be widened.
pub(crate) const NO_BOX: [f64; 4] = [
    f64::INFINITY,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NEG_INFINITY,
];

/// `box_m` widened to hold `points`.
pub(crate) fn widened(mut box_m: [f64; 4], points: &[Xy]) -> [f64; 4] {
    for p in points {
        box_m[0] = box_m[0].min(p[0]);
        box_m[1] = box_m[1].min(p[1]);
        box_m[2] = box_m[2].max(p[0]);
        box_m[3] = box_m[3].max(p[1]);
    }
    box_m
}
