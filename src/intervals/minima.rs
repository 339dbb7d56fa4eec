//! The least counts that shapes need, folded into lower bounds of curves.

use crate::intervals::Options;
use crate::intervals::goals::Goals;
use crate::intervals::sides::Side;
use crate::intervals::sides::Walk;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::Partition;
use crate::partition::subdomains::Subdomain;
use crate::rungs::LONG;
use crate::rungs::ONE_ROW;

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
            let walk = Walk::of(walk, arrangement, partition);
            let corners = walk.entries(|turn_deg| turn_deg.abs() > options.corner_deg);
            let sides = walk.sides(&corners);
            // One node on a side of a triangle or a lune would make an element with a straight
            // angle at a corner; four and more sides carry quads with one interval each.
            if sides.len() == 2 || sides.len() == 3 {
                for (k, side) in sides.iter().enumerate() {
                    if !is_end_of_a_tip(goals, &sides, k) {
                        raise_side(goals, partition, side, 2);
                    }
                }
            }
        }
        raise_total(goals, partition, subdomain);
    }
}

/// True for the side across the wide end of a long tip that has room for one row there: nearer to
/// the tip, the other two sides have room enough to make it two.
fn is_end_of_a_tip(goals: &Goals, sides: &[Side], side: usize) -> bool {
    let wish = |k: usize| -> f64 {
        let curves = sides[(side + k) % sides.len()].iter();
        curves.map(|&(curve, _)| goals.goal[curve as usize]).sum()
    };
    sides.len() == 3 && wish(0) <= ONE_ROW && wish(1).min(wish(2)) >= LONG
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
