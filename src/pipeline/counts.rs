//! The interval counts in the report: what they cost, what is proven, which patterns they fit.

use crate::check::patterns::network;
use crate::chunk::reader::Mesh;
use crate::chunk::views::FrameView;
use crate::parity;
use crate::parity::balance::Solved;
use crate::parity::check::fits;

/// Parity alone, to compare with: the matching is exact, HiGHS would only confirm it.
const ALONE: parity::Options = parity::Options {
    events_max: 1 << 31,
    nodes_max: 0,
    rows_max: 0,
    worth: 0.0,
    rounds_max: 0,
    climb_max: 0,
    gap_enough: 0.0,
    neighbourhoods_max: 0,
};

/// Rows of (figure, value); empty if the mesh has no certificate.
pub fn rows(mesh: &Mesh) -> Vec<[String; 2]> {
    let frame = mesh.frame();
    let Some(proof) = frame.certificate else {
        return Vec::new();
    };
    let unit = proof.cost_unit;
    let cost = |units: i64| format!("{:.3}", units as f64 * unit);
    let share = |gap: i64, of: i64| format!("{:.4} %", 100.0 * gap as f64 / of.max(1) as f64);
    let row = |name: &str, value: String| [name.to_string(), value];
    let odd = (0..frame.curves()).filter(|&curve| frame.count(curve) % 2 == 1);
    let curves = frame.curves().max(1) as f64;
    let mut rows = vec![
        row("curves", frame.curves().to_string()),
        row(
            "odd counts",
            format!("{:.1} %", 100.0 * odd.count() as f64 / curves),
        ),
        row("cost of free rounding, parity ignored", cost(proof.base)),
        row(
            "bound of any counts with all sub-domains even",
            cost(proof.bound),
        ),
        row("cost of the counts", cost(proof.objective)),
    ];
    rows.push(row(
        "the same bound by HiGHS, not verified",
        said(&proof.solved),
    ));
    let Some(patterns) = &frame.patterns else {
        let gap = share(proof.objective - proof.bound, proof.objective - proof.base);
        rows.push(row("gap", gap));
        return rows;
    };
    let total = proof.objective + patterns.price;
    rows.push(row(
        "price of patterns that do not fit",
        cost(patterns.price),
    ));
    rows.push(row(
        "bound of cost and price of any even counts",
        cost(patterns.bound),
    ));
    rows.push(row(
        "the same by HiGHS, not verified",
        said(&patterns.solved),
    ));
    rows.push(row(
        "T-joins for it; neighbourhoods that HiGHS improved",
        format!("{}; {}", patterns.rounds, patterns.improved),
    ));
    let gap = share(total - patterns.bound, total - proof.base);
    rows.push(row("gap of cost and price", gap));
    rows.extend(shares(&frame, mesh));
    rows
}

/// The optimum that HiGHS claims of a programme, and what it took.
fn said(it: &Solved) -> String {
    let claimed = it
        .claimed
        .map_or("none".to_string(), |it| format!("{it:.3}"));
    format!(
        "{claimed} ({} rows in {} parts, {} of them left; {} rows added, {} parts branched on)",
        it.rows, it.parts, it.left, it.added, it.branched
    )
}

/// The share of few-sided sub-domains whose counts fit a pattern, by number of sides: with the
/// counts that are best for parity alone, and with those of the mesh.
fn shares(frame: &FrameView, mesh: &Mesh) -> Vec<[String; 2]> {
    let Some((partition, goals)) = network(mesh) else {
        return Vec::new();
    };
    let now: Vec<u32> = (0..frame.curves())
        .map(|curve| frame.count(curve))
        .collect();
    let Ok(alone) = parity::balance(&partition, &goals, &ALONE) else {
        return Vec::new();
    };
    let [before, after] = [&alone.counts, &now].map(|counts| fits(&partition, &goals, counts));
    let mut rows = Vec::new();
    for sides in 3..=6 {
        let of = |fits: &[bool]| -> (usize, usize) {
            let these = goals.blocks.iter().zip(fits);
            let these = these.filter(|(block, _)| block.sides.len() == sides);
            let fit = these.clone().filter(|(_, fits)| **fits).count();
            (fit, these.count())
        };
        let ((before, all), (after, _)) = (of(&before), of(&after));
        if all > 0 {
            let pct = |n: usize| 100.0 * n as f64 / all as f64;
            rows.push([
                format!("of {all} sub-domains with {sides} sides that nearly fit a pattern, fit"),
                format!("{:.1} % (parity alone: {:.1} %)", pct(after), pct(before)),
            ]);
        }
    }
    rows
}
