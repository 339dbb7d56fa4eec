//! Interior points for the indirect method: a lattice in the direction of the walks.

use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::meshing::visits::Visits;
use std::f64::consts::TAU;

/// Lattice points stay this far from walk edges, as a share of the lattice step.
const CLEAR: f64 = 0.7;

/// Most points: a bound on the cost of a sub-domain whose walks are long and thin at an angle.
const MOST: f64 = 1e7;

/// The points of a square lattice of step `size_m` inside the box of the walks and clear of them.
/// Whether they are inside the sub-domain is left to the triangulation.
pub(crate) fn scatter(visits: &Visits, size_m: f64) -> Vec<Xy> {
    let direction = direction_rad(visits);
    let (sin, cos) = direction.sin_cos();
    let turn = |p: Xy| [cos * p[0] + sin * p[1], cos * p[1] - sin * p[0]];
    let turned: Vec<Xy> = visits.nodes.iter().map(|&p| turn(p)).collect();
    let offset = [
        phase_m(visits, &turned, 0, size_m),
        phase_m(visits, &turned, 1, size_m),
    ];
    let range = |axis: usize| {
        let cell = |p: &Xy| (p[axis] - offset[axis]) / size_m;
        let low = turned
            .iter()
            .map(cell)
            .fold(f64::INFINITY, f64::min)
            .floor();
        let high = turned
            .iter()
            .map(cell)
            .fold(f64::NEG_INFINITY, f64::max)
            .ceil();
        (low, high - low + 1.0)
    };
    let ((low_x, columns), (low_y, rows)) = (range(0), range(1));
    if columns * rows > MOST {
        return Vec::new();
    }
    let near = mark_near(
        visits,
        &turned,
        [low_x, low_y],
        [columns, rows],
        offset,
        size_m,
    );
    let mut points = Vec::new();
    for (k, _) in near.iter().enumerate().filter(|&(_, &near)| !near) {
        let x = offset[0] + size_m * (low_x + (k % columns as usize) as f64);
        let y = offset[1] + size_m * (low_y + (k / columns as usize) as f64);
        points.push([cos * x - sin * y, sin * x + cos * y]);
    }
    points
}

/// The mean direction of the edges, as a lattice sees them (modulo a right angle), by length.
fn direction_rad(visits: &Visits) -> f64 {
    let mut sum = [0.0, 0.0];
    for visit in 0..visits.len() as u32 {
        let a = visits.nodes[visit as usize];
        let b = visits.nodes[visits.next(visit) as usize];
        let (sin, cos) = (4.0 * (b[1] - a[1]).atan2(b[0] - a[0])).sin_cos();
        sum[0] += distance(a, b) * cos;
        sum[1] += distance(a, b) * sin;
    }
    sum[1].atan2(sum[0]) / 4.0
}

/// Where lattice lines across `axis` should lie so that walk edges along them fall on them: the
/// circular mean, modulo the step.
fn phase_m(visits: &Visits, turned: &[Xy], axis: usize, size_m: f64) -> f64 {
    let mut sum = [0.0, 0.0];
    for visit in 0..visits.len() as u32 {
        let a = turned[visit as usize];
        let b = turned[visits.next(visit) as usize];
        let length = distance(a, b);
        if (b[axis] - a[axis]).abs() < 0.12 * length {
            let (sin, cos) = (TAU * 0.5 * (a[axis] + b[axis]) / size_m).sin_cos();
            sum[0] += length * cos;
            sum[1] += length * sin;
        }
    }
    sum[1].atan2(sum[0]) / TAU * size_m
}

/// For each lattice point: true if a walk edge is nearer than [`CLEAR`] steps.
fn mark_near(
    visits: &Visits,
    turned: &[Xy],
    low: Xy,
    [columns, rows]: [f64; 2],
    offset: Xy,
    size_m: f64,
) -> Vec<bool> {
    let mut near = vec![false; (columns * rows) as usize];
    for visit in 0..visits.len() as u32 {
        let cell = |p: Xy, axis: usize| (p[axis] - offset[axis]) / size_m - low[axis];
        let [a, b] = [visit, visits.next(visit)].map(|node| {
            let p = turned[node as usize];
            [cell(p, 0), cell(p, 1)]
        });
        let span = |axis: usize, most: f64| {
            let from = (a[axis].min(b[axis]) - CLEAR).ceil().max(0.0) as usize;
            let to = (a[axis].max(b[axis]) + CLEAR).floor().min(most - 1.0) as usize;
            from..=to
        };
        for y in span(1, rows) {
            for x in span(0, columns) {
                if to_segment([x as f64, y as f64], a, b) < CLEAR {
                    near[y * columns as usize + x] = true;
                }
            }
        }
    }
    near
}

/// Distance from `p` to the segment `a b`.
fn to_segment(p: Xy, a: Xy, b: Xy) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let along = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy);
    let along = along.clamp(0.0, 1.0);
    distance(p, [a[0] + along * dx, a[1] + along * dy])
}
