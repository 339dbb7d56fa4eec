//! Why there may be no partition.

use crate::geometry::point::Xy;
use std::fmt;

/// The arrangement cannot be divided into sub-domains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Error {
    /// No face of the arrangement lies inside the domain.
    NoInside {
        /// A point of the line work, projected, metres.
        at_m: Xy,
    },
    /// The rim is not closed: a face lies inside by one of its edges and outside by another.
    TornRim {
        /// Where, projected, metres.
        at_m: Xy,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::NoInside { at_m: [x, y] } => write!(
                to,
                "nothing lies inside the domain; line work was expected near {x:.3} {y:.3}: \
                 does the boundary polygon enclose an area larger than the mesh size?"
            ),
            Error::TornRim { at_m: [x, y] } => write!(
                to,
                "the rim of the domain is not closed near {x:.3} {y:.3}: \
                 does the boundary polygon or a hole cross itself there?"
            ),
        }
    }
}

impl std::error::Error for Error {}
