//! Lines -> the planar arrangement: nodes, edges between them, pieces of lines on each edge.
//!
//! # Promises
//! 1. Edges meet only at nodes, exactly ([`check`](crate::noding::check::check)).
//! 2. No position of a line moves by more than 0.71 cells (half the diagonal of a pixel).
//! 3. Each line is covered from its first point to its last by pieces that join end to end.
//! 4. The arrangement is the same, bit by bit, for any size and order of tiles and any order of
//!    the two segments of a crossing; what is equal or overlaps is one edge with several pieces.
//! 5. After [`clip`](fn@crate::noding::clip) no edge lies outside the domain; every edge of the rim carries ring pieces
//!    that say where the domain is ([`rim`](crate::noding::rim)), no other edge carries one; every stretch of a
//!    constraint line that was cut away is in the list.
//!
//! # Needs
//! Points within ±[`LIMIT`](crate::geometry::point::LIMIT), consecutive ones of a line different;
//! boundary and hole rings closed (`ingest`).
//!
//! # Method
//! Snap rounding: a pixel of the grid is *hot* if it holds a vertex or a crossing, and each segment
//! becomes the chain of centres of the hot pixels that it passes through.
//! 1. `tile`: the tiles of the grid that hold something, each with the segments that pass it.
//! 2. `hot`: hot pixels of one tile and which segments pass through each. A tile owns the pixels of
//!    its half-open window; segments are never cut at its border.
//! 3. `stitch`: the hot pixels of all tiles in order along each segment; edges and pieces.
//! 4. `winding`, `clip`: the side of each edge that lies inside; what lies outside is dropped.
//!
//! After Hobby 1999 and, for the half-open pixels, Guibas and Marimont 1998. Unlike them we find
//! crossings by an R-tree over the segments of a tile: line work of cities has about as many
//! crossings as segments, and a tile needs no event order. Whether a pixel is hot, and who passes
//! it, are exact questions about input segments only; so tiles need no halo and no agreement.
//!
//! # Cost
//! O((n + k) log n) for n segments and k incidences of segments and hot pixels; a segment enters
//! only tiles that it passes. Memory: 8 bytes a segment and tile, 24 an incidence; stitching adds
//! 28 an incidence and 44 a piece for as long as it sorts. After the tiles, nodes are sorted while
//! stretches are made, and parts of the edges find their sides at once.
//!
//! # Not here
//! Anything with a length: near misses, slivers and short ends are `cleanup`'s. Faces are
//! `partition`'s.

use crate::domain::line::Domain;
use crate::noding::arrangement::Arrangement;

pub mod arrangement;
pub mod check;
mod clip;
mod hot;
pub mod rim;
mod stitch;
mod tile;
mod winding;

pub use crate::noding::clip::clip;
pub use crate::noding::clip::clip_to;
pub use crate::noding::hot::Stop;
pub use crate::noding::hot::TileNodes;
pub use crate::noding::hot::node_tile;
pub use crate::noding::stitch::Gathered;
pub use crate::noding::stitch::gather;
pub use crate::noding::stitch::stitch;
pub use crate::noding::tile::Segment;
pub use crate::noding::tile::Tile;
pub use crate::noding::tile::tiles;
pub use crate::noding::winding::Rings;

/// How to cut the work. The result does not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Side of a tile, cells; 1 to 2^29.
    pub tile_cells: i32,
}

/// The arrangement of all lines of `domain`, not yet clipped; one tile after the other.
pub fn node(domain: &Domain, options: &Options) -> Arrangement {
    let tiles = tiles(domain, options);
    let nodes = tiles.iter().map(|tile| node_tile(domain, tile)).collect();
    stitch(domain, nodes)
}
