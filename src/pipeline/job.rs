//! A job: everything that a build needs to know, validated.

use crate::cleanup::SHORTEST;
use crate::cleanup::Tolerance;
use crate::cleanup::rules::Rule;
use crate::cleanup::rules::SmallLoops;
use crate::cleanup::steps::Step;
use crate::ingest::CrsChoice;
use crate::settling;
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
    /// How far clean-up may move a line, metres; half the wished size along it if not given.
    pub tolerance_m: Option<f64>,
    /// Mesh edges shorter than this are avoided, and are findings where they cannot be, metres;
    /// where sizes differ by kind, in proportion. A quarter of the size if not given.
    pub min_edge_m: Option<f64>,
    /// What clean-up may do with lines of a kind.
    pub rules: Vec<(String, Rule)>,
    /// Rows of quads in narrow places beside lines of a kind; one if not given.
    pub rows: Vec<(String, u32)>,
    /// What the coordinates mean.
    pub crs: CrsChoice,
    /// Side of a grid cell, metres.
    pub cell_m: f64,
    /// Side of a noding tile, metres; chosen from the extent if not given.
    pub tile_m: Option<f64>,
    /// A vertex that turns by more than this is a corner, degrees.
    pub corner_deg: f64,
    /// Steps of clean-up that are left out, to measure what they are worth.
    pub without: Vec<Step>,
    /// A sub-domain with more quads than this is cut by seams.
    pub seam_budget_quads: u32,
    /// Narrow places are cut into blocks by rungs up to this long, sizes; 0 for none.
    pub longest_rung: f64,
    /// Rounds in which nodes of lines move to where elements are better; 0 for none.
    pub settle: u32,
    /// What it is worth that the counts of a few-sided sub-domain fit a pattern, in the unit of what
    /// counts cost; 0 for parity alone.
    pub match_sides: f64,
    /// An earlier mesh of nearly the same lines, whose counts are kept where others are hardly better.
    pub previous: Option<PathBuf>,
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

/// Longest rung unless the job says otherwise, sizes. Measured on four cities from .6 to 1.1: longer
/// ones gain little in the mean and lose in the smallest cells.
pub const LONGEST_RUNG: f64 = 0.8;

/// Worth of a pattern unless the job says otherwise: an excess of one counts as much as an edge at 1.5
/// times its wished length. From 0.6 to 1.2 every quality figure is about as good, above p1 falls
/// (the table in `benches/README.md`).
pub const MATCH_SIDES: f64 = 1.2;

impl Job {
    /// A job that says only what must be said; all else as usual.
    pub fn usual(input: PathBuf, output: PathBuf, size_m: f64) -> Job {
        Job {
            input,
            output,
            size_m,
            sizes_m: Vec::new(),
            tolerance_m: None,
            min_edge_m: None,
            rules: Vec::new(),
            rows: Vec::new(),
            crs: CrsChoice::FromFile,
            cell_m: CELL_M,
            tile_m: None,
            corner_deg: CORNER_DEG,
            without: Vec::new(),
            seam_budget_quads: SEAM_BUDGET_QUADS,
            longest_rung: LONGEST_RUNG,
            settle: settling::ROUNDS,
            match_sides: MATCH_SIDES,
            previous: None,
            threads: 0,
            force: false,
            resume: false,
        }
    }

    /// The tolerance where no kind says otherwise: as given, or half the size.
    pub fn tolerance(&self) -> Tolerance {
        match self.tolerance_m {
            Some(metres) => Tolerance::Metres(metres),
            None => Tolerance::ShareOfSize(0.5),
        }
    }

    /// The same in metres, where the size is the job's.
    pub fn tolerance_in_force_m(&self) -> f64 {
        self.tolerance().at_m(self.size_m)
    }

    /// Least length of a mesh edge, as a share of the size.
    pub fn min_edge(&self) -> f64 {
        self.min_edge_m.map_or(SHORTEST, |it| it / self.size_m)
    }

    /// The options as one line of JSON, for the output's own record. Threads, tiles and paths are
    /// left out: they do not change the result.
    pub fn echo(&self) -> String {
        let kinds: serde_json::Map<String, serde_json::Value> = (self.sizes_m.iter())
            .map(|(kind, size_m)| (kind.clone(), (*size_m).into()))
            .collect();
        let rules: serde_json::Map<String, serde_json::Value> = (self.rules.iter())
            .map(|(kind, rule)| (kind.clone(), echo_rule(rule)))
            .collect();
        let rows: serde_json::Map<String, serde_json::Value> = (self.rows.iter())
            .map(|(kind, rows)| (kind.clone(), (*rows).into()))
            .collect();
        serde_json::json!({
            "size_m": self.size_m,
            "sizes_m": kinds,
            "tolerance_m": self.tolerance_in_force_m(),
            "tolerance_given": self.tolerance_m.is_some(),
            "min_edge_m": self.min_edge() * self.size_m,
            "kinds": rules,
            "rows": rows,
            "cell_m": self.cell_m,
            "corner_deg": self.corner_deg,
            "without": self.without.iter().map(|step| step.name()).collect::<Vec<_>>(),
            "seam_budget_quads": self.seam_budget_quads,
            "longest_rung": self.longest_rung,
            "settle": self.settle,
            "match_sides": self.match_sides,
        })
        .to_string()
    }
}

fn echo_rule(rule: &Rule) -> serde_json::Value {
    serde_json::json!({
        "tolerance_m": rule.tolerance_m,
        "priority": rule.priority,
        "small_loops": match rule.small_loops {
            SmallLoops::Collapse => "collapse",
            SmallLoops::Keep => "keep",
        },
        "hold_m": rule.hold_m,
    })
}
