//! What seams keep away from.

use crate::geometry::point::Point;
use crate::noding::arrangement::Arrangement;
use crate::partition::sides;
use crate::partition::subdomains::Partition;
use crate::partition::subdomains::SubdomainId;
use crate::seams::clearance::Buckets;

/// The arrangement to be cut, with what is asked of it again and again.
pub(super) struct Walls<'a> {
    pub arrangement: &'a Arrangement,
    /// The sub-domain on the left of each half-edge.
    pub side: Vec<SubdomainId>,
    /// Edges by place.
    pub buckets: Buckets,
    /// Edge length of the lattice, cells.
    pub pitch: i32,
}

impl Walls<'_> {
    pub fn of<'a>(arrangement: &'a Arrangement, partition: &Partition, pitch: i32) -> Walls<'a> {
        Walls {
            arrangement,
            side: sides(arrangement, partition),
            buckets: Buckets::of(arrangement, 2 * pitch),
            pitch,
        }
    }

    /// The end points of an edge.
    pub fn ends(&self, edge: u32) -> [Point; 2] {
        self.arrangement.edges[edge as usize].map(|node| self.arrangement.points[node as usize])
    }
}
