//! Arrangement -> Partition: curves between junctions, sub-domains with their walks, free lines.
//!
//! # Promises
//! 1. Each side of each edge belongs to exactly one walk of one sub-domain, or to the outside.
//! 2. Each sub-domain has one outer walk of positive area; its other walks (holes, islands, free
//!    lines and trees) have an area of zero or less and lie inside the outer one, in no other
//!    sub-domain.
//! 3. The areas of the sub-domains sum to the area inside the rim, exactly.
//! 4. Every edge lies on exactly one curve; a curve passes no junction inside.
//! 5. The same arrangement gives the same partition, whatever the tiles.
//!
//! # Needs
//! A planar, noded arrangement (`noding::check`), clipped: each edge has the domain on at least one
//! side, and where it has it on one side only, its pieces of rings say which.
//!
//! # Method
//! 1. `star`: the edges around each node, sorted by angle with exact predicates.
//! 2. `walk`: leave each node by the sharpest left turn; a tile is any set of nodes. Walks that
//!    leave it come out as fragments, joined by the half-edge on which one ends and the next begins
//!    (faces of a doubly connected edge list, de Berg and others, chapter 2; but in tiles).
//! 3. `nest`: which sub-domain is an inner walk in? One sweep over x with all edges that cross the
//!    sweep line in vertical order: the edge right below the least node of the walk has it above.
//!    It belongs to an outer walk or to an inner one that began earlier: no union-find is needed.
//! 4. `chain`: maximal chains of edges between junctions become curves. A junction is a node that
//!    is not simply passed through: degree other than 2, change of source lines or of rim, a
//!    corner, any node between two seam edges.
//! 5. `assemble`: walks of half-edges become walks of half-curves, with canonical numbers.
//!
//! `locate` asks the sweep of step 3 where any points lie.
//!
//! # Cost
//! O(n log n) time in n edges, about 120 bytes an edge at the peak. Nesting is one sweep, whatever
//! the number of islands.
//!
//! # Not here
//! Threads (`pipeline` calls [`walk_tile`] in parallel, [`chains`] beside it, and then [`assemble`]); what lines mean;
//! cutting of large sub-domains (`seams`).

pub mod check;
pub mod error;
pub mod subdomains;

mod assemble;
mod chain;
mod locate;
mod nest;
mod star;
mod walk;

use crate::domain::line::Domain;
use crate::noding::arrangement::Arrangement;
use crate::partition::error::Error;
use crate::partition::subdomains::Partition;

pub use assemble::Faces;
pub use assemble::assemble;
pub use assemble::faces;
pub use assemble::remeasure;
pub use chain::Chains;
pub use chain::chains;
pub use locate::sides;
pub use locate::subdomains_at;
pub use star::HalfEdge;
pub use walk::Fragment;
pub use walk::Tile;
pub use walk::TileWalks;
pub use walk::join;
pub use walk::tiles;
pub use walk::walk_tile;

/// What a junction is, and how the work is divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// A chain that turns by more than this ends there, degrees.
    pub corner_deg: f64,
    /// Side of a tile, cells; changes nothing but the division of the work.
    pub tile_cells: u32,
}

/// Walks all tiles, one after the other, and assembles the partition.
pub fn partition(
    domain: &Domain,
    arrangement: &Arrangement,
    options: &Options,
) -> Result<Partition, Error> {
    let walked = tiles(arrangement, options.tile_cells)
        .into_iter()
        .map(|tile| walk_tile(arrangement, tile))
        .collect();
    let faces = faces(domain, arrangement, join(walked))?;
    let chains = chains(domain, arrangement, options.corner_deg);
    Ok(assemble(domain, faces, chains))
}
