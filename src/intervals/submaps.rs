//! Sub-domains with re-entrant corners, several walks or free lines, whose counts should close on a
//! lattice.
//!
//! Their walks are laid on a square lattice, each edge in one of four directions ([`turns`]). If there
//! are as many intervals in a direction as against it, rows end nowhere, and the mesh needs no irregular
//! node; if not, each row that is missing is a dislocation. So to `parity` the four directions are the
//! sides of a block: opposite ones are equal. This is interval assignment for submapping (Whiteley,
//! White, Benzley, Blacker 1996). A free line goes both ways and drops out.
//!
//! Cost: O(edges of the walks).
//!
//! [`turns`]: crate::geometry::turns

use crate::geometry::turns::quarter_turns;
use crate::intervals::blocks::is_promising;
use crate::intervals::goals::Block;
use crate::intervals::goals::Goals;
use crate::intervals::sides::Walk;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::Partition;

/// An inner walk whose lattice is turned against that of the outer one by more than this has no clear
/// directions, degrees.
const ASKEW_DEG: f64 = 35.0;

/// Directions whose wishes differ by a greater ratio are left alone. Measured on a city of 10 000
/// segments: 1.5 leaves .06 % irregular nodes fewer, for .0009 of the mean shape and 2 % of the .1 %
/// quantile of time steps; 2.2, as other blocks have, leaves more.
const RATIO: f64 = 1.25;

/// Quads that such a block may have, as a square of its circumference would. Measured on synthetic cities and on a
/// real one at 10M quads: 800 leaves up to .07 % irregular nodes more at 3 m, but the programme takes half as long
/// at 10M (16 s beside 29 s; with 2500 nothing more is gained).
const QUADS_MAX: f64 = 1500.0;

/// The block of `subdomain`, if its walks nearly close as they are wished.
pub fn block(
    goals: &Goals,
    arrangement: &Arrangement,
    partition: &Partition,
    subdomain: u32,
) -> Option<Block> {
    by_direction(arrangement, partition, subdomain)
        .filter(|block| is_promising(goals, block, RATIO, QUADS_MAX))
}

/// The curves of `subdomain` by direction; `None` if its walks have none.
fn by_direction(arrangement: &Arrangement, partition: &Partition, subdomain: u32) -> Option<Block> {
    let mut sides = vec![Vec::new(); 4];
    let mut outer_deg = None;
    for walk in &partition.subdomains[subdomain as usize].walks {
        let walk = Walk::of(walk, arrangement, partition);
        let directed = directions(&walk, if outer_deg.is_none() { 4 } else { -4 })?;
        let axis_deg = axis_deg(&walk, &directed);
        let off_deg = axis_deg - *outer_deg.get_or_insert(axis_deg);
        let by = (off_deg / 90.0).round();
        if (off_deg - 90.0 * by).abs() > ASKEW_DEG {
            return None;
        }
        let by = (by as i32).rem_euclid(4) as usize;
        for ((curve, _), direction) in walk.edges().zip(directed) {
            sides[(direction + by) % 4].push(curve);
        }
    }
    let is_free = |curve: u32| {
        let curve = &partition.curves[curve as usize];
        curve.left == curve.right
    };
    for side in &mut sides {
        side.sort_unstable();
        side.dedup();
        side.retain(|&curve| !is_free(curve));
    }
    let mut all: Vec<u32> = sides.iter().flatten().copied().collect();
    all.sort_unstable();
    let each_once = all.windows(2).all(|pair| pair[0] != pair[1]);
    let is_there = sides.iter().all(|side| !side.is_empty());
    (each_once && is_there).then_some(Block { subdomain, sides })
}

/// The direction of each edge, counter-clockwise from that of the first.
fn directions(walk: &Walk, sum: i32) -> Option<Vec<usize>> {
    let quarters = quarter_turns(&walk.turns_deg(), sum)?;
    let mut direction = 0;
    let mut directions = vec![0];
    for quarter in &quarters[1..] {
        direction = (direction + i32::from(*quarter)).rem_euclid(4);
        directions.push(direction as usize);
    }
    Some(directions)
}

/// Where direction 0 points on average, degrees.
fn axis_deg(walk: &Walk, directions: &[usize]) -> f64 {
    let (mut x, mut y) = (0.0, 0.0);
    for ((_, [dx, dy]), direction) in walk.edges().zip(directions) {
        let [dx, dy] = match direction {
            0 => [dx, dy],
            1 => [dy, -dx],
            2 => [-dx, -dy],
            _ => [-dy, dx],
        };
        (x, y) = (x + dx, y + dy);
    }
    f64::atan2(y, x).to_degrees()
}
