//! What lies inside blocks and out in the country: cul-de-sacs, walls, buildings, tracks.

use crate::geometry::point::Xy;
use crate::synth::Feature;
use crate::synth::Plan;
use crate::synth::random::Random;

/// `count` details in distinct blocks, as far as there are enough blocks.
pub(super) fn details(plan: &Plan, count: usize, random: &mut Random) -> Vec<Feature> {
    let mut made = Vec::new();
    while made.len() < count {
        let (i, j) = (
            random.below(plan.blocks) as f64,
            random.below(plan.blocks) as f64,
        );
        let built = plan.is_built(i, j) && plan.is_built(i + 1.0, j + 1.0);
        let n = made.len();
        made.push(match random.below(10) {
            0..=2 if built => cul_de_sac(plan, i, j, n, random),
            3..=4 if built => wall(plan, i, j, n, random),
            5..=9 if built => building(plan, i, j, n, random),
            _ => track(plan, n, random),
        });
    }
    made
}

/// A dead end from the middle of a block's south side.
fn cul_de_sac(plan: &Plan, i: f64, j: f64, n: usize, random: &mut Random) -> Feature {
    let u = random.between(0.3, 0.7);
    let depth = random.between(0.35, 0.6);
    let lean = random.between(-0.15, 0.15);
    let points = [0.0, 0.5 * depth, depth]
        .iter()
        .map(|&v| plan.node(i + u + lean * v * v, j + v))
        .collect();
    let name = format!("cul-de-sac {n}");
    Feature {
        kind: "road",
        name,
        points,
    }
}

/// A free-standing wall of two or three stretches.
fn wall(plan: &Plan, i: f64, j: f64, n: usize, random: &mut Random) -> Feature {
    let (u, v) = (random.between(0.25, 0.5), random.between(0.3, 0.65));
    let length = random.between(0.2, 0.35);
    let mut points = vec![
        plan.node(i + u, j + v),
        plan.node(i + u + length, j + v + 0.05),
    ];
    if random.chance(0.5) {
        points.push(plan.node(i + u + length, j + v - 0.2));
    }
    let name = format!("wall {n}");
    Feature {
        kind: "wall",
        name,
        points,
    }
}

/// A building outline: a rectangle or an L, turned with its block.
fn building(plan: &Plan, i: f64, j: f64, n: usize, random: &mut Random) -> Feature {
    let (u, v) = (random.between(0.2, 0.35), random.between(0.2, 0.35));
    let (w, d) = (random.between(0.3, 0.45), random.between(0.3, 0.4));
    let shape: &[Xy] = if random.chance(0.4) {
        &[
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 0.5],
            [0.5, 0.5],
            [0.5, 1.0],
            [0.0, 1.0],
            [0.0, 0.0],
        ]
    } else {
        &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]]
    };
    let points = (shape.iter())
        .map(|s| plan.node(i + u + w * s[0], j + v + d * s[1]))
        .collect();
    let name = format!("building {n}");
    Feature {
        kind: "building",
        name,
        points,
    }
}

/// A field track in the open country: a short bent line that meets nothing.
fn track(plan: &Plan, n: usize, random: &mut Random) -> Feature {
    let corner = random.below(4);
    let sign = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]][corner];
    let reach = plan.half_m - 80.0;
    let at = [random.between(0.8, 0.97), random.between(0.8, 0.97)];
    let start = [sign[0] * at[0] * reach, sign[1] * at[1] * reach];
    let step = [random.between(20.0, 45.0), random.between(10.0, 40.0)];
    let points = vec![
        start,
        [start[0] - sign[0] * step[0], start[1] - sign[1] * step[1]],
        [
            start[0] - sign[0] * 2.2 * step[0],
            start[1] - sign[1] * 1.6 * step[1],
        ],
    ];
    let name = format!("track {n}");
    Feature {
        kind: "path",
        name,
        points,
    }
}
