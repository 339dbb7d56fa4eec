//! The best way from a lattice line to a wall.

use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::seams::clearance::distance_to_segment;
use crate::seams::clearance::meet;
use crate::seams::raster::LatticeLine;
use crate::seams::walls::Walls;

/// Length of an end piece, pitches.
pub(super) const LENGTH: [f64; 2] = [0.9, 2.4];
/// Least angle with the edges at a wall node, degrees.
pub(super) const ANGLE_AT_NODE_DEG: f64 = 50.0;
/// Least angle with an edge that is split, degrees.
pub(super) const ANGLE_AT_SPLIT_DEG: f64 = 60.0;
/// Least distance of a split from the ends of its edge, pitches.
pub(super) const SPLIT_FROM_END: f64 = 0.8;
/// Largest turn off the lattice line, degrees.
pub(super) const TURN_DEG: f64 = 75.0;
/// What an end piece keeps from walls, pitches; nearer to its own wall node, this share of the
/// distance from it, the sine of some 45 degrees.
const CLEAR: f64 = 0.8;
const CONE: f64 = 0.7;
/// How many lattice points before the last free one may be where a seam leaves its line.
const STEPS_BACK: i64 = 3;

/// How a seam ends at a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct End {
    /// Where it leaves the lattice line, its `k`-th lattice point.
    pub k: i64,
    /// Its node on the wall.
    pub wall: Point,
    /// The edge to be split there, or none at an existing node.
    pub split: Option<u32>,
    /// How far from good it is: 1 for a perfect end, 2 to 4 for a tolerable one.
    pub price: f64,
}

/// A place on a wall.
struct Target {
    wall: Point,
    split: Option<u32>,
}

/// The cheapest end of a seam that comes along `on` in direction `ahead` (1 or -1) up to its
/// lattice point `last`, and leaves it no earlier than at `least`.
pub(super) fn best_end(
    walls: &Walls,
    on: LatticeLine,
    ahead: i64,
    last: i64,
    least: i64,
    step: i64,
) -> Option<End> {
    let mut best: Option<End> = None;
    for back in 0..STEPS_BACK {
        let k = last - ahead * back;
        if (k - least) * ahead < 0 {
            break;
        }
        let from = on.point(k, walls.pitch);
        let heading = on.point(k + ahead, walls.pitch);
        let reach = f64::from(walls.pitch) * (LENGTH[1] + CLEAR);
        let near = walls.buckets.near([from, from], reach);
        for target in targets(walls, from, &near) {
            if is_near_crossing(walls, on, k, target.wall, step) {
                continue;
            }
            let Some(price) = price(walls, [from, heading], &target, &near) else {
                continue;
            };
            // The nearest to the wall, all else equal.
            let price = price + 0.05 * back as f64;
            if best.is_none_or(|best| price < best.price) {
                let Target { wall, split } = target;
                best = Some(End {
                    k,
                    wall,
                    split,
                    price,
                });
            }
        }
    }
    best
}

/// True if a line of the raster across ours passes the end piece or less than a pitch before it:
/// seams on it would be too near. Not close to the wall node, where the wall keeps them off.
fn is_near_crossing(walls: &Walls, on: LatticeLine, k: i64, wall: Point, step: i64) -> bool {
    let pitch = i64::from(walls.pitch);
    let (_, along) = on.along.split(wall);
    let ahead = if along > k * pitch { 1 } else { -1 };
    let from = (k - ahead) * pitch;
    let to = along - ahead * pitch * 7 / 10;
    let side_of = |at: i64| at.div_euclid(step * pitch);
    side_of(from) != side_of(to)
}

/// Nodes and places on edges within the length of an end piece from `from`.
fn targets(walls: &Walls, from: Point, near: &[u32]) -> Vec<Target> {
    let pitch = f64::from(walls.pitch);
    let is_reached = |wall: Point| {
        let length = from.distance(wall) / pitch;
        (LENGTH[0]..=LENGTH[1]).contains(&length)
    };
    let mut nodes: Vec<Point> = near.iter().flat_map(|&edge| walls.ends(edge)).collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes.retain(|&node| is_reached(node));
    let mut found: Vec<Target> = (nodes.into_iter())
        .map(|wall| Target { wall, split: None })
        .collect();
    for &edge in near {
        let [a, b] = walls.ends(edge);
        let length = a.distance(b) / pitch;
        let foot = foot(from, a, b) / pitch;
        for shift in -3..=3 {
            let at = foot + 0.25 * f64::from(shift);
            if at < SPLIT_FROM_END || length - at < SPLIT_FROM_END {
                continue;
            }
            let wall = between(a, b, at / length);
            if is_reached(wall) {
                let split = Some(edge);
                found.push(Target { wall, split });
            }
        }
    }
    found
}

/// Where on the line `a b` the foot of `p` is: the distance from `a`, cells.
fn foot(p: Point, a: Point, b: Point) -> f64 {
    let d = |u: i32, v: i32| f64::from(u) - f64::from(v);
    let dot = d(p.x, a.x) * d(b.x, a.x) + d(p.y, a.y) * d(b.y, a.y);
    dot / a.distance(b)
}

/// The grid point nearest to the one at share `t` of the way from `a` to `b`.
fn between(a: Point, b: Point, t: f64) -> Point {
    let mix = |u: i32, v: i32| (f64::from(u) + t * (f64::from(v) - f64::from(u))).round() as i32;
    Point::new(mix(a.x, b.x), mix(a.y, b.y))
}

/// What a way from `from` (with the seam heading for `heading`) to `target` costs; none if it is
/// not good enough. Lengths in pitches, relative to `from`.
fn price(walls: &Walls, [from, heading]: [Point; 2], target: &Target, near: &[u32]) -> Option<f64> {
    let pitch = f64::from(walls.pitch);
    let local = |p: Point| {
        let d = |u: i32, v: i32| (f64::from(u) - f64::from(v)) / pitch;
        [d(p.x, from.x), d(p.y, from.y)]
    };
    let at = local(target.wall);
    let turn_deg = angle_deg(local(heading), at);
    if turn_deg > TURN_DEG {
        return None;
    }
    let mut angles_deg = Vec::new();
    for &edge in near {
        let [a, b] = walls.ends(edge);
        let is_split = target.split == Some(edge);
        for (end, other) in [(a, b), (b, a)] {
            if is_split || other == target.wall {
                let back = [-at[0], -at[1]];
                angles_deg.push(angle_deg(back, minus(local(end), at)));
            }
        }
        let is_own = is_split || a == target.wall || b == target.wall;
        if !is_own && !is_clear(at, local(a), local(b)) {
            return None;
        }
        if !is_own && meet([from, target.wall], [a, b]) {
            return None;
        }
        if is_split && !fits(walls, edge, target.wall, near) {
            return None;
        }
    }
    let corner = corner_price(&angles_deg, target.split.is_some())?;
    let length = at[0].hypot(at[1]);
    let off_length = (length - length.round().max(1.0)).abs();
    Some(1.0 + corner + turn_deg / 60.0 + off_length + split_price(walls, target))
}

/// What the angles at the wall cost. A slit is best prolonged, any other wall best met at 90
/// degrees or, outside a corner, at more.
fn corner_price(angles_deg: &[f64], is_split: bool) -> Option<f64> {
    let least = angles_deg.iter().copied().fold(f64::INFINITY, f64::min);
    let limit = if is_split {
        ANGLE_AT_SPLIT_DEG
    } else {
        ANGLE_AT_NODE_DEG
    };
    if least < limit {
        return None;
    }
    let best = if angles_deg.len() == 1 { 180.0 } else { 90.0 };
    Some((best - least).max(0.0) / 30.0)
}

/// What splitting an edge costs: a wall node more, and lengths far from whole sizes.
fn split_price(walls: &Walls, target: &Target) -> f64 {
    let Some(edge) = target.split else {
        return 0.0;
    };
    let off = walls.ends(edge).map(|end| {
        let length = end.distance(target.wall) / f64::from(walls.pitch);
        (length - length.round().max(1.0)).abs() / length
    });
    0.1 + off[0] + off[1]
}

/// True if the edge `a b` is clear of the end piece from the origin to `at`: as far as [`CLEAR`],
/// or as [`CONE`] allows near `at`.
fn is_clear(at: Xy, a: Xy, b: Xy) -> bool {
    let limit = |p: Xy| CLEAR.min(CONE * (p[0] - at[0]).hypot(p[1] - at[1]));
    let ends = [a, b]
        .iter()
        .all(|&p| distance_to_segment(p, [0.0, 0.0], at) >= limit(p));
    ends && [0.0, 0.25, 0.5, 0.75].iter().all(|share| {
        let p = [share * at[0], share * at[1]];
        distance_to_segment(p, a, b) >= limit(p)
    })
}

/// True if the halves of `edge`, split at `wall` (off it by rounding), meet no other edge near.
fn fits(walls: &Walls, edge: u32, wall: Point, near: &[u32]) -> bool {
    let ends = walls.ends(edge);
    near.iter().filter(|&&other| other != edge).all(|&other| {
        let [c, d] = walls.ends(other);
        ends.iter().all(|&end| {
            let half = [end, wall];
            if c == end || d == end {
                let far = if c == end { d } else { c };
                !meet(half, [far, far]) && !meet([end, far], [wall, wall])
            } else {
                !meet(half, [c, d])
            }
        })
    })
}

fn minus(p: Xy, q: Xy) -> Xy {
    [p[0] - q[0], p[1] - q[1]]
}

/// Angle between two directions, degrees, 0 to 180.
pub(super) fn angle_deg(u: Xy, v: Xy) -> f64 {
    let (cross, dot) = (u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]);
    cross.abs().atan2(dot).to_degrees()
}
