//! Blocks whose opposite sides should have equal counts: how far counts are from it, and moves.
//!
//! A block costs `worth` times the larger difference of its two pairs of opposite sides. A move
//! changes a row of curves by the same amount: from a block across its opposite side into the next
//! one and so on, as a sheet of quads would, as long as that pays.

use crate::intervals::goals::Goals;
use crate::parity::Options;
use crate::parity::balance::Structure;
use crate::parity::error::Error;
use crate::parity::minimum_join;
use crate::parity::programme::COST_UNIT;
use crate::parity::programme::Programme;
use crate::parity::programme::cost_units;
use crate::parity::programme::total_units;
use crate::parity::programme::units;
use crate::partition::subdomains::Partition;

/// Longest row of curves that one move changes.
const ROW_MAX: usize = 60;

/// No block.
const NONE: u32 = u32::MAX;

/// The counts that are best with the wishes of blocks, as far as this finds them, starting from the
/// free rounding `near` and from the counts `even` that are best for parity alone.
///
/// Twice the halves of blocks become nodes of their own (`programme`), and a T-join chooses
/// parities: once about the free rounding, whose certificate bounds all counts, once about a
/// rounding that moves have made fit the blocks. Then moves of two, which leave parities alone.
pub fn prefer_equal_sides(
    partition: &Partition,
    goals: &Goals,
    near: &[u32],
    even: Vec<u32>,
    options: &Options,
) -> Result<(Structure, Vec<u32>), Error> {
    let worth = units(options.worth);
    let mut best = Draft::new(partition, goals, even, worth);
    let mut bound = 0;
    if worth > 0 && !goals.blocks.is_empty() {
        let mut wished = Draft::new(partition, goals, near.to_vec(), worth);
        wished.descend(1, options.rounds_max);
        let plain = total_units(goals, near);
        for about in [near, &wished.counts] {
            let programme = Programme::new(partition, goals, about, worth)?;
            let join = minimum_join(&programme.graph, options.events_max);
            if about == near {
                bound = plain + (join.cuts.bound2() + 1) / 2;
            }
            let counts = programme.counts(&join.chosen);
            let mut draft = Draft::new(partition, goals, counts, worth);
            draft.descend(2, options.rounds_max);
            if draft.total() < best.total() {
                best = draft;
            }
        }
    }
    let structure = Structure {
        blocks: goals.blocks.len() as u32,
        mapped: best.mapped(),
        price: best.price() as f64 * COST_UNIT,
        bound: bound as f64 * COST_UNIT,
    };
    Ok((structure, best.counts))
}

/// Counts in the making, with the differences of all blocks.
struct Draft<'a> {
    goals: &'a Goals,
    worth: i64,
    /// The blocks on both sides of each curve, with the side of the block that it lies on.
    places: Vec<[(u32, u8); 2]>,
    /// For each block, what its first two sides have more than those opposite.
    excess: Vec<[i64; 2]>,
    /// The counts.
    counts: Vec<u32>,
}

impl<'a> Draft<'a> {
    /// The state of `counts`.
    fn new(partition: &Partition, goals: &'a Goals, counts: Vec<u32>, worth: i64) -> Draft<'a> {
        let mut places = vec![[(NONE, 0); 2]; counts.len()];
        let mut excess = vec![[0; 2]; goals.blocks.len()];
        for (id, block) in goals.blocks.iter().enumerate() {
            for (side, &curve) in sides_of(&block.sides) {
                let left = partition.curves[curve as usize].left == block.subdomain;
                places[curve as usize][usize::from(!left)] = (id as u32, side as u8);
                let count = i64::from(counts[curve as usize]);
                excess[id][side % 2] += if side < 2 { count } else { -count };
            }
        }
        Draft {
            goals,
            worth,
            places,
            excess,
            counts,
        }
    }

    /// Price of all blocks that cannot be mapped, units.
    fn price(&self) -> i64 {
        self.excess
            .iter()
            .map(|excess| self.worth * larger(*excess))
            .sum()
    }

    /// What the counts cost, with the price of blocks, units.
    fn total(&self) -> i64 {
        total_units(self.goals, &self.counts) + self.price()
    }

    /// Number of blocks with equal opposite sides.
    fn mapped(&self) -> u32 {
        self.excess
            .iter()
            .filter(|excess| **excess == [0, 0])
            .count() as u32
    }

    /// Moves by `step` (1, or 2 to keep parities) until none pays, at most `rounds_max` rounds.
    fn descend(&mut self, step: i64, rounds_max: u32) {
        for _ in 0..rounds_max {
            let mut moved = false;
            for curve in 0..self.counts.len() as u32 {
                moved |= self.step_alone(curve, step);
            }
            for block in 0..self.excess.len() {
                for pair in 0..2 {
                    moved |= self.mend(block, pair, step);
                }
            }
            if !moved {
                return;
            }
        }
    }

    fn step_alone(&mut self, curve: u32, step: i64) -> bool {
        for by in [step, -step] {
            if self.gain(curve, by).is_some_and(|change| change < 0) {
                self.change(curve, by);
                return true;
            }
        }
        false
    }

    /// Tries rows from both sides of one pair of a block that differ.
    fn mend(&mut self, block: usize, pair: usize, step: i64) -> bool {
        let goals = self.goals;
        let mut moved = false;
        for side in [pair, pair + 2] {
            let excess = self.excess[block][pair];
            let by = match (excess > 0) == (side == pair) {
                true => -step,
                false => step,
            };
            for &curve in &goals.blocks[block].sides[side] {
                if self.excess[block][pair] != 0 {
                    moved |= self.try_row(curve, block as u32, by);
                }
            }
        }
        moved
    }

    /// Changes `curve` and the row behind it, seen from block `from`, as far as is best; puts all
    /// back if nothing is better than before.
    fn try_row(&mut self, curve: u32, from: u32, by: i64) -> bool {
        let (mut curve, mut from) = (curve, from);
        let mut row: Vec<u32> = Vec::new();
        let (mut total, mut best, mut best_len) = (0, 0, 0);
        while row.len() < ROW_MAX {
            let Some(change) = self.gain(curve, by) else {
                break;
            };
            self.change(curve, by);
            row.push(curve);
            total += change;
            if total < best {
                (best, best_len) = (total, row.len());
            }
            let Some((next, block)) = self.across(curve, from, by, &row) else {
                break;
            };
            (curve, from) = (next, block);
        }
        for &curve in &row[best_len..] {
            self.change(curve, -by);
        }
        best_len > 0
    }

    /// The best curve opposite `curve` in the block beyond it, which is the one that is not `from`.
    fn across(&self, curve: u32, from: u32, by: i64, row: &[u32]) -> Option<(u32, u32)> {
        let beyond = |place: &&(u32, u8)| place.0 != from && place.0 != NONE;
        let &(block, side) = self.places[curve as usize].iter().find(beyond)?;
        let opposite = &self.goals.blocks[block as usize].sides[(usize::from(side) + 2) % 4];
        (opposite.iter())
            .filter(|next| !row.contains(next))
            .filter_map(|&next| self.gain(next, by).map(|change| (change, next)))
            .min()
            .map(|(_, next)| (next, block))
    }

    /// What a change costs, all blocks considered; `None` if it leaves the bounds.
    fn gain(&self, curve: u32, by: i64) -> Option<i64> {
        let id = curve as usize;
        let old = self.counts[id];
        let new = u32::try_from(i64::from(old) + by).ok()?;
        if new < self.goals.lower[id] || new > self.goals.upper[id] {
            return None;
        }
        let mut change = cost_units(self.goals, id, new) - cost_units(self.goals, id, old);
        for &(block, side) in self.places[id].iter().filter(|place| place.0 != NONE) {
            let before = self.excess[block as usize];
            let after = shifted(before, side, by);
            change += self.worth * (larger(after) - larger(before));
        }
        Some(change)
    }

    fn change(&mut self, curve: u32, by: i64) {
        let id = curve as usize;
        self.counts[id] = (i64::from(self.counts[id]) + by) as u32;
        for (block, side) in self.places[id].into_iter().filter(|place| place.0 != NONE) {
            let excess = &mut self.excess[block as usize];
            *excess = shifted(*excess, side, by);
        }
    }
}

fn sides_of(sides: &[Vec<u32>; 4]) -> impl Iterator<Item = (usize, &u32)> {
    (sides.iter().enumerate()).flat_map(|(side, curves)| curves.iter().map(move |it| (side, it)))
}

fn shifted(excess: [i64; 2], side: u8, by: i64) -> [i64; 2] {
    let mut excess = excess;
    excess[usize::from(side % 2)] += if side < 2 { by } else { -by };
    excess
}

fn larger(excess: [i64; 2]) -> i64 {
    excess[0].abs().max(excess[1].abs())
}
