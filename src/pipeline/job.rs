//! A job: everything that a build needs to know, validated.

use crate::ingest::CrsChoice;
use std::path::PathBuf;

/// What to build, from what, how fine and where to.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// GeoJSON, plain or gzipped.
    pub input: PathBuf,
    /// The folder to make, `*.polder`.
    pub output: PathBuf,
    /// Wished edge length, metres.
    pub size_m: f64,
    /// Wished edge length along lines of a kind, metres.
    pub sizes_m: Vec<(String, f64)>,
    /// How far clean-up may move a line, metres; half the size if not given.
    pub tolerance_m: Option<f64>,
    /// What the coordinates mean.
    pub crs: CrsChoice,
    /// Side of a grid cell, metres.
    pub cell_m: f64,
    /// Side of a noding tile, metres; chosen from the extent if not given.
    pub tile_m: Option<f64>,
    /// A vertex that turns by more than this is a corner, degrees.
    pub corner_deg: f64,
    /// A sub-domain with more quads than this is cut by seams.
    pub seam_budget_quads: u32,
    /// Worker threads; 0 for as many as there are cores.
    pub threads: usize,
    /// Replace an existing output.
    pub force: bool,
    /// Go on where an earlier run of the same job was stopped, if there is one.
    pub resume: bool,
}

/// Corner angle unless the job says otherwise, degrees.
pub const CORNER_DEG: f64 = 30.0;

/// Grid cell unless the job says otherwise, metres.
pub const CELL_M: f64 = 0.001;

/// Seam budget unless the job says otherwise: a patch of this size meshes in well under a second
/// and holds about 2 MB.
pub const SEAM_BUDGET_QUADS: u32 = 20_000;

impl Job {
    /// The tolerance in force, metres: as given, or half the size.
    pub fn tolerance_in_force_m(&self) -> f64 {
        self.tolerance_m.unwrap_or(0.5 * self.size_m)
    }

    /// The options as one line of JSON, for the output's own record. Threads, tiles and paths are
    /// left out: they do not change the result.
    pub fn echo(&self) -> String {
        let kinds: serde_json::Map<String, serde_json::Value> = (self.sizes_m.iter())
            .map(|(kind, size_m)| (kind.clone(), (*size_m).into()))
            .collect();
        serde_json::json!({
            "size_m": self.size_m,
            "sizes_m": kinds,
            "tolerance_m": self.tolerance_in_force_m(),
            "cell_m": self.cell_m,
            "corner_deg": self.corner_deg,
            "seam_budget_quads": self.seam_budget_quads,
        })
        .to_string()
    }
}
