//! The counts, what they cost, and the proof that it could not be less.

use crate::parity::cuts::Cuts;

/// A count for each curve, with its certificate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Balance {
    /// Number of intervals of each curve.
    pub counts: Vec<u32>,
    /// What free rounding costs, parity ignored: nobody can do better.
    pub base: f64,
    /// What `counts` cost.
    pub objective: f64,
    /// What any counts with all sub-domains even cost at least; proven by `cuts`.
    pub bound: f64,
    /// True if `objective` is `bound`: exact in whole cost units.
    pub proven: bool,
    /// Share of odd counts: about a half, unless something rounds to even.
    pub odd_share: f64,
    /// Sub-domains that free rounding leaves odd.
    pub odd_subdomains: u32,
    /// Rows and columns of the programme that HiGHS solved; 0 if it was not asked or gave up.
    pub rows: u32,
    /// See `rows`.
    pub columns: u32,
    /// The optimum that HiGHS claims for it, with `base`; beside `bound`, not part of the proof.
    pub claimed: Option<f64>,
    /// True if HiGHS had to branch (its linear programme had several optima).
    pub branched: bool,
    /// Work done by the matching, queue entries.
    pub events: u64,
    /// The certificate: odd sets of sub-domains and their dual values, half cost units.
    pub cuts: Cuts,
}

impl Balance {
    /// (objective - bound) / objective with the cost of free rounding subtracted from both; 0 if
    /// parity costs nothing.
    pub fn gap(&self) -> f64 {
        if self.proven {
            return 0.0;
        }
        (self.objective - self.bound) / (self.objective - self.base)
    }
}
