//! Goals: what the sizes wish of each curve, before parity.

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
    /// Weight of the curve's deviation; 1 for a straight curve that is not shorter than the size.
    pub weight: Vec<f64>,
    /// Sub-domains with four sides, by id: they can be mapped if opposite sides have equal counts.
    pub blocks: Vec<Block>,
}

/// A sub-domain with one walk, four corners and no reflex one.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// The sub-domain.
    pub subdomain: SubdomainId,
    /// The curves of each side, in order around; each lies on it as a whole. None occurs twice.
    pub sides: [Vec<u32>; 4],
}

impl Goals {
    /// What count `n` costs on `curve`: weight x (max(n / g, g / n)^2 - 1), with g the goal but at
    /// least the lower bound. Convex in n, zero at n = g, and symmetric in ratio: half as many is
    /// as bad as twice as many.
    pub fn cost(&self, curve: usize, n: u32) -> f64 {
        self.weight[curve] * self.deviation(curve, n)
    }

    /// The cost without its weight.
    pub fn deviation(&self, curve: usize, n: u32) -> f64 {
        let goal = self.goal[curve].max(f64::from(self.lower[curve]));
        let n = f64::from(n);
        (n / goal).max(goal / n).powi(2) - 1.0
    }
}
