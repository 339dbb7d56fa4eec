//! Which curves lie around each sub-domain.

use crate::partition::subdomains::OUTSIDE;
use crate::partition::subdomains::Partition;

/// Curves by the sub-domains on their sides.
pub struct Around {
    /// (sub-domain, curve), sorted.
    entries: Vec<(u32, u32)>,
}

impl Around {
    /// Of those curves that are `wanted`.
    pub fn of(partition: &Partition, wanted: impl Fn(usize) -> bool) -> Around {
        let mut entries = Vec::new();
        for (id, curve) in partition.curves.iter().enumerate() {
            if wanted(id) {
                let sides = [curve.left, curve.right].into_iter();
                let inside = sides.filter(|&side| side != OUTSIDE);
                entries.extend(inside.map(|side| (side, id as u32)));
            }
        }
        entries.sort_unstable();
        Around { entries }
    }

    /// The curves around one sub-domain, in the order of their ids; none around the outside.
    pub fn curves(&self, subdomain: u32) -> impl Iterator<Item = u32> {
        let from = self.entries.partition_point(|it| it.0 < subdomain);
        let to = self.entries.partition_point(|it| it.0 <= subdomain);
        self.entries[from..to].iter().map(|it| it.1)
    }
}
