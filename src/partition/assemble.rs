//! Walks of half-edges -> the partition.

use crate::domain::line::Domain;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::noding::arrangement::Arrangement;
use crate::noding::rim::rim_side;
use crate::partition::chain::Chains;
use crate::partition::error::Error;
use crate::partition::nest::halves_below;
use crate::partition::star::HalfEdge;
use crate::partition::star::tail;
use crate::partition::subdomains::Curve;
use crate::partition::subdomains::HalfCurve;
use crate::partition::subdomains::OUTSIDE;
use crate::partition::subdomains::Partition;
use crate::partition::subdomains::Subdomain;
use crate::partition::walk::begin_at_least;

/// The walks inside the domain, by face.
pub struct Faces {
    walks: Vec<Vec<HalfEdge>>,
    /// Twice the area of each walk, cells².
    area2: Vec<i128>,
    /// For each walk, the outer walk of its face (itself, if it is one).
    face: Vec<u32>,
}

/// The faces with these walks, which [`join`](crate::partition::join) made.
pub fn faces(
    domain: &Domain,
    arrangement: &Arrangement,
    mut walks: Vec<Vec<HalfEdge>>,
) -> Result<Faces, Error> {
    drop_outside(domain, arrangement, &mut walks)?;
    let area2: Vec<i128> = walks.iter().map(|walk| area2(arrangement, walk)).collect();
    let face = outer_walks(domain, arrangement, &walks, &area2)?;
    Ok(Faces { walks, area2, face })
}

/// The partition with these faces and [`chains`].
pub fn assemble(domain: &Domain, faces: Faces, chains: Chains) -> Partition {
    let Faces { walks, area2, face } = faces;
    let Chains { mut curves, begins } = chains;
    let mut subdomains = vec![Subdomain::default(); walks.len()];
    let mut area2_of = vec![0; walks.len()];
    for (w, walk) in walks.iter().enumerate() {
        let mut halves: Vec<HalfCurve> = walk.iter().filter_map(|&h| begins[h as usize]).collect();
        begin_at_least(&mut halves);
        let walks = &mut subdomains[face[w] as usize].walks;
        if face[w] as usize == w {
            walks.insert(0, halves);
        } else {
            walks.push(halves);
        }
        area2_of[face[w] as usize] += area2[w];
    }
    let cell2 = domain.grid.cell_m * domain.grid.cell_m;
    for (subdomain, area2) in subdomains.iter_mut().zip(area2_of) {
        subdomain.area_m2 = 0.5 * area2 as f64 * cell2;
    }
    subdomains.retain(|subdomain| !subdomain.walks.is_empty());
    number(&mut subdomains, &mut curves);
    Partition { curves, subdomains }
}

/// Sorts sub-domains by their least half-curve and tells the curves.
fn number(subdomains: &mut [Subdomain], curves: &mut [Curve]) {
    for subdomain in subdomains.iter_mut() {
        subdomain.walks[1..].sort_unstable();
    }
    // Walks begin with their least half-curve.
    subdomains.sort_by_key(|subdomain| subdomain.walks.iter().map(|walk| walk[0]).min());
    for (id, subdomain) in subdomains.iter().enumerate() {
        for &half in subdomain.walks.iter().flatten() {
            let curve = &mut curves[(half >> 1) as usize];
            let side = if half & 1 == 0 {
                &mut curve.left
            } else {
                &mut curve.right
            };
            debug_assert_eq!(*side, OUTSIDE);
            *side = id as u32;
        }
    }
}

/// Drops the walks that have the outside on their left.
fn drop_outside(
    domain: &Domain,
    arrangement: &Arrangement,
    walks: &mut Vec<Vec<HalfEdge>>,
) -> Result<(), Error> {
    let is_outside = |half: HalfEdge| {
        let side = rim_side(domain, arrangement.pieces_of(half >> 1));
        side == if half & 1 == 0 { -1 } else { 1 }
    };
    let mut torn = None;
    walks.retain(|walk| {
        let outside = is_outside(walk[0]);
        if let Some(&other) = walk.iter().find(|&&half| is_outside(half) != outside) {
            torn = torn.or(Some(tail(arrangement, other)));
        }
        !outside
    });
    if let Some(node) = torn {
        let at_m = place(domain, arrangement, node);
        return Err(Error::TornRim { at_m });
    }
    if walks.is_empty() {
        let first = domain.lines.first().map(|line| line.points[0]);
        let at_m = domain.grid.projected_m(first.unwrap_or(Point::new(0, 0)));
        return Err(Error::NoInside { at_m });
    }
    Ok(())
}

fn place(domain: &Domain, arrangement: &Arrangement, node: u32) -> Xy {
    domain.grid.projected_m(arrangement.points[node as usize])
}

/// Measures all areas again, where nodes of the arrangement were moved.
pub fn remeasure(domain: &Domain, arrangement: &Arrangement, partition: &mut Partition) {
    let cell2 = domain.grid.cell_m * domain.grid.cell_m;
    let curves = &partition.curves;
    for subdomain in &mut partition.subdomains {
        let all = subdomain.walks.iter().flatten();
        let of_curve = all.map(|&half| area2(arrangement, &halves(arrangement, curves, half)));
        subdomain.area_m2 = 0.5 * of_curve.sum::<i128>() as f64 * cell2;
    }
}

/// The half-edges of a half-curve, in its direction.
pub(super) fn halves(
    arrangement: &Arrangement,
    curves: &[Curve],
    half: HalfCurve,
) -> Vec<HalfEdge> {
    let curve = &curves[(half >> 1) as usize];
    let along =
        curve.edges.iter().zip(&curve.nodes).map(|(&edge, &node)| {
            edge << 1 | u32::from(arrangement.edges[edge as usize][0] != node)
        });
    if half & 1 == 0 {
        along.collect()
    } else {
        along.rev().map(|it| it ^ 1).collect()
    }
}

/// Twice the signed area of a walk, cells². Exact: the terms stay below 2^60.
pub(super) fn area2(arrangement: &Arrangement, walk: &[HalfEdge]) -> i128 {
    let cross = |half: HalfEdge| {
        let a = arrangement.points[tail(arrangement, half) as usize];
        let b = arrangement.points[tail(arrangement, half ^ 1) as usize];
        i64::from(a.x) * i64::from(b.y) - i64::from(a.y) * i64::from(b.x)
    };
    walk.iter().map(|&half| i128::from(cross(half))).sum()
}

/// For each walk, the outer walk of its face (itself, if it is one).
fn outer_walks(
    domain: &Domain,
    arrangement: &Arrangement,
    walks: &[Vec<HalfEdge>],
    area2: &[i128],
) -> Result<Vec<u32>, Error> {
    let mut walk_of = vec![u32::MAX; 2 * arrangement.edges.len()];
    for (w, walk) in walks.iter().enumerate() {
        for &half in walk {
            walk_of[half as usize] = w as u32;
        }
    }
    let mut inner: Vec<(u32, usize)> = (0..walks.len())
        .filter(|&w| area2[w] <= 0)
        .map(|w| {
            let least = walks[w].iter().map(|&half| tail(arrangement, half)).min();
            (least.expect("a walk has half-edges"), w)
        })
        .collect();
    inner.sort_unstable();
    let starts: Vec<Point> = inner
        .iter()
        .map(|&(node, _)| arrangement.points[node as usize])
        .collect();
    let below = halves_below(arrangement, &starts);
    let mut face: Vec<u32> = (0..walks.len() as u32).collect();
    for (&(node, w), below) in inner.iter().zip(below) {
        let seen = below.map_or(u32::MAX, |half| walk_of[half as usize]);
        if seen == u32::MAX {
            let at_m = place(domain, arrangement, node);
            return Err(Error::TornRim { at_m });
        }
        // An inner walk seen from here began at a smaller node: its face is known already.
        face[w] = face[seen as usize];
    }
    Ok(face)
}
