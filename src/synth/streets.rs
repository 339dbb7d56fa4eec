//! Avenues and the bent, cut street grid.

use crate::geometry::point::Xy;
use crate::synth::Feature;
use crate::synth::Plan;
use crate::synth::random::Random;

/// Share of block sides that are missing, so that blocks merge into larger, concave ones.
const MISSING: f64 = 0.14;

/// Straight roads at angles through the city and out to the rim.
pub(super) fn avenues(plan: &Plan, random: &mut Random) -> Vec<Feature> {
    let count = (2 + plan.blocks / 12).min(9);
    let half = plan.half_m.round();
    let mut made = Vec::new();
    for n in 0..count {
        let angle = random.between(0.0, std::f64::consts::PI);
        let offset = random.between(-0.5, 0.5) * half;
        let (sin, cos) = angle.sin_cos();
        let at = |t: f64| [t * cos - offset * sin, t * sin + offset * cos];
        let inside = |p: Xy| p[0].abs() <= half && p[1].abs() <= half;
        let reach = 3.0 * half;
        let steps = 2000;
        let mut on: Vec<f64> = (0..=steps)
            .map(|k| -reach + 2.0 * reach * f64::from(k) / f64::from(steps))
            .filter(|&t| inside(at(t)))
            .collect();
        if on.len() < 8 {
            continue;
        }
        // Some avenues end in the country instead of at the rim.
        if n % 3 == 2 {
            on.truncate(on.len() * 3 / 4);
        }
        let (first, last) = (on[0], on[on.len() - 1]);
        let pieces = ((last - first) / 400.0).ceil().max(1.0) as usize;
        let points = (0..=pieces)
            .map(|k| at(first + (last - first) * k as f64 / pieces as f64))
            .collect();
        let name = format!("avenue {n}");
        made.push(Feature {
            kind: "avenue",
            name,
            points,
        });
    }
    made
}

/// The street grid: each row and column is cut into features of a few blocks, with gaps.
pub(super) fn streets(plan: &Plan, random: &mut Random) -> Vec<Feature> {
    let mut made = Vec::new();
    for along_x in [true, false] {
        for row in 0..=plan.blocks {
            let mut run: Vec<Xy> = Vec::new();
            let mut longest = 2 + random.below(6);
            for step in 0..=plan.blocks {
                let (i, j) = if along_x { (step, row) } else { (row, step) };
                let (i, j) = (i as f64, j as f64);
                if plan.is_built(i, j) {
                    run.push(plan.node(i, j));
                }
                let cut = random.chance(MISSING) || !plan.is_built(i, j);
                if cut || run.len() > longest {
                    let restart = (!cut).then(|| run[run.len() - 1]);
                    flush(&mut made, &mut run, row, along_x);
                    run.extend(restart);
                    longest = 2 + random.below(6);
                }
            }
            flush(&mut made, &mut run, row, along_x);
        }
    }
    made
}

fn flush(made: &mut Vec<Feature>, run: &mut Vec<Xy>, row: usize, along_x: bool) {
    let points = std::mem::take(run);
    if points.len() < 2 {
        return;
    }
    let name = format!("{} {row}", if along_x { "street" } else { "lane" });
    made.push(Feature {
        kind: "road",
        name,
        points,
    });
}
