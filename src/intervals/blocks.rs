//! The sub-domains that could be mapped if opposite sides had equal counts.

use crate::intervals::Options;
use crate::intervals::goals::Block;
use crate::intervals::goals::Goals;
use crate::intervals::sides::Walk;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::Partition;

/// A walk that turns left by more than this must have a corner of the pattern there, degrees; to
/// the right, no pattern fits. The limits are those that mapping goes by.
const MUST_TURN_DEG: f64 = 52.0;

/// A corner may be where the walk turns left by more than this, degrees.
const MAY_TURN_DEG: f64 = 22.0;

/// All four-sided sub-domains whose opposite sides wish similar counts, in the order of their ids.
pub fn blocks(
    goals: &Goals,
    arrangement: &Arrangement,
    partition: &Partition,
    options: &Options,
) -> Vec<Block> {
    (0..partition.subdomains.len() as u32)
        .filter_map(|id| block(arrangement, partition, id))
        .filter(|block| is_promising(goals, block, options.block_ratio))
        .collect()
}

/// Opposite wishes differ by at most an interval or by the ratio: to equal others would spoil the
/// sizes of the neighbours for a patch that is stretched anyway.
fn is_promising(goals: &Goals, block: &Block, ratio: f64) -> bool {
    let wish = |side: &Vec<u32>| -> f64 {
        let curves = side.iter().map(|&curve| curve as usize);
        curves
            .map(|curve| goals.goal[curve].max(f64::from(goals.lower[curve])))
            .sum()
    };
    let wishes = block.sides.each_ref().map(wish);
    (0..2).all(|pair| {
        let (one, other) = (wishes[pair], wishes[pair + 2]);
        (one - other).abs() <= 1.0 || one.max(other) <= ratio * one.min(other)
    })
}

fn block(arrangement: &Arrangement, partition: &Partition, subdomain: u32) -> Option<Block> {
    let [walk] = (partition.subdomains[subdomain as usize].walks).as_slice() else {
        return None;
    };
    let mut curves: Vec<u32> = walk.iter().map(|half| half >> 1).collect();
    curves.sort_unstable();
    // A free line is walked twice, and no grid fits around it.
    if curves.windows(2).any(|pair| pair[0] == pair[1]) {
        return None;
    }
    let walk = Walk::of(walk, arrangement, partition);
    if !walk
        .entries(|turn_deg| turn_deg < -MUST_TURN_DEG)
        .is_empty()
    {
        return None;
    }
    let mut corners = walk.entries(|turn_deg| turn_deg > MAY_TURN_DEG);
    corners.sort_by(|&j, &k| {
        walk.turn_deg(k)
            .total_cmp(&walk.turn_deg(j))
            .then(j.cmp(&k))
    });
    let fifth_must = (corners.get(4)).is_some_and(|&k| walk.turn_deg(k) > MUST_TURN_DEG);
    if corners.len() < 4 || fifth_must {
        return None;
    }
    corners.truncate(4);
    corners.sort_unstable();
    // A corner within a curve would leave to `boundary` how much of its count each side gets.
    if !corners.iter().all(|&k| walk.starts_curve[k]) {
        return None;
    }
    let mut sides = (walk.sides(&corners).into_iter())
        .map(|side| side.into_iter().map(|(curve, _)| curve).collect());
    Some(Block {
        subdomain,
        sides: std::array::from_fn(|_| sides.next().expect("four corners, four sides")),
    })
}
