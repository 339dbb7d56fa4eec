//! The counts, what they cost, and the proof that it could not be less.

use crate::intervals::goals::Goals;
use crate::parity::cuts::Cuts;
use crate::parity::draft::Draft;
use crate::parity::draft::Places;
use crate::parity::programme::COST_UNIT;
use crate::parity::programme::total_units;
use crate::parity::programme::units;
use crate::parity::tilts::Rules;
use crate::partition::subdomains::Partition;

/// A count for each curve, with its certificate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Balance {
    /// Number of intervals of each curve.
    pub counts: Vec<u32>,
    /// What free rounding costs, parity ignored: nobody can do better.
    pub base: f64,
    /// What `counts` cost: the optimum, and what patterns that fit cost beyond it.
    pub objective: f64,
    /// What the best counts found cost, the wishes of blocks ignored.
    pub optimum: f64,
    /// What any counts with all sub-domains even cost at least; proven by `cuts`.
    pub bound: f64,
    /// True if `optimum` is `bound`: exact in whole cost units.
    pub proven: bool,
    /// What was done for the sake of patterns.
    pub structure: Structure,
    /// Share of odd counts: about a half, unless something rounds to even.
    pub odd_share: f64,
    /// Sub-domains that free rounding leaves odd.
    pub odd_subdomains: u32,
    /// What HiGHS says of the programme of parity alone.
    pub solved: Solved,
    /// Work done by the matching, queue entries.
    pub events: u64,
    /// The certificate: odd sets of sub-domains and their dual values, half cost units.
    pub cuts: Cuts,
}

/// What HiGHS says of one programme; it comes beside the proof, and is no part of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Solved {
    /// Parts that share no sub-domain, curve or row, small ones counted together.
    pub parts: u32,
    /// Parts left at the matching's choice, which is as good: beyond the limits of work.
    pub left: u32,
    /// Rows of the parts that were solved, those added apart.
    pub rows: u32,
    /// Columns of them.
    pub columns: u32,
    /// Rows that its own solutions called for.
    pub added: u32,
    /// Parts that had to be branched on.
    pub branched: u32,
    /// The optimum that it claims, with all that is decided outside; `None` if a part was left.
    pub claimed: Option<f64>,
}

impl Solved {
    /// What it claims, for a sentence after the bound: in whole units, or nothing.
    pub fn beside_bound(&self, unit: f64) -> String {
        match self.claimed {
            Some(claimed) => format!(" (HiGHS: {:.0})", claimed / unit),
            None => String::new(),
        }
    }
}

/// What was done so that the counts of blocks fit patterns, with a bound of its own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Structure {
    /// Blocks: sub-domains that a pattern could mesh.
    pub blocks: u32,
    /// How many of them could be mapped with the best counts for parity alone.
    pub mapped_before: u32,
    /// How many of them can be mapped.
    pub mapped: u32,
    /// Price of a pattern's excess of one between full-size edges.
    pub worth: f64,
    /// Price of all excess that is left.
    pub price: f64,
    /// What any even counts cost at least, with that price; 0 if nothing was wished for.
    pub bound: f64,
    /// T-joins that the bound took.
    pub rounds: u32,
    /// What HiGHS says of the programme that the best multipliers tilt.
    pub solved: Solved,
    /// Neighbourhoods that HiGHS found better counts for.
    pub improved: u32,
    /// The proof, first part: a multiplier for each rule of each block, cost units.
    pub multipliers: Vec<i64>,
    /// The proof, second part: odd sets of the programme that the multipliers tilt.
    pub cuts: Cuts,
}

impl Structure {
    /// Counts again what other counts do to the patterns.
    pub(crate) fn appraise(&mut self, partition: &Partition, goals: &Goals, counts: &[u32]) {
        let worth = units(self.worth);
        let (rules, places) = (Rules::of(goals, worth), Places::of(partition, goals));
        let draft = Draft::new(goals, &rules, &places, counts.to_vec());
        self.mapped = draft.mapped();
        self.price = draft.price() as f64 * COST_UNIT;
    }
}

impl Balance {
    /// (optimum - bound) / optimum with the cost of free rounding subtracted from both; 0 if
    /// parity costs nothing.
    pub fn gap(&self) -> f64 {
        if self.proven {
            return 0.0;
        }
        (self.optimum - self.bound) / (self.optimum - self.base)
    }

    /// How far cost and price together are from their bound, in the same way.
    pub fn structure_gap(&self) -> f64 {
        let total = self.objective + self.structure.price;
        if self.structure.bound == 0.0 || units(total) <= units(self.structure.bound) {
            return 0.0;
        }
        (total - self.structure.bound) / (total - self.base)
    }

    /// The balance with these counts, and what they cost.
    pub(crate) fn with_counts(mut self, goals: &Goals, counts: Vec<u32>) -> Balance {
        self.counts = counts;
        self.objective = total_units(goals, &self.counts) as f64 * COST_UNIT;
        // Only if the matching ran into its limit can they be better than what it found.
        self.optimum = self.optimum.min(self.objective);
        self.proven = units(self.optimum) == units(self.bound);
        let odd = self.counts.iter().filter(|count| *count % 2 == 1).count();
        self.odd_share = odd as f64 / self.counts.len().max(1) as f64;
        self
    }
}
