//! The promises of settling as code, on the line work before and after a round.

use crate::cleanup;
use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::geometry::grid::Grid;
use crate::noding;
use crate::noding::arrangement::Arrangement;
use crate::partition::remeasure;
use crate::partition::subdomains::Partition;
use crate::settling::REACH;
use crate::settling::Settled;

/// Checks one round, which made `after` of `before`; `partition` is that of both.
///
/// Distances to the lines are checked by clean-up's own measure. That no node jumped over an edge: the line work is
/// planar, and no sub-domain inside out.
pub fn check(
    domain: &Domain,
    sizes: &SizeWish,
    options: &cleanup::Options,
    [before, after]: [&Arrangement; 2],
    partition: &Partition,
    settled: &Settled,
) -> Result<(), String> {
    if before.edges != after.edges || before.piece_start != after.piece_start {
        return Err("the topology changed".into());
    }
    for edge in 0..before.edges.len() as u32 {
        let lines = |it: &Arrangement| -> Vec<u32> {
            it.pieces_of(edge).iter().map(|piece| piece.line).collect()
        };
        if lines(before) != lines(after) {
            return Err(format!("edge {edge} carries other lines"));
        }
    }
    let reach_m = REACH
        * sizes
            .by_kind_m
            .iter()
            .copied()
            .fold(sizes.default_m, f64::max);
    check_moves(&domain.grid, [before, after], settled, reach_m)?;
    cleanup::shifts::check(domain, sizes, options, [before, after])?;
    noding::check::check(&in_order(after)).map_err(|it| it.to_string())?;
    let mut measured = partition.clone();
    remeasure(domain, after, &mut measured);
    if let Some(k) = measured.subdomains.iter().position(|it| it.area_m2 <= 0.0) {
        return Err(format!("sub-domain {k} is inside out"));
    }
    let [was, is] = settled.poorest;
    match is >= was {
        true => Ok(()),
        false => Err(format!(
            "the poorest quad was worth {was}, and is worth {is}"
        )),
    }
}

/// The same line work with points in their order.
fn in_order(arrangement: &Arrangement) -> Arrangement {
    let edges = (0..).zip(&arrangement.edges);
    let parts = edges.map(|(edge, &ends)| (ends, arrangement.pieces_of(edge).to_vec()));
    Arrangement::from_parts(&arrangement.points, parts.collect())
}

/// Nodes that are said to have moved did, no farther than they may; no others; and no ends of seams.
fn check_moves(
    grid: &Grid,
    [before, after]: [&Arrangement; 2],
    settled: &Settled,
    reach_m: f64,
) -> Result<(), String> {
    let mut stays = vec![false; before.points.len()];
    for (edge, ends) in (0..).zip(&before.edges) {
        for &end in ends {
            stays[end as usize] |= before.pieces_of(edge).is_empty();
        }
    }
    for (node, stays) in stays.into_iter().enumerate() {
        let (from, to) = (before.points[node], after.points[node]);
        let way_m = from.distance(to) * grid.cell_m;
        if from != to && (stays || !settled.moved[node]) {
            return Err(format!("node {node} has moved, and may not"));
        }
        if way_m > reach_m + 1e-9 {
            return Err(format!("node {node} has moved by {way_m} m"));
        }
    }
    Ok(())
}
