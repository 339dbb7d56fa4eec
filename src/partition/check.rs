//! The promises of `partition`, as code.

use crate::domain::line::Domain;
use crate::geometry::predicates::by_angle;
use crate::noding::arrangement::Arrangement;
use crate::noding::rim::rim_side;
use crate::partition::assemble::area2;
use crate::partition::assemble::halves;
use crate::partition::star::HalfEdge;
use crate::partition::star::Stars;
use crate::partition::star::direction;
use crate::partition::star::head;
use crate::partition::star::tail;
use crate::partition::subdomains::Curve;
use crate::partition::subdomains::HalfCurve;
use crate::partition::subdomains::OUTSIDE;
use crate::partition::subdomains::Partition;

/// A broken promise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Defect {
    /// What is wrong.
    pub what: &'static str,
    /// A node near it, index into `Arrangement::points`.
    pub node: u32,
}

/// Verifies every promise of the stage's page but the last. O(n) for bounded degrees.
pub fn check(
    domain: &Domain,
    arrangement: &Arrangement,
    partition: &Partition,
) -> Result<(), Defect> {
    check_curves(arrangement, &partition.curves)?;
    check_sides(partition)?;
    check_areas(domain, arrangement, partition)?;
    check_euler(domain, arrangement, partition)
}

fn ensure(holds: bool, what: &'static str, node: u32) -> Result<(), Defect> {
    if holds {
        Ok(())
    } else {
        Err(Defect { what, node })
    }
}

fn check_curves(arrangement: &Arrangement, curves: &[Curve]) -> Result<(), Defect> {
    let stars = Stars::of_all(arrangement);
    let mut used = vec![false; arrangement.edges.len()];
    for curve in curves {
        let node = curve.nodes[0];
        ensure(
            !curve.edges.is_empty() && curve.nodes.len() == curve.edges.len() + 1,
            "a curve has one more node than edges",
            node,
        )?;
        for (k, &edge) in curve.edges.iter().enumerate() {
            let ends = [curve.nodes[k], curve.nodes[k + 1]];
            let is_its_edge =
                arrangement.edges[edge as usize] == [ends[0].min(ends[1]), ends[0].max(ends[1])];
            ensure(is_its_edge, "an edge of a curve joins its nodes", ends[0])?;
            ensure(!used[edge as usize], "an edge lies on one curve", ends[0])?;
            used[edge as usize] = true;
            let is_seam = arrangement.pieces_of(edge).is_empty();
            ensure(is_seam == curve.is_seam, "a seam has no pieces", ends[0])?;
        }
        for &inner in &curve.nodes[1..curve.nodes.len() - 1] {
            let degree = stars.of(inner as usize).len();
            ensure(degree == 2, "a curve passes no junction", inner)?;
        }
    }
    let missed = used.iter().position(|&it| !it);
    ensure(
        missed.is_none(),
        "an edge lies on one curve",
        missed.map_or(0, |edge| arrangement.edges[edge][0]),
    )
}

fn check_sides(partition: &Partition) -> Result<(), Defect> {
    let mut side = vec![OUTSIDE; 2 * partition.curves.len()];
    for (id, subdomain) in partition.subdomains.iter().enumerate() {
        for &half in subdomain.walks.iter().flatten() {
            let node = partition.curves[(half >> 1) as usize].nodes[0];
            let free = side[half as usize] == OUTSIDE;
            ensure(free, "a half-curve occurs in one walk", node)?;
            side[half as usize] = id as u32;
        }
    }
    for (c, curve) in partition.curves.iter().enumerate() {
        let is_so = [curve.left, curve.right] == [side[2 * c], side[2 * c + 1]];
        ensure(is_so, "a curve knows its sides", curve.nodes[0])?;
    }
    Ok(())
}

/// The half-edges of each walk of each sub-domain.
fn walks_of_halves(arrangement: &Arrangement, partition: &Partition) -> Vec<Vec<Vec<HalfEdge>>> {
    let in_halves = |walk: &Vec<HalfCurve>| -> Vec<HalfEdge> {
        (walk.iter())
            .flat_map(|&half| halves(arrangement, &partition.curves, half))
            .collect()
    };
    (partition.subdomains.iter())
        .map(|subdomain| subdomain.walks.iter().map(in_halves).collect())
        .collect()
}

fn check_areas(
    domain: &Domain,
    arrangement: &Arrangement,
    partition: &Partition,
) -> Result<(), Defect> {
    let cell2 = domain.grid.cell_m * domain.grid.cell_m;
    let mut total: i128 = 0;
    for (walks, subdomain) in walks_of_halves(arrangement, partition)
        .iter()
        .zip(&partition.subdomains)
    {
        let node = tail(arrangement, walks[0][0]);
        let areas: Vec<i128> = walks.iter().map(|walk| area2(arrangement, walk)).collect();
        ensure(areas[0] > 0, "the first walk is the outer one", node)?;
        let inner = areas[1..].iter().all(|&area| area <= 0);
        ensure(inner, "a sub-domain has one outer walk", node)?;
        let sum: i128 = areas.iter().sum();
        let is_so = subdomain.area_m2 == 0.5 * sum as f64 * cell2;
        ensure(sum > 0 && is_so, "a sub-domain knows its area", node)?;
        total += sum;
    }
    let rim: i128 = (0..arrangement.edges.len() as u32)
        .map(|edge| {
            let side = rim_side(domain, arrangement.pieces_of(edge));
            i128::from(side) * area2(arrangement, &[edge << 1])
        })
        .sum();
    ensure(total == rim, "areas sum to the area inside the rim", 0)
}

/// The half-edge that leaves the head of `half` first clockwise from `half` reversed: the slow way,
/// without sorting.
fn sharpest_left(arrangement: &Arrangement, stars: &Stars, half: HalfEdge) -> HalfEdge {
    let angle = |a: &HalfEdge, b: &HalfEdge| {
        by_angle(direction(arrangement, *a), direction(arrangement, *b))
    };
    let star = stars.of(head(arrangement, half) as usize);
    let back = half ^ 1;
    (star.iter().copied())
        .filter(|other| angle(other, &back).is_lt())
        .max_by(angle)
        .or_else(|| star.iter().copied().max_by(angle))
        .expect("the star of a node contains the way back")
}

/// Walks are those of the faces, and nodes - edges + walks = 2 in each connected component.
fn check_euler(
    domain: &Domain,
    arrangement: &Arrangement,
    partition: &Partition,
) -> Result<(), Defect> {
    let stars = Stars::of_all(arrangement);
    let mut walked = vec![false; 2 * arrangement.edges.len()];
    let mut walk_heads = Vec::new();
    for walk in walks_of_halves(arrangement, partition).iter().flatten() {
        for (k, &half) in walk.iter().enumerate() {
            let next = walk[(k + 1) % walk.len()];
            let is_next = next == sharpest_left(arrangement, &stars, half);
            let node = head(arrangement, half);
            ensure(is_next, "a walk is closed and goes around one face", node)?;
            walked[half as usize] = true;
        }
        walk_heads.push(head(arrangement, walk[0]));
    }
    for first in 0..walked.len() as u32 {
        if walked[first as usize] {
            continue;
        }
        let mut half = first;
        while !walked[half as usize] {
            let side = rim_side(domain, arrangement.pieces_of(half >> 1));
            let is_outside = side == if half & 1 == 0 { -1 } else { 1 };
            let node = tail(arrangement, half);
            ensure(is_outside, "what no walk takes is outside", node)?;
            walked[half as usize] = true;
            half = sharpest_left(arrangement, &stars, half);
        }
        walk_heads.push(head(arrangement, first));
    }
    euler_sums(arrangement, &walk_heads)
}

fn euler_sums(arrangement: &Arrangement, walk_heads: &[u32]) -> Result<(), Defect> {
    let mut parent: Vec<u32> = (0..arrangement.points.len() as u32).collect();
    let root = |parent: &mut Vec<u32>, mut node: u32| {
        while parent[node as usize] != node {
            parent[node as usize] = parent[parent[node as usize] as usize];
            node = parent[node as usize];
        }
        node
    };
    for &[a, b] in &arrangement.edges {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        parent[b as usize] = a;
    }
    let mut sum = vec![0i64; arrangement.points.len()];
    for node in 0..arrangement.points.len() as u32 {
        sum[root(&mut parent, node) as usize] += 1;
    }
    for &[a, _] in &arrangement.edges {
        sum[root(&mut parent, a) as usize] -= 1;
    }
    for &node in walk_heads {
        sum[root(&mut parent, node) as usize] += 1;
    }
    for node in 0..arrangement.points.len() as u32 {
        let is_root = parent[node as usize] == node;
        ensure(
            !is_root || sum[node as usize] == 2,
            "Euler's formula holds",
            node,
        )?;
    }
    Ok(())
}
