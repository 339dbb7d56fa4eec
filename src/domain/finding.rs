//! Dirt as data: what is wrong with the input or could not be had, with its place.

use crate::geometry::point::Xy;

/// One thing that a user should know. A finding never stops a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// A short stable word to sort and count by, for example `zero-length-line`.
    pub what: &'static str,
    /// A full sentence: what was found and what was done about it.
    pub text: String,
    /// Index of the input feature, if one is concerned.
    pub feature: Option<u32>,
    /// Projected coordinates, metres, if there is a place.
    pub at_m: Option<Xy>,
}
