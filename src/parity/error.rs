//! Why there are no counts.

use crate::partition::subdomains::SubdomainId;
use std::fmt;

/// The programme has no solution.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// A group of neighbouring sub-domains whose total is odd whatever is chosen: all curves
    /// between them and the rest of the city have fixed counts.
    Infeasible {
        /// They, sorted.
        subdomains: Vec<SubdomainId>,
        /// The curves around them all, whose counts are fixed with an odd sum.
        fixed: Vec<u32>,
    },
    /// No count satisfies a curve's bounds.
    Bounds {
        /// The curve.
        curve: u32,
        /// Its least count, at least 1 expected.
        lower: u32,
        /// Its largest count, at least the least one expected.
        upper: u32,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Error::Infeasible { subdomains, fixed } => write!(
                f,
                "{} sub-domains (the first is {}) cannot all be even: the {} curves around them \
                 have fixed counts with an odd sum; free one of those curves",
                subdomains.len(),
                subdomains[0],
                fixed.len()
            ),
            Error::Bounds {
                curve,
                lower,
                upper,
            } => write!(
                f,
                "curve {curve} needs between {lower} and {upper} intervals, which no count is"
            ),
        }
    }
}

impl std::error::Error for Error {}
