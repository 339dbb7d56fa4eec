//! A meandering river with two banks, from rim to rim.

use crate::synth::Feature;
use crate::synth::Plan;
use crate::synth::random::Random;

/// Width of the river, metres.
const WIDTH_M: f64 = 55.0;

/// The two banks, west to east, cut where they leave the domain.
pub(super) fn banks(plan: &Plan, random: &mut Random) -> Vec<Feature> {
    let half = plan.half_m.round();
    let wave = random.between(700.0, 1100.0);
    let swing = random.between(0.12, 0.2) * wave;
    let (phase, slope) = (random.between(0.0, 6.0), random.between(-0.15, 0.15));
    let middle = random.between(-0.3, 0.3) * half;
    let steps = (2.0 * half / 40.0).ceil() as usize;
    let centre = |x: f64| {
        let bend = swing * (x / wave * std::f64::consts::TAU + phase).sin();
        middle + slope * x + bend + 0.35 * swing * (x / wave * 11.0 + 2.0 * phase).sin()
    };
    let mut made = Vec::new();
    for (side, name) in [(0.5, "left bank"), (-0.5, "right bank")] {
        let mut points = Vec::new();
        for step in 0..=steps {
            let x = -half + 2.0 * half * step as f64 / steps as f64;
            let rise = (centre(x + 1.0) - centre(x - 1.0)) / 2.0;
            let offset = side * WIDTH_M / (1.0 + rise * rise).sqrt();
            // The ends stay on the rim; inside, the banks keep their distance along the normal.
            let inner = step > 0 && step < steps;
            let shift = if inner { -offset * rise } else { 0.0 };
            points.push([(x + shift).clamp(-half, half), centre(x) + offset]);
        }
        points.retain(|p| p[1].abs() <= half);
        if points.len() >= 2 {
            let name = format!("river, {name}");
            made.push(Feature {
                kind: "river",
                name,
                points,
            });
        }
    }
    made
}
