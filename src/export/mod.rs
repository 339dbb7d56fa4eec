//! Mesh on disk -> files of solvers and of GIS.
//!
//! # Promises
//! 1. The file has its name only when it is complete and synced; whatever fails leaves nothing.
//! 2. Node n of every format is global node n of the mesh (counted from 1 where a format does so),
//!    quad q is quad q, in the order of the chunks; coordinates are projected metres.
//! 3. Same mesh, same bytes.
//!
//! # Needs
//! A mesh that [`Mesh::open`] accepts.
//!
//! # Method
//! One file of code a format, each streamed from the mapped chunks:
//! - `ugrid`: UGRID-1.0 in classic NetCDF (`convention` says what is in it, `classic` encodes that,
//!   `edges` lists the edges with the line along each), for D-Flow FM, QGIS,
//!   xugrid. Classic, because readers misread some UGRID files in HDF5; CDF-2 while every variable
//!   stays below 4 GiB, CDF-5 beyond.
//! - `sms`: .2dm for SMS, TUFLOW FV, BASEMENT, with a node string for each chain of each line.
//! - `lines`: GeoJSON of every source line as meshed; QGIS drops edge tags of mesh files, so this is
//!   what shows them. As cleaned it is line work again: with the outline as polygons, without the
//!   nodes that seams made, and with the places that clean-up had to leave, so that a build from it
//!   finds it clean and changes nothing.
//! - `changes`: GeoJSON of what was dropped and changed.
//!
//! # Cost
//! One pass over the chunks (two for .2dm), at about the speed of the disk. Memory: the frame and
//! one chunk.
//!
//! # Not here
//! Pictures: `report`.

pub mod error;

mod changes;
mod classic;
mod convention;
mod destination;
mod edges;
mod lines;
mod outline;
mod sms;
mod ugrid;

use crate::chunk::reader::Mesh;
use crate::export::destination::Destination;
use crate::export::error::Error;
use std::path::Path;

/// A format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// UGRID-1.0 NetCDF.
    Ugrid,
    /// SMS .2dm.
    Sms,
    /// GeoJSON: each source line along mesh nodes.
    Lines,
    /// GeoJSON: each source line along the nodes of the cleaned line work.
    CleanedLines,
    /// GeoJSON: dropped stretches and places of change.
    Changes,
}

impl Format {
    /// The formats that are named by one word.
    pub const NAMES: [(&'static str, Format); 4] = [
        ("ugrid", Format::Ugrid),
        ("2dm", Format::Sms),
        ("lines", Format::Lines),
        ("changes", Format::Changes),
    ];
}

/// What was written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Nodes of the mesh in the file.
    pub nodes: u64,
    /// Quads in the file.
    pub quads: u64,
    /// Node strings or features in the file.
    pub features: u64,
    /// Length of the file, bytes.
    pub bytes: u64,
}

/// Writes `mesh` as `format` to `out`, replacing what is there.
pub fn export(mesh: &Mesh, format: Format, out: &Path) -> Result<Stats, Error> {
    let mut to = Destination::create(out)?;
    let stats = match format {
        Format::Ugrid => ugrid::write(mesh, &to)?,
        Format::Sms => sms::write(mesh, &mut to)?,
        Format::Lines => lines::write(mesh, &mut to, lines::Along::MeshNodes)?,
        Format::CleanedLines => lines::write(mesh, &mut to, lines::Along::CleanedNodes)?,
        Format::Changes => changes::write(mesh, &mut to)?,
    };
    let bytes = to.finish()?;
    Ok(Stats { bytes, ..stats })
}
