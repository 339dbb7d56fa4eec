//! The promises of `seams`, as code.

use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::Partition;
use crate::seams::Options;
use crate::seams::SLACK;
use crate::seams::clearance::Buckets;
use crate::seams::clearance::distance_between;
use crate::seams::ends::ANGLE_AT_NODE_DEG;
use crate::seams::ends::LENGTH;
use crate::seams::ends::angle_deg;
use crate::seams::pitch_cells;

/// What a stretch on the lattice keeps from walls, pitches.
const CLEAR: f64 = 1.2;

/// A broken promise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Defect {
    /// What is wrong.
    pub what: &'static str,
    /// Where.
    pub at: Point,
}

/// Verifies promises 2 to 4 on an arrangement with seams.
pub fn check(domain: &Domain, sizes: &SizeWish, seamed: &Arrangement) -> Result<(), Defect> {
    let pitch = pitch_cells(domain, sizes);
    let buckets = Buckets::of(seamed, 2 * pitch);
    let is_seam = |edge: u32| seamed.pieces_of(edge).is_empty();
    let mut is_wall = vec![false; seamed.points.len()];
    for (edge, nodes) in seamed.edges.iter().enumerate() {
        if !is_seam(edge as u32) {
            nodes.iter().for_each(|&node| is_wall[node as usize] = true);
        }
    }
    for edge in (0..seamed.edges.len() as u32).filter(|&edge| is_seam(edge)) {
        let [a, b] = seamed.edges[edge as usize];
        match [is_wall[a as usize], is_wall[b as usize]] {
            [false, false] => check_straight(seamed, &buckets, edge, pitch)?,
            [true, false] => check_end(seamed, &buckets, [a, b], pitch)?,
            [false, true] => check_end(seamed, &buckets, [b, a], pitch)?,
            [true, true] => ensure(false, "a seam is not one edge", seamed.points[a as usize])?,
        }
    }
    Ok(())
}

/// Verifies promise 1: the number of parts that are too large is that of the findings.
pub fn check_sizes(
    domain: &Domain,
    sizes: &SizeWish,
    partition: &Partition,
    findings: usize,
    options: &Options,
) -> bool {
    let pitch = pitch_cells(domain, sizes);
    let most = SLACK * options.budget_quads;
    let large = |part: &&_| super::quads(domain, pitch, part) > most * (1.0 + 1e-9);
    partition.subdomains.iter().filter(large).count() <= findings
}

fn ensure(holds: bool, what: &'static str, at: Point) -> Result<(), Defect> {
    if holds {
        Ok(())
    } else {
        Err(Defect { what, at })
    }
}

fn ends_of(seamed: &Arrangement, edge: u32) -> [Point; 2] {
    seamed.edges[edge as usize].map(|node| seamed.points[node as usize])
}

fn is_lattice(p: Point, pitch: i32) -> bool {
    p.x % pitch == 0 && p.y % pitch == 0
}

fn check_straight(
    seamed: &Arrangement,
    buckets: &Buckets,
    edge: u32,
    pitch: i32,
) -> Result<(), Defect> {
    let [a, b] = ends_of(seamed, edge);
    let on_lattice = is_lattice(a, pitch) && is_lattice(b, pitch);
    ensure(
        on_lattice && (a.x == b.x || a.y == b.y),
        "a seam is on the lattice",
        a,
    )?;
    let reach = CLEAR * f64::from(pitch);
    for other in buckets.near([a, b], reach) {
        let is_wall = !seamed.pieces_of(other).is_empty();
        let is_clear = distance_between([a, b], ends_of(seamed, other)) >= reach;
        ensure(!is_wall || is_clear, "a seam keeps away from walls", a)?;
    }
    Ok(())
}

fn check_end(
    seamed: &Arrangement,
    buckets: &Buckets,
    [wall, lattice]: [u32; 2],
    pitch: i32,
) -> Result<(), Defect> {
    let [at, from] = [wall, lattice].map(|node| seamed.points[node as usize]);
    ensure(
        is_lattice(from, pitch),
        "an end piece leaves a lattice point",
        from,
    )?;
    let length = at.distance(from) / f64::from(pitch);
    let is_so = (LENGTH[0]..=LENGTH[1]).contains(&length);
    ensure(is_so, "an end piece is one or two sizes long", at)?;
    let towards = |p: Point| -> Xy {
        [
            f64::from(p.x) - f64::from(at.x),
            f64::from(p.y) - f64::from(at.y),
        ]
    };
    let mut seams = 0;
    for other in buckets.near([at, at], 1.0) {
        let ends = ends_of(seamed, other);
        if !ends.contains(&at) {
            continue;
        }
        if seamed.pieces_of(other).is_empty() {
            seams += 1;
            continue;
        }
        let far = if ends[0] == at { ends[1] } else { ends[0] };
        let angle = angle_deg(towards(from), towards(far));
        ensure(
            angle >= ANGLE_AT_NODE_DEG - 0.1,
            "an end piece meets its wall steeply",
            at,
        )?;
    }
    ensure(seams == 1, "a wall node has one seam", at)
}
