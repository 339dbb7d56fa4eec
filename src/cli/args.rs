//! The words that a user types.

use clap::Args;
use clap::Parser;
use clap::Subcommand;
use std::path::PathBuf;

/// All-quadrilateral flood meshes from the line work of a whole city or region.
///
/// Exit codes: 0 done and every promise holds; 1 done, but a promise is broken; 2 bad input or
/// usage; 3 the world refused (disk, memory, permission); 130 interrupted.
#[derive(Parser, Debug)]
#[command(name = "polder", version)]
pub struct Words {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Print a machine-readable summary (one JSON object) on standard output.
    #[arg(long, global = true)]
    pub json: bool,
    /// No progress on standard error; errors only.
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

/// The commands.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Line work in, mesh out.
    Build(BuildArgs),
    /// Says what a build will cost: quads, memory, disk, time.
    Plan(BuildArgs),
    /// Verifies every promise from the output alone.
    Check {
        /// The mesh folder.
        mesh: PathBuf,
    },
    /// Writes one self-contained HTML page, and a PNG of its pictures beside it.
    Report {
        /// The mesh folder.
        mesh: PathBuf,
        /// The page to write, `*.html`.
        #[arg(long)]
        out: PathBuf,
        /// Replace existing files.
        #[arg(long)]
        force: bool,
    },
    /// Writes the mesh in a solver's format, or the lines as meshed.
    Export {
        /// The mesh folder.
        mesh: PathBuf,
        /// What to write.
        #[arg(long, value_enum)]
        format: FormatWord,
        /// With `--format lines`: the cleaned line work instead of the lines as meshed.
        #[arg(long)]
        cleaned: bool,
        /// The file to write.
        #[arg(long)]
        out: PathBuf,
        /// Replace an existing file.
        #[arg(long)]
        force: bool,
    },
    /// Says what a mesh folder holds.
    Info {
        /// The mesh folder.
        mesh: PathBuf,
    },
    /// Makes a realistic synthetic city as GeoJSON.
    Synth {
        /// Number of constraint lines, at least 20.
        #[arg(long)]
        lines: usize,
        /// Another seed, another city.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// The file to write, `*.geojson`.
        #[arg(long)]
        out: PathBuf,
        /// Replace an existing file.
        #[arg(long)]
        force: bool,
    },
}

/// Output formats.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormatWord {
    /// UGRID-1.0 NetCDF (D-Flow FM, QGIS, xugrid).
    Ugrid,
    /// SMS .2dm with a node string for every line (SMS, TUFLOW FV, BASEMENT, QGIS).
    #[value(name = "2dm")]
    Sms,
    /// Every source line as meshed, GeoJSON.
    Lines,
    /// The table of changes, GeoJSON.
    Changes,
}

/// What `build` and `plan` take: a line file with `--size` and `--out`, or a job file. Flags win
/// over the job file.
#[derive(Args, Debug)]
pub struct BuildArgs {
    /// Line work (`.geojson`, `.geojson.gz`) or a job (`.toml`).
    pub input: PathBuf,
    /// Wished edge length, metres.
    #[arg(long)]
    pub size: Option<f64>,
    /// The folder to make, `*.polder`.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// How far clean-up may move a line, metres; 0 switches clean-up off. Default: half the size.
    #[arg(long)]
    pub tolerance: Option<f64>,
    /// Mesh edges shorter than this are avoided, and listed where they cannot be, metres. Default: a
    /// quarter of the size.
    #[arg(long)]
    pub min_edge: Option<f64>,
    /// A line turns at a corner, which is not simplified away, if its direction changes by more than
    /// this, degrees. Default: 30.
    #[arg(long)]
    pub corner_angle: Option<f64>,
    /// A step of clean-up to leave out, to measure what it is worth; may be given again.
    #[arg(long, value_name = "STEP", hide = true)]
    pub without: Vec<String>,
    /// `local` for plane coordinates without a reference system, or an EPSG code that overrides
    /// the file's.
    #[arg(long)]
    pub crs: Option<String>,
    /// Worker threads; 0 for as many as there are cores.
    #[arg(long)]
    pub threads: Option<usize>,
    /// Side of a noding tile, metres (does not change the result).
    #[arg(long)]
    pub tile: Option<f64>,
    /// A sub-domain with more quads than this is cut by seams.
    #[arg(long)]
    pub seam_budget: Option<u32>,
    /// What it is worth that opposite sides of a sub-domain get equal counts (and the like for three,
    /// five and six sides): 1 as much as one edge at 1.4 times its wished length. 0: nothing.
    /// Default: 1.2.
    #[arg(long)]
    pub match_sides: Option<f64>,
    /// Narrow places are cut into blocks of one row by short seams ("rungs") up to this long, in
    /// sizes; 0 for none. Default: 0.8.
    #[arg(long)]
    pub longest_rung: Option<f64>,
    /// Rounds in which nodes of lines move to where elements are better, within a quarter of the size
    /// (or half of the tolerance); each takes once or twice as long as meshing. 0: they stay where clean-up
    /// left them. Default: 2.
    #[arg(long, value_name = "ROUNDS")]
    pub settle: Option<u32>,
    /// An earlier mesh of nearly the same lines: counts far from what changed stay as they were.
    #[arg(long, value_name = "MESH")]
    pub previous: Option<PathBuf>,
    /// Replace an existing output.
    #[arg(long)]
    pub force: bool,
    /// Go on where an earlier run of the same job was stopped (crash, kill, full disk).
    #[arg(long)]
    pub resume: bool,
}
