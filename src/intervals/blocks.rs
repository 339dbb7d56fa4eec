//! The sub-domains that could be mapped if the counts of their sides fitted.

use crate::intervals::Options;
use crate::intervals::goals::Block;
use crate::intervals::goals::Goals;
use crate::intervals::goals::rules;
use crate::intervals::sides::Walk;
use crate::intervals::submaps;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::Partition;

/// A walk that turns left by more than this must have a corner of the pattern there, degrees; to
/// the right, no pattern fits. The limits are those that mapping goes by.
const MUST_TURN_DEG: f64 = 52.0;

/// A corner may be where the walk turns left by more than this, degrees.
const MAY_TURN_DEG: f64 = 22.0;

/// What a side more or less than four is worth in misfit, degrees^2: the irregular node in the
/// middle, priced as mapping does (a quarter of a squared radian).
const IRREGULAR_DEG2: f64 = 820.0;

/// Quads that a block may have, as a square of its circumference would. Larger ones are mostly regular
/// by any method: to fit them changes no quality figure of any case and costs as much as all others.
const QUADS_MAX: f64 = 256.0;

/// All sub-domains of three to six sides whose wishes nearly fit, and others that nearly close
/// ([`submaps`]), in the order of their ids.
pub fn blocks(
    goals: &Goals,
    arrangement: &Arrangement,
    partition: &Partition,
    options: &Options,
) -> Vec<Block> {
    (0..partition.subdomains.len() as u32)
        .filter_map(|id| {
            block(arrangement, partition, id)
                .filter(|block| is_promising(goals, block, options.block_ratio, QUADS_MAX))
                .or_else(|| submaps::block(goals, arrangement, partition, id))
        })
        .collect()
}

/// Small, and the wishes are off by at most an interval, or by the ratio: to fit others would spoil
/// the sizes of the neighbours for a patch that is stretched anyway.
pub fn is_promising(goals: &Goals, block: &Block, ratio: f64, quads_max: f64) -> bool {
    let wish = |curve: usize| goals.goal[curve].max(f64::from(goals.lower[curve]));
    let wishes = block.totals(wish);
    let sides = &wishes[..block.sides.len()];
    let least = sides.iter().copied().fold(f64::INFINITY, f64::min);
    if (sides.iter().sum::<f64>() / 4.0).powi(2) > quads_max {
        return false;
    }
    let enough = if sides.len() == 4 { 0.0 } else { 1.5 };
    rules(sides.len()).iter().all(|rule| {
        let signed = wishes.iter().zip(&rule.sign);
        let off: f64 = signed.map(|(wish, &sign)| wish * f64::from(sign)).sum();
        off <= f64::max(1.0, (ratio - 1.0) * least)
    }) && least >= enough
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
    let corners = corners(&walk)?;
    // A corner within a curve would leave to `boundary` how much of its count each side gets.
    if !corners.iter().all(|&k| walk.starts_curve[k]) {
        return None;
    }
    let sides = (walk.sides(&corners).into_iter())
        .map(|side| side.into_iter().map(|(curve, _)| curve).collect())
        .collect();
    Some(Block { subdomain, sides })
}

/// The three to six corners that fit best: the sharpest turns, all that must be among them.
fn corners(walk: &Walk) -> Option<Vec<usize>> {
    let mut corners = walk.entries(|turn_deg| turn_deg > MAY_TURN_DEG);
    corners.sort_by(|&j, &k| {
        walk.turn_deg(k)
            .total_cmp(&walk.turn_deg(j))
            .then(j.cmp(&k))
    });
    let must = (corners.iter())
        .filter(|&&k| walk.turn_deg(k) > MUST_TURN_DEG)
        .count();
    let mut best: Option<(f64, usize)> = None;
    let mut misfit = 0.0;
    for (k, &corner) in corners.iter().enumerate().take(6) {
        let (turn_deg, sides) = (walk.turn_deg(corner), k + 1);
        misfit += (90.0 - turn_deg).powi(2) - turn_deg.powi(2);
        let all = misfit + IRREGULAR_DEG2 * sides.abs_diff(4) as f64;
        if sides >= must.max(3) && best.is_none_or(|(least, _)| all < least) {
            best = Some((all, sides));
        }
    }
    corners.truncate(best?.1);
    corners.sort_unstable();
    Some(corners)
}
