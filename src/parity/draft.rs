//! Counts in the making, with what the blocks' patterns lack, and moves that make both cheaper.
//!
//! A move changes a row of curves by the same amount: from a block across its opposite side into
//! the next one and so on, as a sheet of quads would, as long as that pays.

use crate::intervals::goals::Goals;
use crate::intervals::goals::has_halves;
use crate::parity::programme::cost_units;
use crate::parity::programme::total_units;
use crate::parity::tilts::Rules;
use crate::partition::subdomains::Partition;

/// Longest row of curves that one move changes.
const ROW_MAX: usize = 60;

/// No block.
const NONE: u32 = u32::MAX;

/// The blocks on both sides of each curve, with the side of the block that it lies on.
pub struct Places(Vec<[(u32, u8); 2]>);

impl Places {
    /// Where the curves of `goals` lie.
    pub fn of(partition: &Partition, goals: &Goals) -> Places {
        let mut places = vec![[(NONE, 0); 2]; goals.goal.len()];
        for (id, block) in goals.blocks.iter().enumerate() {
            for (side, curves) in block.sides.iter().enumerate() {
                for &curve in curves {
                    let left = partition.curves[curve as usize].left == block.subdomain;
                    places[curve as usize][usize::from(!left)] = (id as u32, side as u8);
                }
            }
        }
        Places(places)
    }

    /// The blocks beside `curve`, each with its side.
    pub fn beside(&self, curve: u32) -> impl Iterator<Item = (u32, u8)> {
        let places = self.0[curve as usize];
        places.into_iter().filter(|place| place.0 != NONE)
    }
}

/// Counts, and the total of each side of each block.
#[derive(Clone)]
pub struct Draft<'a> {
    goals: &'a Goals,
    rules: &'a Rules,
    places: &'a Places,
    totals: Vec<[i64; 6]>,
    /// What a move must gain for each curve that it changes; 0 unless counts should stay.
    pub hurdle: i64,
    /// The counts.
    pub counts: Vec<u32>,
}

impl<'a> Draft<'a> {
    /// The state of `counts`.
    pub fn new(
        goals: &'a Goals,
        rules: &'a Rules,
        places: &'a Places,
        counts: Vec<u32>,
    ) -> Draft<'a> {
        let of_side = |side: &Vec<u32>| -> i64 {
            let counts = side.iter().map(|&curve| counts[curve as usize]);
            counts.map(i64::from).sum()
        };
        let totals = (goals.blocks.iter())
            .map(|block| std::array::from_fn(|side| block.sides.get(side).map_or(0, of_side)))
            .collect();
        Draft {
            goals,
            rules,
            places,
            totals,
            hurdle: 0,
            counts,
        }
    }

    /// The state of other counts.
    pub fn with_counts(&self, counts: Vec<u32>) -> Draft<'a> {
        Draft::new(self.goals, self.rules, self.places, counts)
    }

    /// What the counts of each side of `block` are in all.
    pub fn totals(&self, block: usize) -> &[i64; 6] {
        &self.totals[block]
    }

    /// Largest excess of the rules of `block`; 0 if it can be mapped.
    pub fn excess(&self, block: usize) -> i64 {
        self.excess_with(block, &self.totals[block])
    }

    fn excess_with(&self, block: usize, totals: &[i64; 6]) -> i64 {
        let sides = self.goals.blocks[block].sides.len();
        let rules = self.rules.with_sides(sides).iter();
        let most = rules.map(|rule| rule.excess(totals)).fold(0, i64::max);
        most.max(i64::from(halves_are_odd(sides, totals)))
    }

    /// Price of all blocks that cannot be mapped, units.
    pub fn price(&self) -> i64 {
        let blocks = 0..self.totals.len();
        blocks
            .map(|block| self.rules.worth[block] * self.excess(block))
            .sum()
    }

    /// What the counts cost, with the price of blocks, units.
    pub fn total(&self) -> i64 {
        total_units(self.goals, &self.counts) + self.price()
    }

    /// Number of blocks that can be mapped.
    pub fn mapped(&self) -> u32 {
        let blocks = 0..self.totals.len();
        blocks.filter(|&block| self.excess(block) == 0).count() as u32
    }

    /// Moves by two, which keeps parities, until none pays, at most `rounds_max` rounds.
    pub fn descend(&mut self, rounds_max: u32) {
        for _ in 0..rounds_max {
            let mut moved = false;
            for curve in 0..self.counts.len() as u32 {
                if self.places.beside(curve).next().is_some() {
                    moved |= [2, -2].iter().any(|&by| self.try_row(curve, NONE, by));
                }
            }
            for block in 0..self.totals.len() {
                if self.excess(block) > 0 {
                    moved |= self.mend(block);
                }
            }
            if !moved {
                return;
            }
        }
    }

    /// Tries rows that start at the curves of `block` and lead away from it.
    fn mend(&mut self, block: usize) -> bool {
        let goals = self.goals;
        let mut moved = false;
        for &curve in goals.blocks[block].sides.iter().flatten() {
            for by in [2, -2] {
                if self.excess(block) > 0 {
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
            total += change + self.hurdle;
            if total < best {
                (best, best_len) = (total, row.len());
            }
            let Some(end) = self.places.beside(curve).find(|place| place.0 != from) else {
                break;
            };
            // The block at its end cannot win back more than what the change takes off its excess.
            if total - best > by.abs() * self.rules.worth[end.0 as usize] {
                break;
            }
            let Some(next) = self.across(end, by, &row) else {
                break;
            };
            (curve, from) = (next, end.0);
        }
        for &curve in &row[best_len..] {
            self.change(curve, -by);
        }
        best_len > 0
    }

    /// The best curve opposite a side of a block.
    fn across(&self, (block, side): (u32, u8), by: i64, row: &[u32]) -> Option<u32> {
        let sides = &self.goals.blocks[block as usize].sides;
        // In a star, what enters by a side leaves by one of the sides that are not next to it.
        let next = |side: &usize| match sides.len() {
            4 => vec![(side + 2) % 4],
            3 => vec![(side + 1) % 3, (side + 2) % 3],
            k => vec![(side + 2) % k, (side + k - 2) % k],
        };
        (next(&usize::from(side)).into_iter())
            .flat_map(|side| &sides[side])
            .filter(|next| !row.contains(next))
            .filter_map(|&next| self.gain(next, by).map(|change| (change, next)))
            .min()
            .map(|(_, next)| next)
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
        for (block, side) in self.places.beside(curve) {
            let mut after = self.totals[block as usize];
            after[usize::from(side)] += by;
            let block = block as usize;
            change +=
                self.rules.worth[block] * (self.excess_with(block, &after) - self.excess(block));
        }
        Some(change)
    }

    fn change(&mut self, curve: u32, by: i64) {
        let id = curve as usize;
        self.counts[id] = (i64::from(self.counts[id]) + by) as u32;
        for (block, side) in self.places.beside(curve) {
            self.totals[block as usize][usize::from(side)] += by;
        }
    }

    /// Sets the counts of `curves` if they are within bounds and that is cheaper by more than `by`;
    /// true if it did.
    pub fn set_if_cheaper(&mut self, curves: &[u32], counts: &[u32], by: i64) -> bool {
        let before: Vec<u32> = curves
            .iter()
            .map(|&curve| self.counts[curve as usize])
            .collect();
        let mut change = 0;
        let mut possible = true;
        for (&curve, &count) in curves.iter().zip(counts) {
            let by = i64::from(count) - i64::from(self.counts[curve as usize]);
            match self.gain(curve, by) {
                Some(gain) => change += gain,
                None => possible = false,
            }
            self.change(curve, by);
        }
        if possible && change < -by {
            return true;
        }
        for (&curve, &count) in curves.iter().zip(&before) {
            let by = i64::from(count) - i64::from(self.counts[curve as usize]);
            self.change(curve, by);
        }
        false
    }
}

/// True if sides 0, 2, 4 have an odd total although they should be even by themselves.
pub fn halves_are_odd(sides: usize, totals: &[i64; 6]) -> bool {
    has_halves(sides) && (totals[0] + totals[2] + totals[4]) % 2 == 1
}
