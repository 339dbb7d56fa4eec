//! Words and `job.toml` -> Job. Flags win over the file; unknown keys are refused.

use crate::cleanup::rules::HOLD_M;
use crate::cleanup::rules::PRIORITY_MAX;
use crate::cleanup::rules::Rule;
use crate::cleanup::rules::SmallLoops;
use crate::cleanup::steps::Step;
use crate::cli::args::BuildArgs;
use crate::ingest::CrsChoice;
use crate::pipeline::job::CELL_M;
use crate::pipeline::job::CORNER_DEG;
use crate::pipeline::job::Job;
use crate::pipeline::job::LONGEST_RUNG;
use crate::pipeline::job::MATCH_SIDES;
use crate::pipeline::job::SEAM_BUDGET_QUADS;
use crate::settling;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;
use std::path::PathBuf;

/// The keys of a job file. Paths are relative to the file.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct JobFile {
    input: Option<PathBuf>,
    output: Option<PathBuf>,
    size: Option<f64>,
    #[serde(default)]
    sizes: BTreeMap<String, f64>,
    #[serde(default)]
    kinds: BTreeMap<String, KindTable>,
    tolerance: Option<f64>,
    crs: Option<toml::Value>,
    min_edge: Option<f64>,
    #[serde(alias = "corner")]
    corner_angle: Option<f64>,
    cell: Option<f64>,
    tile: Option<f64>,
    seam_budget: Option<u32>,
    longest_rung: Option<f64>,
    settle: Option<u32>,
    match_sides: Option<f64>,
    previous: Option<PathBuf>,
    threads: Option<usize>,
}

/// Narrow places have no room for more rows.
const ROWS_MAX: u32 = 4;

/// The keys of a table `[kinds.NAME]`: what clean-up may do with lines of this kind, and how narrow
/// places beside them are meshed.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct KindTable {
    tolerance_m: Option<f64>,
    #[serde(default)]
    priority: i32,
    small_loops: Option<LoopWord>,
    hold: Option<bool>,
    hold_m: Option<f64>,
    rows: Option<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum LoopWord {
    Keep,
    Collapse,
}

impl KindTable {
    fn rule(&self, kind: &str) -> Result<Rule, String> {
        let metres = |key: &str, value: Option<f64>| match value {
            Some(it) if !(it.is_finite() && it >= 0.0) => Err(format!(
                "kinds.{kind}.{key} is {it}: it must be zero or a positive number of metres"
            )),
            good => Ok(good),
        };
        if self.priority.abs() > PRIORITY_MAX {
            return Err(format!(
                "kinds.{kind}.priority is {}: it must lie in -{PRIORITY_MAX}..{PRIORITY_MAX}",
                self.priority
            ));
        }
        if self.rows.is_some_and(|it| !(1..=ROWS_MAX).contains(&it)) {
            return Err(format!("kinds.{kind}.rows: it must lie in 1..{ROWS_MAX}"));
        }
        let hold_m = match (self.hold, metres("hold_m", self.hold_m)?) {
            (Some(false), Some(_)) => {
                return Err(format!(
                    "kinds.{kind}: `hold = false` and `hold_m` contradict each other"
                ));
            }
            (_, Some(hold_m)) => Some(hold_m),
            (Some(true), None) => Some(HOLD_M),
            (_, None) => None,
        };
        Ok(Rule {
            tolerance_m: metres("tolerance_m", self.tolerance_m)?,
            priority: self.priority,
            small_loops: match self.small_loops {
                Some(LoopWord::Keep) => SmallLoops::Keep,
                _ => SmallLoops::Collapse,
            },
            hold_m,
        })
    }
}

/// The job that these words ask for, or a sentence that says what is wrong with them.
pub fn job(args: &BuildArgs) -> Result<Job, String> {
    let is_job_file = args.input.extension().is_some_and(|it| it == "toml");
    let file = if is_job_file {
        read(&args.input)?
    } else {
        JobFile::default()
    };
    let input = if is_job_file {
        (file.input).ok_or(
            "the job file has no `input`: name the line work, for example input = \"city.geojson\"",
        )?
    } else {
        args.input.clone()
    };
    let size_m = (args.size.or(file.size))
        .ok_or("no size: give --size METRES, or `size` in the job file")?;
    let output = (args.out.clone().or(file.output))
        .ok_or("no output: give --out FOLDER.polder, or `output` in the job file")?;
    let crs = match (&args.crs, &file.crs) {
        (Some(word), _) => crs(word)?,
        (None, Some(toml::Value::String(word))) => crs(word)?,
        (None, Some(toml::Value::Integer(code))) => crs(&code.to_string())?,
        (None, Some(other)) => {
            return Err(format!("`crs` is {other}: give an EPSG code or \"local\""));
        }
        (None, None) => CrsChoice::FromFile,
    };
    let rows = (file.kinds.iter())
        .filter_map(|(kind, table)| table.rows.map(|rows| (kind.clone(), rows)))
        .collect();
    let rules = (file.kinds.into_iter())
        .map(|(kind, table)| table.rule(&kind).map(|rule| (kind, rule)))
        .collect::<Result<Vec<_>, String>>()?;
    let job = Job {
        input,
        output,
        size_m,
        sizes_m: file.sizes.into_iter().collect(),
        tolerance_m: args.tolerance.or(file.tolerance),
        min_edge_m: args.min_edge.or(file.min_edge),
        rules,
        rows,
        crs,
        cell_m: file.cell.unwrap_or(CELL_M),
        tile_m: args.tile.or(file.tile),
        corner_deg: (args.corner_angle.or(file.corner_angle)).unwrap_or(CORNER_DEG),
        without: without(&args.without)?,
        seam_budget_quads: args
            .seam_budget
            .or(file.seam_budget)
            .unwrap_or(SEAM_BUDGET_QUADS),
        longest_rung: (args.longest_rung.or(file.longest_rung)).unwrap_or(LONGEST_RUNG),
        settle: (args.settle.or(file.settle)).unwrap_or(settling::ROUNDS),
        match_sides: (args.match_sides.or(file.match_sides)).unwrap_or(MATCH_SIDES),
        previous: args.previous.clone().or(file.previous),
        threads: args.threads.or(file.threads).unwrap_or(0),
        force: args.force,
        resume: args.resume,
    };
    validate(&job)?;
    Ok(job)
}

/// The steps of these names.
fn without(names: &[String]) -> Result<Vec<Step>, String> {
    let step = |name: &String| {
        Step::named(name).ok_or_else(|| {
            let known: Vec<&str> = Step::NAMED.iter().map(|it| it.0).collect();
            format!("no step of clean-up is called {name}: {}", known.join(", "))
        })
    };
    names.iter().map(step).collect()
}

fn read(path: &Path) -> Result<JobFile, String> {
    let text = std::fs::read_to_string(path).map_err(|it| format!("{}: {it}", path.display()))?;
    let mut file: JobFile =
        toml::from_str(&text).map_err(|it| format!("{}: {it}", path.display()))?;
    let folder = path.parent().unwrap_or(Path::new("."));
    for relative in [&mut file.input, &mut file.output, &mut file.previous] {
        *relative = relative.take().map(|it| folder.join(it));
    }
    Ok(file)
}

fn crs(word: &str) -> Result<CrsChoice, String> {
    if word.eq_ignore_ascii_case("local") {
        return Ok(CrsChoice::Local);
    }
    let code = word.to_ascii_uppercase();
    (code
        .strip_prefix("EPSG:")
        .unwrap_or(&code)
        .parse()
        .map(CrsChoice::Epsg))
    .map_err(|_| format!("--crs {word}: give `local` or an EPSG code such as 32632"))
}

fn validate(job: &Job) -> Result<(), String> {
    let sizes = (job.sizes_m.iter()).map(|(kind, size_m)| (format!("sizes.{kind}"), *size_m));
    for (name, size_m) in sizes.chain([("size".to_string(), job.size_m)]) {
        if !(size_m.is_finite() && size_m > 0.0) {
            return Err(format!(
                "{name} is {size_m}: it must be a positive number of metres"
            ));
        }
        if size_m < 20.0 * job.cell_m {
            return Err(format!(
                "{name} is {size_m} m: it must be at least 20 grid cells of {} m; set a finer `cell`",
                job.cell_m
            ));
        }
    }
    if job
        .tolerance_m
        .is_some_and(|it| !(it.is_finite() && it >= 0.0))
    {
        return Err("tolerance: it must be zero or a positive number of metres".into());
    }
    let most_m = 0.5 * job.size_m;
    if (job.min_edge_m).is_some_and(|it| !(it.is_finite() && (0.0..=most_m).contains(&it))) {
        return Err(format!(
            "min_edge: it must lie between zero and half the size, {most_m} m"
        ));
    }
    if !(job.cell_m.is_finite() && job.cell_m >= 1e-6) {
        return Err(format!(
            "cell is {} m: it must be at least 0.000001",
            job.cell_m
        ));
    }
    if job.tile_m.is_some_and(|it| !(it.is_finite() && it > 0.0)) {
        return Err("tile: it must be a positive number of metres".into());
    }
    if !(5.0..=90.0).contains(&job.corner_deg) {
        return Err(format!(
            "the corner angle is {} degrees: it must lie in 5..90",
            job.corner_deg
        ));
    }
    if !(0.0..=1000.0).contains(&job.match_sides) {
        return Err(format!(
            "match_sides is {}: it must lie in 0..1000",
            job.match_sides
        ));
    }
    if !(0.0..=2.0).contains(&job.longest_rung) {
        return Err(format!(
            "longest_rung is {}: it must lie in 0..2 sizes",
            job.longest_rung
        ));
    }
    if job.settle > 10 {
        return Err(format!(
            "settle is {}: more than 10 rounds gain nothing",
            job.settle
        ));
    }
    if job.seam_budget_quads < 1000 {
        return Err("the seam budget must be at least 1000 quads".into());
    }
    Ok(())
}
