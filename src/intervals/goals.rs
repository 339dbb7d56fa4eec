//! Goals: what the sizes wish of each curve, before parity.

use crate::intervals::WEIGHT_MAX;
use crate::partition::subdomains::SubdomainId;

/// One entry a curve. The count n of a curve must satisfy `lower <= n <= upper`; what it costs is
/// `cost(curve, n)`, convex in n.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Goals {
    /// Wished (real) number of intervals, the integral of ds / h.
    pub goal: Vec<f64>,
    /// Least count: one an edge of the chain, more where the shape asks for it.
    pub lower: Vec<u32>,
    /// Largest count that sizes allow; equal to `lower` for a fixed count.
    pub upper: Vec<u32>,
    /// Weight of the curve's deviation; 1 for a straight curve that is not shorter than the size, between
    /// sub-domains that are not narrow.
    pub weight: Vec<f64>,
    /// Sub-domains that can be mapped if their counts fit, by id.
    pub blocks: Vec<Block>,
}

/// A sub-domain with one walk, three to six corners and no reflex one; or one of any shape whose walks
/// should close on a lattice: its four sides are then the directions there.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// The sub-domain.
    pub subdomain: SubdomainId,
    /// The curves of each side, in order around, or of each direction, in order of number; each lies on it
    /// as a whole. None occurs twice, free lines do not occur.
    pub sides: Vec<Vec<u32>>,
}

impl Block {
    /// What each side has of `amount`, a number a curve; absent sides have zero.
    pub fn totals(&self, amount: impl Fn(usize) -> f64) -> [f64; 6] {
        let mut totals = [0.0; 6];
        for (total, side) in totals.iter_mut().zip(&self.sides) {
            *total = side.iter().map(|&curve| amount(curve as usize)).sum();
        }
        totals
    }
}

/// One inequality of a pattern: `constant + sum over sides s of sign[s] x count of s <= 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// See [`Rule`].
    pub constant: i8,
    /// -1, 0 or 1 a side.
    pub sign: [i8; 6],
}

impl Rule {
    /// How far `totals` are from what the rule asks for: at most 0 if they satisfy it.
    pub fn excess(&self, totals: &[i64; 6]) -> i64 {
        let sides = totals.iter().zip(&self.sign);
        i64::from(self.constant) + sides.map(|(n, &sign)| n * i64::from(sign)).sum::<i64>()
    }

    /// The same of real totals.
    pub fn real_excess(&self, totals: &[f64; 6]) -> f64 {
        let sides = totals.iter().zip(&self.sign);
        f64::from(self.constant) + sides.map(|(n, &sign)| n * f64::from(sign)).sum::<f64>()
    }
}

/// What the counts of a block with this many sides must satisfy so that one pattern fits, besides
/// an even total. Four sides: opposite ones are equal (a grid). Otherwise a star of spokes from a
/// centre to the sides, `count[i] = spoke[i-1] + spoke[i+1]`, with each spoke at least 1; twice a
/// spoke is the alternating sum of the counts met in steps of two from it.
pub fn rules(sides: usize) -> Vec<Rule> {
    let mut rules = Vec::new();
    if sides == 4 {
        for side in 0..4 {
            let mut sign = [0; 6];
            (sign[side], sign[(side + 2) % 4]) = (1, -1);
            rules.push(Rule { constant: 0, sign });
        }
        return rules;
    }
    let terms = if sides == 5 { 5 } else { 3 };
    for spoke in 0..sides {
        let mut sign = [0; 6];
        for k in 0..terms {
            sign[(spoke + 2 * k + 1) % sides] = if k % 2 == 0 { -1 } else { 1 };
        }
        rules.push(Rule { constant: 2, sign });
    }
    rules
}

/// True if sides 0, 2, 4 must have an even total by themselves, and so the others.
pub fn has_halves(sides: usize) -> bool {
    sides == 4 || sides == 6
}

/// Blocks with a side shorter than this, in sizes, are narrow: with counts that do not match, their quads are small
/// both ways. (Measured on twelve cities: the 1 % quantile of shapes grows by .001; up to .7 costs the
/// synthetic cities .05 points of irregular nodes.)
const SHORT_SIDE: f64 = 0.5;

impl Goals {
    /// What count `n` costs on `curve`: weight x (max(n / g, g / n)^2 - 1), with g the goal but at
    /// least the lower bound. Convex in n, zero at n = g, and symmetric in ratio: half as many is
    /// as bad as twice as many.
    pub fn cost(&self, curve: usize, n: u32) -> f64 {
        self.weight[curve] * self.deviation(curve, n)
    }

    /// The real count that is cheapest if each interval costs `tilt` more, within the bounds.
    pub fn cheapest(&self, curve: usize, tilt: f64) -> f64 {
        let (lower, upper) = (self.lower[curve].into(), self.upper[curve].into());
        let goal = self.goal[curve].max(lower);
        // The slope of the cost jumps from minus to plus this at the goal.
        let jump = 2.0 * self.weight[curve] / goal;
        let free = if tilt < -jump {
            -tilt / jump * goal
        } else if tilt > jump {
            (jump / tilt).cbrt() * goal
        } else {
            goal
        };
        free.clamp(lower, upper)
    }

    /// How much dearer a misfit of this block is than one between full-size edges: where one interval
    /// more makes a tiny edge, a turn of it through the block makes tiny quads. The square root of the
    /// geometric mean of its curves' weights, and more if a side is wished below [`SHORT_SIDE`]; at most
    /// [`WEIGHT_MAX`]. (Measured on eight cities, beside no weight: the 1 % quantile of shapes grows by up to
    /// .005, irregular nodes fall by up to .5 points, tiny cells stay as they are. The mean itself does twice
    /// that, but makes up to 2 % more quads, and tinier ones.)
    pub fn block_weight(&self, block: &Block) -> f64 {
        let curves = || block.sides.iter().flatten();
        let logs = curves().map(|&curve| self.weight[curve as usize].ln());
        let mean = (0.5 * logs.sum::<f64>() / curves().count().max(1) as f64).exp();
        let wishes = block.totals(|curve| self.goal[curve]);
        let sides = wishes[..block.sides.len()].iter().copied();
        let shortness = SHORT_SIDE / sides.fold(SHORT_SIDE, f64::min);
        (mean * shortness.powf(1.5)).min(WEIGHT_MAX)
    }

    /// The cost without its weight.
    pub fn deviation(&self, curve: usize, n: u32) -> f64 {
        let goal = self.goal[curve].max(f64::from(self.lower[curve]));
        let n = f64::from(n);
        (n / goal).max(goal / n).powi(2) - 1.0
    }
}
