//! The least counts that shapes need, folded into lower bounds of curves.

use crate::geometry::point::Point;
use crate::intervals::Options;
use crate::intervals::goals::Goals;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::HalfCurve;
use crate::partition::subdomains::Partition;
use crate::partition::subdomains::Subdomain;

/// Counts that no sub-domain can do without: a quad has four sides.
const LEAST_TOTAL: u32 = 4;

/// Raises lower bounds, sub-domain by sub-domain in the order of their ids.
pub fn raise(
    goals: &mut Goals,
    arrangement: &Arrangement,
    partition: &Partition,
    options: &Options,
) {
    for subdomain in &partition.subdomains {
        if let [walk] = subdomain.walks.as_slice() {
            let sides = sides(walk, arrangement, partition, options.corner_deg);
            // One node on a side of a triangle or a lune would make an element with a straight
            // angle at a corner; four and more sides carry quads with one interval each.
            if sides.len() == 2 || sides.len() == 3 {
                for side in &sides {
                    raise_side(goals, partition, side, 2);
                }
            }
        }
        raise_total(goals, partition, subdomain);
    }
}

/// A stretch of a walk between two corners: (curve, edges of it on this side), in order.
type Side = Vec<(u32, u32)>;

/// The sides of a closed walk; empty if it has no corner.
fn sides(
    walk: &[HalfCurve],
    arrangement: &Arrangement,
    partition: &Partition,
    corner_deg: f64,
) -> Vec<Side> {
    let mut steps: Vec<(u32, Point)> = Vec::new();
    for &half in walk {
        let nodes = &partition.curves[(half >> 1) as usize].nodes;
        let point = |k: usize| arrangement.points[nodes[k] as usize];
        for k in 0..nodes.len() - 1 {
            let from = if half & 1 == 0 {
                k
            } else {
                nodes.len() - 1 - k
            };
            steps.push((half >> 1, point(from)));
        }
    }
    let n = steps.len();
    let is_corner = |k: usize| {
        let (before, at, after) = (steps[(k + n - 1) % n].1, steps[k].1, steps[(k + 1) % n].1);
        turn_deg(before, at, after) > corner_deg
    };
    let Some(first) = (0..n).find(|&k| is_corner(k)) else {
        return Vec::new();
    };
    let mut sides: Vec<Side> = Vec::new();
    for k in (first..n).chain(0..first) {
        if is_corner(k) {
            sides.push(Side::new());
        }
        let side = sides.last_mut().expect("the first step starts a side");
        match side.last_mut() {
            Some((curve, edges)) if *curve == steps[k].0 => *edges += 1,
            _ => side.push((steps[k].0, 1)),
        }
    }
    sides
}

/// Change of direction at `at`, degrees, without sign.
fn turn_deg(before: Point, at: Point, after: Point) -> f64 {
    let step = |a: Point, b: Point| (f64::from(b.x - a.x), f64::from(b.y - a.y));
    let ((ux, uy), (vx, vy)) = (step(before, at), step(at, after));
    (ux * vy - uy * vx)
        .atan2(ux * vx + uy * vy)
        .abs()
        .to_degrees()
}

/// Raises the longest free curve of a side until the side has `least` intervals for certain.
fn raise_side(goals: &mut Goals, partition: &Partition, side: &Side, least: u32) {
    // Of a curve that lies on this side in part, only the edges on it are sure.
    let sure: u32 = (side.iter())
        .map(
            |&(curve, edges)| match partition.curves[curve as usize].edges.len() as u32 {
                all if all == edges => goals.lower[curve as usize],
                _ => edges,
            },
        )
        .sum();
    if sure < least {
        raise_longest(goals, side.iter().map(|(curve, _)| *curve), least - sure);
    }
}

/// Raises the longest free curve of a sub-domain until its total is at least four.
fn raise_total(goals: &mut Goals, partition: &Partition, subdomain: &Subdomain) {
    let curves = || subdomain.walks.iter().flatten().map(|half| half >> 1);
    let total: u32 = curves().map(|curve| goals.lower[curve as usize]).sum();
    if total < LEAST_TOTAL {
        let bound_once = curves().filter(|&curve| {
            let curve = &partition.curves[curve as usize];
            curve.left != curve.right
        });
        raise_longest(goals, bound_once, LEAST_TOTAL - total);
    }
}

fn raise_longest(goals: &mut Goals, curves: impl Iterator<Item = u32>, by: u32) {
    let free = curves.filter(|&curve| goals.lower[curve as usize] < goals.upper[curve as usize]);
    let longest = free.max_by(|&a, &b| {
        goals.goal[a as usize]
            .total_cmp(&goals.goal[b as usize])
            .then(b.cmp(&a))
    });
    if let Some(curve) = longest {
        let curve = curve as usize;
        goals.lower[curve] += by;
        // Keeps three counts to choose from, as the plan of the curve did.
        goals.upper[curve] = goals.upper[curve].max(goals.lower[curve] + 3);
    }
}
