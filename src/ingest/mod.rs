//! GIS files -> (Domain, Findings).
//!
//! # Promises
//! 1. Every feature ends up in the domain, in a finding or in an error; nothing goes in silence.
//! 2. Lines keep the order of the input; polygons become rings, the exterior counter-clockwise and
//!    interiors clockwise, so that the polygon lies on the left.
//! 3. No coordinate moves by more than half a cell; consecutive points differ, rings are closed,
//!    boundary rings do not cross themselves.
//! 4. Coordinates in degrees are refused by name, with the EPSG code of the fitting UTM zone.
//! 5. An error names the file, the feature, the coordinate and what to do.
//!
//! # Needs
//! One GeoJSON file (RFC 7946, or the 2008 format with a `crs` member), plain or gzip: a
//! FeatureCollection, a Feature or a geometry. Coordinates in metres. Properties: `role` of a
//! polygon (`boundary`, `domain` or nothing: meshed; `hole`: cut out; else its rings are
//! constraints), `kind`, `name`.
//!
//! # Method
//! 1. `source`: bytes, unpacked and digested as they pass.
//! 2. `geojson`, `feature`: one feature at a time from the stream; the `crs` member may stand
//!    before or after them.
//! 3. `crs`: is it metres?
//! 4. `gridding`: origin, integer points, kinds; what has no length or no area.
//! 5. `rings`: direction, self-crossings.
//!
//! # Cost
//! Linear in the file (`rings`: about n^1.5 for a ring of n points). Memory: 16 bytes a point beside
//! the result.
//!
//! # Not here
//! Anything that needs two lines: crossings, clipping, near misses. Reprojection.

use crate::domain::finding::Finding;
use crate::domain::line::Domain;
use crate::geometry::point::Xy;
use crate::ingest::error::Error;
use std::path::Path;

mod crs;
pub mod error;
mod feature;
mod geojson;
mod gridding;
mod rings;
mod source;

/// How to understand a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Side of a grid cell, metres.
    pub cell_m: f64,
    /// Where the reference system comes from.
    pub crs: CrsChoice,
}

/// Which reference system to believe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CrsChoice {
    /// The one that the file names; without one, metres unless all values could be degrees.
    FromFile,
    /// Metres in no particular place, whatever the file says.
    Local,
    /// This one, whatever the file says.
    Epsg(u32),
}

/// `Line::source` of the boundary that [`read`] draws around line work that has none.
pub const NO_FEATURE: u32 = u32::MAX;

/// A file, understood.
#[derive(Clone, Debug, PartialEq)]
pub struct Ingested {
    /// What is to be meshed.
    pub domain: Domain,
    /// What a user should know, by feature.
    pub findings: Vec<Finding>,
    /// If the file is line work that Polder has cleaned: the places that it had to leave as they
    /// are, projected metres.
    pub left: Option<Vec<Xy>>,
    /// Features in the file.
    pub features_read: u32,
    /// Positions in the file.
    pub points_read: u64,
}

/// Reads the GeoJSON file at `path`.
pub fn read(path: &Path, options: &Options) -> Result<Ingested, Error> {
    assert!(options.cell_m > 0.0, "cell_m: {}", options.cell_m);
    let opened = source::open(path)?;
    let content = geojson::parse(path, opened.bytes)?;
    let mut findings = Vec::new();
    let epsg = crs::decide(path, options.crs, &content, &mut findings)?;
    let (features_read, points_read) = (content.features, content.points);
    let left = content.left.clone();
    let domain = gridding::place(path, options.cell_m, content, &mut findings)?;
    findings.sort_by_key(|finding| finding.feature);
    Ok(Ingested {
        domain: Domain {
            epsg,
            digest: opened.digest.get(),
            ..domain
        },
        findings,
        left,
        features_read,
        points_read,
    })
}
