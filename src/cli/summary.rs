//! What a command says when it is done, for people and for programs.

use crate::check::verdict::Verdict;
use crate::chunk::reader::Mesh;
use crate::export::Stats;
use crate::meshing::patch::Method;
use crate::pipeline::job::Job;
use crate::pipeline::outcome::Estimate;
use crate::pipeline::outcome::Outcome;
use crate::synth::City;
use serde_json::Value;
use serde_json::json;
use std::fmt::Write;
use std::path::Path;

/// The same thing said twice.
pub(super) struct Summary {
    /// For people.
    pub text: String,
    /// For programs.
    pub json: Value,
    /// False if a promise is broken: then even `--quiet` hears of it.
    pub good: bool,
}

impl Summary {
    fn good(text: String, json: Value) -> Summary {
        Summary {
            text,
            json,
            good: true,
        }
    }
}

pub(super) fn built(job: &Job, outcome: &Outcome) -> Summary {
    let q = &outcome.verdict.quality;
    let quads = q.scaled_jacobian.count;
    let over_size = quads as f64 / q.quads_wished.max(1e-9);
    let stages: Vec<Value> = (outcome.stages.iter())
        .map(|it| json!({"stage": it.stage, "seconds": it.seconds, "note": it.note}))
        .collect();
    let verdict = verdict(&outcome.verdict);
    let json = json!({
        "output": job.output.display().to_string(),
        "holds": outcome.verdict.holds(),
        "promises": verdict.json["promises"],
        "quads": quads,
        "quads_size2_per_area": over_size,
        "subdomains": outcome.subdomains,
        "curves": outcome.curves,
        "size_m": job.size_m,
        "tolerance_m": job.tolerance_in_force_m(),
        "area_m2": q.area_m2,
        "seconds": outcome.seconds(),
        "stages": stages,
        "peak_memory_mb": outcome.peak_memory_bytes as f64 / 1e6,
        "quality": quality(&outcome.verdict),
        "methods": methods(&outcome.verdict),
        "last_resort": {
            "subdomains": q.last_resort.subdomains,
            "quads": q.last_resort.quads,
            "subdomains_pct": pct(q.last_resort.subdomains, outcome.subdomains as u64),
            "quads_pct": pct(q.last_resort.quads, quads),
        },
        "displacement_max_m": outcome.displacement_max_m,
        "displacement_p99_m": outcome.displacement_p99_m,
        "displacement_max_over_size": outcome.displacement_max_over_size,
        "displacement_p99_over_size": outcome.displacement_p99_over_size,
        "min_edge_m": job.min_edge() * job.size_m,
        "length_m": outcome.length_m,
        "length_dropped_m": outcome.length_dropped_m,
        "length_small_loops_m": outcome.length_loops_m,
        "length_shrunk_m": outcome.length_shrunk_m,
        "sharp_angles_before": outcome.sharp_angles[0],
        "sharp_angles_after": outcome.sharp_angles[1],
        "ilp_gap": outcome.ilp_gap,
        "pattern_gap": outcome.pattern_gap,
        "blocks": outcome.blocks[0],
        "blocks_fit": outcome.blocks[1],
        "blocks_fit_without_wish": outcome.blocks[2],
        "odd_share": outcome.odd_share,
        "largest_patch_over_budget": outcome.largest_patch_over_budget,
        "findings": outcome.findings,
    });
    let mut text = first_lines(job, outcome);
    for (what, count) in &outcome.findings {
        let _ = writeln!(text, "finding: {count} x {what}");
    }
    text.push_str(&verdict.text);
    Summary {
        text,
        json,
        good: outcome.verdict.holds(),
    }
}

fn methods(verdict: &Verdict) -> Value {
    (Method::NAMES.iter().zip(&verdict.quality.methods))
        .map(|(name, it)| {
            let counts = json!({"subdomains": it.subdomains, "quads": it.quads});
            (name.to_string(), counts)
        })
        .collect::<serde_json::Map<String, Value>>()
        .into()
}

/// The figures that one looks at first.
fn first_lines(job: &Job, outcome: &Outcome) -> String {
    let q = &outcome.verdict.quality;
    format!(
        "{}: {} quads in {} sub-domains, {:.1} s, {:.0} MB\n\
         scaled Jacobian: mean {:.3}, 1 % {:.2}, least {:.3}; irregular nodes {:.1} %\n\
         lines moved at most {:.2} m (99 % below {:.2} m, {:.3} of the size); \
         dropped {:.1} m of {:.0} m, and {:.1} m of small loops; {:.1} m became nodes\n\
         parity: gap {:.4} %; {} of {} few-sided sub-domains fit a pattern, gap {:.2} %\n",
        job.output.display(),
        q.scaled_jacobian.count,
        outcome.subdomains,
        outcome.seconds(),
        outcome.peak_memory_bytes as f64 / 1e6,
        q.scaled_jacobian.mean(),
        q.scaled_jacobian.quantile(0.01),
        q.scaled_jacobian.min,
        100.0 * q.irregular(),
        outcome.displacement_max_m,
        outcome.displacement_p99_m,
        outcome.displacement_p99_over_size,
        outcome.length_dropped_m - outcome.length_loops_m,
        outcome.length_m,
        outcome.length_loops_m,
        outcome.length_shrunk_m,
        100.0 * outcome.ilp_gap,
        outcome.blocks[1],
        outcome.blocks[0],
        100.0 * outcome.pattern_gap,
    )
}

/// A share in percent.
fn pct(part: u64, whole: u64) -> f64 {
    100.0 * part as f64 / whole.max(1) as f64
}

fn quality(verdict: &Verdict) -> Value {
    let q = &verdict.quality;
    json!({
        "sj_min": q.scaled_jacobian.min,
        "sj_p1": q.scaled_jacobian.quantile(0.01),
        "sj_p5": q.scaled_jacobian.quantile(0.05),
        "sj_mean": q.scaled_jacobian.mean(),
        "share_below_0.3": q.scaled_jacobian.share_below(0.3),
        "irregular_pct": 100.0 * q.irregular(),
        "edge_p01": q.edge_over_size.quantile(0.001),
        "edge_min": q.edge_over_size.min,
        "s_p01": q.hydraulic_over_size.quantile(0.001),
        "edge_open_p50": q.edge_open_over_size.quantile(0.5),
        "edge_open_p95": q.edge_open_over_size.quantile(0.95),
        "edge_far_p50": q.edge_far_over_size.quantile(0.5),
        "edge_far_p95": q.edge_far_over_size.quantile(0.95),
        "seam_cells": q.seam_scaled_jacobian.count,
        "seam_sj_mean": q.seam_scaled_jacobian.mean(),
        "seam_sj_p1": q.seam_scaled_jacobian.quantile(0.01),
        "seam_sj_p5": q.seam_scaled_jacobian.quantile(0.05),
        "off_seam_sj_mean": q.off_seam_scaled_jacobian.mean(),
        "off_seam_sj_p1": q.off_seam_scaled_jacobian.quantile(0.01),
        "off_seam_sj_p5": q.off_seam_scaled_jacobian.quantile(0.05),
        "angle_min_deg": q.angle_deg.min,
        "angle_max_deg": q.angle_deg.max,
    })
}

pub(super) fn verdict(verdict: &Verdict) -> Summary {
    let mut text = String::new();
    let mut promises = Vec::new();
    for promise in &verdict.promises {
        let word = if promise.holds() { "holds " } else { "BROKEN" };
        let _ = writeln!(text, "{word} {:<12} {}", promise.name, promise.found);
        let mut defects = Vec::new();
        for defect in &promise.defects {
            let place = defect
                .at_m
                .map_or(String::new(), |p| format!(" at {:.3} {:.3}", p[0], p[1]));
            let _ = writeln!(text, "       {}{place}", defect.text);
            defects.push(json!({"text": defect.text, "at_m": defect.at_m}));
        }
        promises.push(json!({
            "name": promise.name, "holds": promise.holds(), "found": promise.found,
            "broken": promise.broken, "defects": defects,
        }));
    }
    let holds = verdict.holds();
    text.push_str(if holds {
        "every promise holds"
    } else {
        "A PROMISE IS BROKEN"
    });
    let json = json!({"holds": holds, "promises": promises, "quality": quality(verdict)});
    Summary {
        text,
        json,
        good: holds,
    }
}

pub(super) fn planned(cost: &Estimate) -> Summary {
    let (memory_mb, disk_mb) = (cost.memory_bytes as f64 / 1e6, cost.disk_bytes as f64 / 1e6);
    Summary::good(
        format!(
            "about {} quads in {} sub-domains, {} nodes on lines\n\
             about {memory_mb:.0} MB of memory, {disk_mb:.0} MB of disk, {:.0} s",
            cost.quads, cost.subdomains, cost.boundary_nodes, cost.seconds
        ),
        json!({
            "quads": cost.quads, "subdomains": cost.subdomains, "boundary_nodes": cost.boundary_nodes,
            "memory_mb": memory_mb, "disk_mb": disk_mb, "seconds": cost.seconds,
        }),
    )
}

pub(super) fn exported(out: &Path, written: &Stats) -> Summary {
    let (out, bytes) = (out.display().to_string(), written.bytes);
    Summary::good(
        format!("{out}: {bytes} bytes"),
        json!({"out": out, "bytes": bytes}),
    )
}

pub(super) fn reported(out: &Path, picture: &Path) -> Summary {
    let (out, picture) = (out.display().to_string(), picture.display().to_string());
    Summary::good(
        format!("{out}\n{picture}"),
        json!({"out": out, "picture": picture}),
    )
}

pub(super) fn synth(out: &Path, city: &City) -> Summary {
    let (out, lines) = (out.display().to_string(), city.features.len());
    Summary::good(
        format!("{out}: {lines} lines"),
        json!({"out": out, "lines": lines}),
    )
}

pub(super) fn info(mesh: &Mesh) -> Summary {
    let index = mesh.index();
    let frame = mesh.frame();
    let quads: u64 = index.quads;
    let epsg = index.epsg.map_or("none".to_string(), |it| it.to_string());
    Summary::good(
        format!(
            "{}: {quads} quads, {} sub-domains, {} curves, {} lines\nEPSG {epsg}, size {} m, tolerance {} m, {} chunks\njob {}",
            mesh.dir().display(),
            frame.subdomains(),
            frame.curves(),
            mesh.lines().lines(),
            index.size_m,
            index.tolerance_m,
            mesh.chunks(),
            index.job,
        ),
        json!({
            "quads": quads, "subdomains": frame.subdomains(), "curves": frame.curves(),
            "lines": mesh.lines().lines(), "epsg": index.epsg, "size_m": index.size_m,
            "tolerance_m": index.tolerance_m, "chunks": mesh.chunks(), "job": index.job,
        }),
    )
}
