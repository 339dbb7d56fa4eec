//! Which stretches of raster lines are free of walls.

use crate::geometry::point::Point;
use crate::partition::subdomains::Partition;
use crate::partition::subdomains::SubdomainId;
use crate::partition::subdomains_at;
use crate::seams::raster::Along;
use crate::seams::raster::LatticeLine;
use crate::seams::walls::Walls;

/// What a raster line keeps from walls, pitches; what it promises is a little less.
const CLEAR: f64 = 1.25;

/// A stretch of a raster line in one sub-domain, free of walls; its ends come near to some.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gap {
    pub on: LatticeLine,
    pub face: SubdomainId,
    /// Its first and its last lattice point.
    pub first: i64,
    pub last: i64,
    /// Pitches between lines of the raster.
    pub step: i64,
}

/// The gaps in all sub-domains with a raster; `step[face]` is the distance between its lines.
pub(super) fn gaps(walls: &Walls, partition: &Partition, step: &[Option<i64>]) -> Vec<Gap> {
    let mut steps: Vec<i64> = step.iter().copied().flatten().collect();
    steps.sort_unstable();
    steps.dedup();
    let mut found = Vec::new();
    for &at in &steps {
        let has_step = |face: SubdomainId| step.get(face as usize) == Some(&Some(at));
        let edges: Vec<u32> = (0..walls.arrangement.edges.len() as u32)
            .filter(|&edge| {
                let [left, right] = [0, 1].map(|k| walls.side[(edge << 1 | k) as usize]);
                has_step(left) || has_step(right)
            })
            .collect();
        for along in [Along::X, Along::Y] {
            found.extend(gaps_along(walls, &edges, along, at));
        }
    }
    let firsts: Vec<Point> = (found.iter())
        .map(|gap| gap.on.point(gap.first, walls.pitch))
        .collect();
    let faces = subdomains_at(walls.arrangement, partition, &firsts);
    for (gap, face) in found.iter_mut().zip(faces) {
        gap.face = face;
    }
    // Other faces may lie between walls of ours, or be those of another raster.
    found.retain(|gap| step.get(gap.face as usize) == Some(&Some(gap.step)));
    found
}

/// A stretch of a line that is too near to a wall: line, from, to; in pitches.
type Blocked = (i64, f64, f64);

fn gaps_along(walls: &Walls, edges: &[u32], along: Along, step: i64) -> Vec<Gap> {
    let mut blocked = Vec::new();
    for &edge in edges {
        block(walls, edge, along, step, &mut blocked);
    }
    blocked.sort_by(|p, q| p.0.cmp(&q.0).then(p.1.total_cmp(&q.1)));
    let mut gaps = Vec::new();
    for on_line in blocked.chunk_by(|p, q| p.0 == q.0) {
        let line = on_line[0].0;
        let mut until = on_line[0].2;
        for &(_, from, to) in on_line {
            let (first, last) = (until.ceil() as i64, from.floor() as i64);
            if until < from && first <= last {
                gaps.push(Gap {
                    on: LatticeLine { along, line },
                    face: 0,
                    first,
                    last,
                    step,
                });
            }
            until = until.max(to);
        }
    }
    gaps
}

/// What wall `edge` takes of the lines of the raster: their cuts with the disc of radius [`CLEAR`]
/// drawn along the wall, which is convex: two discs and the rectangle between them.
fn block(walls: &Walls, edge: u32, along: Along, step: i64, blocked: &mut Vec<Blocked>) {
    let pitch = f64::from(walls.pitch);
    let [(s0, t0), (s1, t1)] = walls.ends(edge).map(|p| {
        let (across, along) = along.split(p);
        (across as f64 / pitch, along as f64 / pitch)
    });
    let length = (s1 - s0).hypot(t1 - t0);
    let (ns, nt) = (CLEAR * (t0 - t1) / length, CLEAR * (s1 - s0) / length);
    let corners = [
        (s0 + ns, t0 + nt),
        (s1 + ns, t1 + nt),
        (s1 - ns, t1 - nt),
        (s0 - ns, t0 - nt),
    ];
    let first = ((s0.min(s1) - CLEAR) / step as f64).ceil() as i64;
    let last = ((s0.max(s1) + CLEAR) / step as f64).floor() as i64;
    for line in (first..=last).map(|k| k * step) {
        let at = line as f64;
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut take = |low: f64, high: f64| {
            from = from.min(low);
            to = to.max(high);
        };
        for (s, t) in [(s0, t0), (s1, t1)] {
            let half2 = CLEAR * CLEAR - (at - s) * (at - s);
            if half2 >= 0.0 {
                take(t - half2.sqrt(), t + half2.sqrt());
            }
        }
        for k in 0..4 {
            let ((sa, ta), (sb, tb)) = (corners[k], corners[(k + 1) % 4]);
            if (sa - at) * (sb - at) <= 0.0 && sa != sb {
                let t = ta + (tb - ta) * (at - sa) / (sb - sa);
                take(t, t);
            }
        }
        if from <= to {
            blocked.push((line, from, to));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::CLEAR;
    use super::gaps;
    use crate::domain::line::Domain;
    use crate::domain::line::Line;
    use crate::domain::line::Role;
    use crate::geometry::grid::Grid;
    use crate::geometry::point::Point;
    use crate::noding;
    use crate::partition;
    use crate::partition::partition;
    use crate::seams::clearance::distance_between;
    use crate::seams::raster::Along;
    use crate::seams::raster::LatticeLine;
    use crate::seams::walls::Walls;
    use proptest::prelude::*;

    const PITCH: i32 = 100;

    fn domain(slits: &[[Point; 2]]) -> Domain {
        let line = |role, points: &[Point]| Line {
            source: 0,
            role,
            kind: 0,
            name: String::new(),
            points: points.to_vec(),
        };
        let rim = [(0, 0), (30, 3), (27, 35), (-4, 28), (0, 0)]
            .map(|(x, y)| Point::new(x * PITCH, y * PITCH));
        let slits = slits.iter().map(|slit| line(Role::Constraint, slit));
        let grid = Grid {
            origin_m: [0.0, 0.0],
            cell_m: 1.0,
        };
        Domain {
            grid,
            epsg: None,
            kinds: vec![String::new()],
            lines: [line(Role::Boundary, &rim)]
                .into_iter()
                .chain(slits)
                .collect(),
            digest: 0,
        }
    }

    fn point() -> impl Strategy<Value = Point> {
        (0..2700, 300..2800).prop_map(|(x, y)| Point::new(x, y))
    }

    proptest! {
        /// Slow twin: every lattice point on a raster line against every wall.
        #[test]
        fn gaps_have_all_clear_lattice_points(
            slits in prop::collection::vec((point(), point()), 0..6),
        ) {
            let slits: Vec<[Point; 2]> = (slits.into_iter())
                .filter(|(a, b)| a != b)
                .map(|(a, b)| [a, b])
                .collect();
            let domain = domain(&slits);
            let arrangement = noding::node(&domain, &noding::Options { tile_cells: 1 << 20 });
            let arrangement = noding::clip(&domain, arrangement).0;
            let options = partition::Options { corner_deg: 30.0, tile_cells: 1 << 20 };
            let faces = partition(&domain, &arrangement, &options).unwrap();
            let walls = Walls::of(&arrangement, &faces, PITCH);
            let step = vec![Some(3); faces.subdomains.len()];
            let gaps = gaps(&walls, &faces, &step);
            for along in [Along::X, Along::Y] {
                for line in (-12..45).step_by(3) {
                    let on = LatticeLine { along, line };
                    for k in -12..45 {
                        let p = on.point(k, PITCH);
                        let inside = partition::subdomains_at(&arrangement, &faces, &[p])[0];
                        let clear = (0..arrangement.edges.len() as u32)
                            .map(|edge| distance_between([p, p], walls.ends(edge)))
                            .fold(f64::INFINITY, f64::min) / f64::from(PITCH);
                        let gap = gaps.iter().find(|gap| {
                            gap.on == on && (gap.first..=gap.last).contains(&k)
                        });
                        let is_inside = (inside as usize) < faces.subdomains.len();
                        if (clear - CLEAR).abs() > 1e-9 {
                            prop_assert_eq!(gap.is_some(), is_inside && clear > CLEAR);
                            prop_assert!(gap.is_none_or(|gap| gap.face == inside));
                        }
                    }
                }
            }
        }
    }
}
