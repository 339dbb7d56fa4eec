//! What a build made and what a plan foresees, in numbers.

use crate::check::verdict::Verdict;
use crate::cleanup::changes::Reason;
use crate::cleanup::changes::length_m;
use crate::domain::finding::Finding;
use crate::pipeline::job::Job;
use crate::pipeline::plan::Plan;
use crate::pipeline::progress::StageTime;
use std::collections::BTreeMap;

/// What a build made.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Wall time by stage.
    pub stages: Vec<StageTime>,
    /// Every promise, and the quality.
    pub verdict: Verdict,
    /// Sub-domains, parts of cut ones counted each.
    pub subdomains: usize,
    /// Curves between junctions.
    pub curves: usize,
    /// Largest displacement of any line, metres.
    pub displacement_max_m: f64,
    /// 99 % quantile of the displacement, by length, metres.
    pub displacement_p99_m: f64,
    /// The largest displacement as a share of the wished size along each line.
    pub displacement_max_over_size: f64,
    /// 99 % quantile of that share.
    pub displacement_p99_over_size: f64,
    /// Length of constraint lines inside the domain, metres.
    pub length_m: f64,
    /// Length dropped of it, small loops included, metres.
    pub length_dropped_m: f64,
    /// Length of small loops that collapsed, metres.
    pub length_loops_m: f64,
    /// Length of lines that became a node, metres.
    pub length_shrunk_m: f64,
    /// Sharp angles at nodes of the line work, in the input and after clean-up.
    pub sharp_angles: [u64; 2],
    /// Gap of the integer programme.
    pub ilp_gap: f64,
    /// Sub-domains with few sides, how many of them have counts that fit a pattern, and how many
    /// would if parity were all.
    pub blocks: [u32; 3],
    /// Gap of cost and patterns' price together.
    pub pattern_gap: f64,
    /// Share of odd counts among all curves.
    pub odd_share: f64,
    /// Largest patch over the seam budget.
    pub largest_patch_over_budget: f64,
    /// How often each kind of finding was made.
    pub findings: BTreeMap<&'static str, usize>,
    /// Largest resident memory of the process, bytes; 0 where the system does not say.
    pub peak_memory_bytes: u64,
}

impl Outcome {
    /// Gathers the numbers of a finished build.
    pub(super) fn new(
        job: &Job,
        plan: &Plan,
        findings: &[Finding],
        verdict: Verdict,
        stages: Vec<StageTime>,
    ) -> Outcome {
        let mut by_kind = BTreeMap::new();
        for finding in findings {
            *by_kind.entry(finding.what).or_insert(0) += 1;
        }
        let budget = f64::from(job.seam_budget_quads);
        let fit = &plan.city.balance.structure;
        let dropped_m = |reason| {
            let dropped = plan.city.dropped.iter();
            length_m(dropped.filter(|it| it.reason == reason))
        };
        Outcome {
            stages,
            subdomains: plan.city.partition.subdomains.len(),
            curves: plan.city.partition.curves.len(),
            displacement_max_m: plan.city.tally.displacement_max_m,
            displacement_p99_m: plan.city.tally.displacement_p99_m,
            displacement_max_over_size: plan.city.tally.displacement_max_over_size,
            displacement_p99_over_size: plan.city.tally.displacement_p99_over_size,
            length_m: plan.city.tally.length_m,
            length_dropped_m: plan.city.tally.length_dropped_m,
            sharp_angles: plan.city.tally.sharp_angles,
            length_shrunk_m: dropped_m(Reason::Shrunk),
            length_loops_m: dropped_m(Reason::SmallLoop),
            ilp_gap: plan.city.balance.gap(),
            blocks: [fit.blocks, fit.mapped, fit.mapped_before],
            pattern_gap: plan.city.balance.structure_gap(),
            odd_share: plan.city.balance.odd_share,
            largest_patch_over_budget: verdict.quality.largest_patch.0 as f64 / budget,
            findings: by_kind,
            peak_memory_bytes: peak_memory_bytes(),
            verdict,
        }
    }

    /// Wall time of all stages, seconds.
    pub fn seconds(&self) -> f64 {
        self.stages.iter().map(|it| it.seconds).sum()
    }
}

/// What a build of a plan will cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Quads, from areas and sizes.
    pub quads: u64,
    /// Nodes on lines.
    pub boundary_nodes: u64,
    /// Sub-domains.
    pub subdomains: usize,
    /// Peak memory, bytes: the plan's own plus patches in flight.
    pub memory_bytes: u64,
    /// The mesh folder, bytes.
    pub disk_bytes: u64,
    /// Wall time of the whole build, seconds.
    pub seconds: f64,
    /// Wall time by stage of the plan alone.
    pub stages: Vec<StageTime>,
}

/// Disk that a quad takes: four local ids and about one interior node of two f64, bytes.
const BYTES_A_QUAD: f64 = 32.0;

/// Disk that a node on a line takes in the frame: place, ids, pieces, bytes.
const BYTES_A_BOUNDARY_NODE: f64 = 90.0;

/// Time of a quad near a line and of one in a lattice core, on one core, seconds; measured on the
/// shared cases, good to a factor of two.
const SECONDS_A_QUAD: [f64; 2] = [60e-6, 1e-6];

/// Rows of quads from a line that are not perfect lattice cells.
const ROWS_NEAR_LINES: f64 = 8.0;

impl Estimate {
    /// The cost of `plan`, which itself took `stages`, on `workers` cores.
    pub(super) fn new(job: &Job, plan: &Plan, stages: Vec<StageTime>, workers: usize) -> Estimate {
        let quads = plan.quads_expected();
        let boundary_nodes = plan.first[plan.first.len() - 1];
        let near = (boundary_nodes as f64 * ROWS_NEAR_LINES).min(quads as f64);
        let far = quads as f64 - near;
        // each round of settling meshes on trial
        let times = f64::from(1 + job.settle);
        let meshing = times * (near * SECONDS_A_QUAD[0] + far * SECONDS_A_QUAD[1]);
        let planned: f64 = stages.iter().map(|it| it.seconds).sum();
        let disk = quads as f64 * BYTES_A_QUAD + boundary_nodes as f64 * BYTES_A_BOUNDARY_NODE;
        Estimate {
            quads,
            boundary_nodes,
            subdomains: plan.city.partition.subdomains.len(),
            // A chunk exists as records and as a buffer; the frame is built in memory.
            memory_bytes: peak_memory_bytes()
                + (3 * crate::chunk::CHUNK_BYTES) as u64
                + boundary_nodes * BYTES_A_BOUNDARY_NODE as u64,
            disk_bytes: disk as u64,
            seconds: planned + meshing / workers as f64,
            stages,
        }
    }
}

/// The process's largest resident memory so far, bytes; 0 where the system does not say.
fn peak_memory_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|it| it.strip_prefix("VmHWM:"));
    let kib = line.and_then(|it| it.trim().trim_end_matches("kB").trim().parse::<u64>().ok());
    kib.unwrap_or(0) * 1024
}
