//! The mesh on disk: a directory of FlatBuffers, written as the mesh is made and read without
//! copying.
//!
//! ```text
//! city.polder/
//!   index          sizes, counts, number bases, checksums; written last
//!   frame          boundary nodes, curves, pieces of lines, sub-domains, certificate
//!   lines          the line work as read, what was changed or dropped, findings
//!   chunk-00000    patches: interior nodes and quads of some sub-domains, 32 to 64 MiB
//!   chunk-00001    ...
//! ```
//!
//! # Promises
//! 1. What looks whole is whole: all is written under `city.polder.partial`, each file under a
//!    temporary name, and renamed when complete and synced; the index comes last.
//! 2. An existing output stays untouched until the new one is complete, and is refused unless the
//!    caller says otherwise.
//! 3. A flipped bit, a cut or a missing file is an [`Error`](error::Error) that names the file and
//!    what to do; never a panic, never a wrong number. Each file ends with its CRC-32.
//! 4. Nothing is written twice: a boundary node's position is in the frame alone, so two patches
//!    cannot disagree about it.
//! 5. Same records, same bytes.
//!
//! # Needs
//! Patches as `meshing` promises them, boundary nodes numbered as in the [`Frame`](frame::Frame).
//!
//! # Method
//! 1. [`writer`]: records -> FlatBuffers (`encode`) -> files (`store`). Global node ids are
//!    arithmetic: boundary nodes first, then interior nodes patch by patch, so a chunk needs to know
//!    nothing of others and the index holds the prefix sums.
//! 2. [`reader`]: files are mapped, verified once (`open`: checksum, FlatBuffers verifier, `shape`
//!    of the vectors) and then seen through plain slices ([`views`]). Chunks are mapped one at a
//!    time, so that memory follows the chunk, not the mesh.
//!
//! The layout is in `schemas/*.fbs`, every field with unit, shape and meaning. `generated` is made
//! from them by `tools/flatc` and checked in.
//!
//! # Cost
//! Writing holds one chunk twice (records and buffer). Reading touches each byte once for the
//! checksum (several GB/s) and keeps one chunk mapped.
//!
//! # Not here
//! Whether the mesh is any good: `check`. Other formats: `export`.

pub mod chains;
pub mod error;
pub mod frame;
pub mod linework;
pub mod moves;
pub mod reader;
pub mod record;
pub mod views;
pub mod writer;

mod encode;
mod generated;
mod open;
mod shape;
mod store;

/// Version of the layout of all files; counted up with every change that old readers would misread.
pub const SCHEMA: u32 = 2;

/// Chunks are closed when they reach this size, bytes. Half of the upper end of 32 to 64 MiB: one
/// more patch, up to the seam budget, still fits below it.
pub const CHUNK_BYTES: usize = 32 << 20;

/// Name of chunk file `number`.
pub fn chunk_name(number: u32) -> String {
    format!("chunk-{number:05}")
}
