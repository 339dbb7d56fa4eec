//! The multipliers to begin with: those of the programme without parity.
//!
//! Without parity the Lagrangian falls apart into curves: given its tilt, a curve takes the count that
//! is cheapest, and the excess of each rule is the slope of the dual function in its multiplier.
//! Counts are fractions with costs linear between whole ones, whose dual is that of the linear
//! programme; a spring to the goal, of a share `soft` of the cost's own curvature, makes it smooth.
//! Projected gradients with momentum then climb fast (Nesterov 1983; begun anew where the
//! momentum points down, O'Donoghue and Candes 2015), for softer and softer springs (Nesterov 2005).
//! A block's stride is the inverse of the largest curvature that its rules can meet, the sum over its
//! curves of `rules around the curve / stiffness of its spring`.
//!
//! Everything is local: a stride moves what one block knows by one block.

use crate::intervals::goals::Block;
use crate::intervals::goals::Goals;
use crate::parity::programme::COST_UNIT;
use crate::parity::tilts::Rules;

/// Springs one after the other, and strides with each.
const SOFT: [f64; 3] = [1.0, 0.3, 0.1];

/// See `SOFT`. Half as many double the gap that the climb begins with on meshes of 10M quads.
const STRIDES: u32 = 60;

/// Multipliers, one a rule of each block: not negative, at most `worth` together in each.
pub struct Start {
    /// The multipliers.
    pub multipliers: Vec<f64>,
    /// One a block: how far a multiplier may go for an excess of one.
    pub stride: Vec<f64>,
}

impl Start {
    /// Nearly the best multipliers without parity.
    pub fn of(goals: &Goals, rules: &Rules) -> Start {
        let mut curves: Vec<Spring> = (0..goals.goal.len())
            .map(|curve| Spring::of(goals, curve))
            .collect();
        for &curve in (goals.blocks.iter()).flat_map(|block| block.sides.iter().flatten()) {
            curves[curve as usize].is_on_block = true;
        }
        let mut start = Start {
            multipliers: vec![0.0; rules.start[goals.blocks.len()] as usize],
            stride: strides(goals, rules, &curves),
        };
        for soft in SOFT {
            start.climb(goals, rules, &mut curves, soft);
        }
        start
    }

    fn climb(&mut self, goals: &Goals, rules: &Rules, curves: &mut [Spring], soft: f64) {
        let at = &mut self.multipliers;
        let mut ahead = at.clone();
        let mut momentum = 1.0_f64;
        for _ in 0..STRIDES {
            settle(goals, rules, &ahead, soft, curves);
            let faster = 0.5 + (0.25 + momentum * momentum).sqrt();
            let carry = (momentum - 1.0) / faster;
            let mut uphill = 0.0;
            for (k, block) in goals.blocks.iter().enumerate() {
                let totals = block.totals(|curve| curves[curve].count);
                let rows = rules.rows(k);
                let (at, ahead) = (&mut at[rows.clone()], &mut ahead[rows]);
                let mut next = [0.0; 6];
                let next = &mut next[..at.len()];
                for (row, rule) in rules.with_sides(block.sides.len()).iter().enumerate() {
                    next[row] = ahead[row] + soft * self.stride[k] * rule.real_excess(&totals);
                }
                rules.project(k, next);
                for row in 0..next.len() {
                    let step = next[row] - at[row];
                    uphill += (next[row] - ahead[row]) * step / self.stride[k];
                    (at[row], ahead[row]) = (next[row], next[row] + carry * step);
                }
            }
            momentum = faster;
            if uphill < 0.0 {
                momentum = 1.0;
                ahead.clone_from(at);
            }
        }
    }
}

/// Gives each curve of a block its cheapest count with what `multipliers` make an interval cost more.
fn settle(goals: &Goals, rules: &Rules, multipliers: &[f64], soft: f64, curves: &mut [Spring]) {
    curves.iter_mut().for_each(|curve| curve.tilt = 0.0);
    for (k, block) in goals.blocks.iter().enumerate() {
        let mut tilt = [0.0; 6];
        let of_block = rules.with_sides(block.sides.len());
        for (rule, multiplier) in of_block.iter().zip(&multipliers[rules.rows(k)]) {
            for (tilt, &sign) in tilt.iter_mut().zip(&rule.sign) {
                *tilt += multiplier * f64::from(sign);
            }
        }
        for (side, tilt) in block.sides.iter().zip(tilt) {
            (side.iter()).for_each(|&curve| curves[curve as usize].tilt += tilt);
        }
    }
    for (id, curve) in (0..).zip(curves) {
        if curve.is_on_block {
            curve.settle(goals, id, soft);
        }
    }
}

/// A curve that gives way to its tilt.
#[derive(Clone)]
struct Spring {
    is_on_block: bool,
    tilt: f64,
    count: f64,
    goal: f64,
    /// Curvature of the cost above the goal, units.
    stiff: f64,
    /// A whole count near `count`, and what the intervals to it and beyond it cost, units: it changes
    /// rarely from stride to stride.
    near: u32,
    rise: [f64; 2],
}

impl Spring {
    fn of(goals: &Goals, curve: usize) -> Spring {
        let goal = goals.goal[curve].max(f64::from(goals.lower[curve]));
        let mut spring = Spring {
            is_on_block: false,
            tilt: 0.0,
            count: 0.0,
            goal,
            stiff: 2.0 * goals.weight[curve] / COST_UNIT / (goal * goal),
            near: 0,
            rise: [0.0; 2],
        };
        spring.look_about(goals, curve, goal as u32);
        spring
    }

    fn look_about(&mut self, goals: &Goals, curve: usize, near: u32) {
        let (lower, upper) = (goals.lower[curve], goals.upper[curve]);
        let near = near.clamp(lower, upper);
        let rise = |n: u32| (goals.cost(curve, n + 1) - goals.cost(curve, n)) / COST_UNIT;
        // Bounds are walls.
        let below = if near > lower {
            rise(near - 1)
        } else {
            f64::NEG_INFINITY
        };
        let above = if near < upper {
            rise(near)
        } else {
            f64::INFINITY
        };
        (self.near, self.rise) = (near, [below, above]);
    }

    /// The cheapest count, costs linear between whole counts, with a spring that is `soft`.
    fn settle(&mut self, goals: &Goals, curve: usize, soft: f64) {
        let spring = soft * self.stiff;
        let mut has_jumped = false;
        loop {
            let n = f64::from(self.near);
            let force = self.tilt + spring * (n - self.goal);
            let [below, above] = self.rise.map(|rise| (rise + force) / spring);
            if below <= 1.0 && above >= -1.0 {
                self.count = n - below.max(0.0) - above.min(0.0);
                return;
            }
            // The first guess is the cheapest smooth count; from there on step by step.
            let next = if !has_jumped {
                let smooth = goals.cheapest(curve, self.tilt * COST_UNIT);
                ((smooth + soft * self.goal) / (1.0 + soft)) as u32
            } else if above < -1.0 {
                self.near + 1
            } else {
                self.near - 1
            };
            has_jumped = true;
            self.look_about(goals, curve, next);
        }
    }
}

/// The longest safe stride of each block with springs of the costs' own curvature.
fn strides(goals: &Goals, rules: &Rules, curves: &[Spring]) -> Vec<f64> {
    let rules_on = |sides: usize, side: usize| {
        let signed = rules.with_sides(sides).iter();
        signed.filter(|rule| rule.sign[side] != 0).count() as f64
    };
    let mut give = vec![0.0; goals.goal.len()];
    for block in &goals.blocks {
        for (side, of_side) in block.sides.iter().enumerate() {
            for &curve in of_side {
                let by = rules_on(block.sides.len(), side) / curves[curve as usize].stiff;
                give[curve as usize] += by;
            }
        }
    }
    let of_block = |block: &Block| 1.0 / block.totals(|curve| give[curve]).iter().sum::<f64>();
    goals.blocks.iter().map(of_block).collect()
}
