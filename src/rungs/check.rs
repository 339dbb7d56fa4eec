//! The promises of `rungs`, as code, on the arrangement alone.

use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::geometry::point::Point;
use crate::noding::arrangement::Arrangement;
use crate::rungs::ANGLE_DEG;
use crate::rungs::CLEAR;
use crate::rungs::Options;
use crate::rungs::edge_sizes;
use crate::seams::clearance::Buckets;
use crate::seams::clearance::distance_between;

/// What the rounding of feet to the grid may take, degrees and cells.
const ROUNDING_DEG: f64 = 1.0;
const ROUNDING_CELLS: f64 = 2.0;

/// A broken promise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Defect {
    /// What is wrong.
    pub what: &'static str,
    /// Where.
    pub at: Point,
}

/// Verifies promises 1 and 2 on an arrangement whose seams are all rungs.
pub fn check(
    domain: &Domain,
    sizes: &SizeWish,
    runged: &Arrangement,
    options: &Options,
) -> Result<(), Defect> {
    let size_of = edge_sizes(domain, sizes, runged);
    let largest = size_of.iter().copied().fold(1.0, f64::max);
    let buckets = Buckets::of(runged, 2 * largest as i32);
    let mut around = vec![Vec::new(); runged.points.len()];
    for (edge, nodes) in runged.edges.iter().enumerate() {
        nodes
            .iter()
            .for_each(|&node| around[node as usize].push(edge as u32));
    }
    let is_rung = |edge: u32| runged.pieces_of(edge).is_empty();
    for rung in (0..runged.edges.len() as u32).filter(|&edge| is_rung(edge)) {
        let nodes = runged.edges[rung as usize];
        let [a, b] = nodes.map(|node| runged.points[node as usize]);
        let lines = |node: u32| around[node as usize].iter().filter(|&&it| !is_rung(it));
        let size = (nodes.iter().flat_map(|&node| lines(node)))
            .map(|&line| size_of[line as usize])
            .fold(f64::INFINITY, f64::min);
        ensure(size.is_finite(), "a rung joins lines", a)?;
        let longest = options.longest * size + ROUNDING_CELLS;
        ensure(a.distance(b) <= longest, "a rung is short", a)?;
        for (end, other) in [(0, b), (1, a)] {
            let here = runged.points[nodes[end] as usize];
            for &edge in around[nodes[end] as usize].iter().filter(|&&it| it != rung) {
                let far = runged.edges[edge as usize]
                    .map(|node| runged.points[node as usize])
                    .into_iter()
                    .find(|&p| p != here);
                let angle = far.map_or(0.0, |far| angle_deg(here, other, far));
                ensure(angle >= ANGLE_DEG - ROUNDING_DEG, "a rung has room", here)?;
            }
        }
        let clear = CLEAR * size - ROUNDING_CELLS;
        for edge in buckets.near([a, b], clear.max(0.0)) {
            let others = runged.edges[edge as usize];
            let apart = || {
                distance_between([a, b], others.map(|node| runged.points[node as usize])) >= clear
            };
            let is_touched = others.iter().any(|node| nodes.contains(node));
            ensure(is_touched || apart(), "a rung keeps away", a)?;
        }
    }
    Ok(())
}

fn ensure(holds: bool, what: &'static str, at: Point) -> Result<(), Defect> {
    if holds {
        Ok(())
    } else {
        Err(Defect { what, at })
    }
}

/// The angle at `here` between two points, degrees.
fn angle_deg(here: Point, p: Point, q: Point) -> f64 {
    let toward = |to: Point| {
        let (dx, dy) = (
            i64::from(to.x) - i64::from(here.x),
            i64::from(to.y) - i64::from(here.y),
        );
        (dy as f64).atan2(dx as f64)
    };
    let turn = (toward(p) - toward(q)).abs().to_degrees();
    turn.min(360.0 - turn)
}
