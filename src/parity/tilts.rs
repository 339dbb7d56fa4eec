//! Multipliers of the patterns' rules, and the tilted costs that they make.
//!
//! A block pays `worth` times the largest excess of its rules, `worth` at least if its halves are
//! odd, else nothing. For any multipliers u >= 0 with a sum of at most `worth` that is at least
//!
//! ```text
//! sum over rules r of u_r excess_r(n)  +  (worth - sum of u_r) [halves odd]
//! ```
//!
//! The first part is linear in the counts: it tilts the cost of each curve, which stays convex. The
//! second is the price of a bridge. What is left is a T-join, solved exactly: a lower bound on cost
//! and price together for *any* such multipliers, the best of which the ascent looks for.

use crate::intervals::goals::Goals;
use crate::intervals::goals::Rule;
use crate::intervals::goals::rules;

/// The rules of all blocks in a row.
pub struct Rules {
    /// `by_sides[k]` are those of a block with `k` sides.
    by_sides: [Vec<Rule>; 7],
    /// Row of the first rule of each block, and the number of all rows.
    pub start: Vec<u32>,
    /// What an excess of one costs in each block, units.
    pub worth: Vec<i64>,
}

impl Rules {
    /// The rules of the blocks of `goals`; `worth` is the price in a block of full-size edges, units.
    pub fn of(goals: &Goals, worth: i64) -> Rules {
        let mut start = vec![0];
        for block in &goals.blocks {
            // A block has as many rules as sides.
            start.push(start[start.len() - 1] + block.sides.len() as u32);
        }
        let worth = (goals.blocks.iter())
            .map(|block| (worth as f64 * goals.block_weight(block)).round() as i64)
            .collect();
        let by_sides = std::array::from_fn(|sides| match sides {
            0..3 => Vec::new(),
            _ => rules(sides),
        });
        Rules {
            by_sides,
            start,
            worth,
        }
    }

    /// The rules of a block with this many sides.
    pub fn with_sides(&self, sides: usize) -> &[Rule] {
        &self.by_sides[sides]
    }

    /// The rows of `block`.
    pub fn rows(&self, block: usize) -> std::ops::Range<usize> {
        self.start[block] as usize..self.start[block + 1] as usize
    }

    /// Moves the multipliers of `block` to the nearest ones that prove something: none below 0, at
    /// most its worth together.
    pub fn project(&self, block: usize, of_block: &mut [f64]) {
        let worth = self.worth[block] as f64;
        of_block.iter_mut().for_each(|u| *u = u.max(0.0));
        if of_block.iter().sum::<f64>() > worth {
            let by = surplus(of_block, worth);
            of_block.iter_mut().for_each(|u| *u = (*u - by).max(0.0));
        }
    }
}

/// What must be taken from each of at most six `values`, none going below 0, so that `most` in all
/// are left.
fn surplus(values: &[f64], most: f64) -> f64 {
    let mut down = [0.0; 6];
    let down = &mut down[..values.len()];
    down.copy_from_slice(values);
    down.sort_by(|a, b| b.total_cmp(a));
    let (mut sum, mut by) = (0.0, 0.0);
    for (k, value) in down.iter().enumerate() {
        sum += value;
        let with = (sum - most) / (k + 1) as f64;
        if with >= *value {
            break;
        }
        by = with;
    }
    by
}

/// What multipliers do to the programme, whole units.
pub struct Tilts {
    /// What an interval more on each curve costs beyond `Goals::cost`.
    pub slope: Vec<i64>,
    /// Price of the bridge of each block; negative if the multipliers prove nothing.
    pub bridge: Vec<i64>,
    /// What the rules' constants add.
    pub constant: i64,
}

impl Tilts {
    /// The tilts of `multipliers`, one a rule of each block in order.
    pub fn of(goals: &Goals, rules: &Rules, multipliers: &[i64]) -> Tilts {
        let mut tilts = Tilts {
            slope: vec![0; goals.goal.len()],
            bridge: Vec::with_capacity(goals.blocks.len()),
            constant: 0,
        };
        for (k, block) in goals.blocks.iter().enumerate() {
            let mut bridge = rules.worth[k];
            let mut slope = [0; 6];
            let of_block = rules.with_sides(block.sides.len());
            for (rule, &multiplier) in of_block.iter().zip(&multipliers[rules.rows(k)]) {
                bridge -= multiplier;
                tilts.constant += multiplier * i64::from(rule.constant);
                for (slope, &sign) in slope.iter_mut().zip(&rule.sign) {
                    *slope += multiplier * i64::from(sign);
                }
            }
            for (side, slope) in block.sides.iter().zip(slope) {
                for &curve in side {
                    tilts.slope[curve as usize] += slope;
                }
            }
            tilts.bridge.push(bridge);
        }
        tilts
    }
}
