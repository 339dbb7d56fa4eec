//! The line work as read and what became of it, as handed to the writer.

use crate::cleanup::changes::Change;
use crate::cleanup::changes::Dropped;
use crate::cleanup::changes::Tally;
use crate::domain::finding::Finding;
use crate::domain::line::Domain;

/// What is promised of lines of each kind, and of the mesh away from them.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Kind -> how far its lines may lie from the mesh edges that represent them, metres.
    pub tolerance_by_kind_m: Vec<f64>,
    /// Kind -> mesh edges along its lines that are shorter than this are findings, metres.
    pub min_edge_by_kind_m: Vec<f64>,
    /// The same away from lines.
    pub min_edge_m: f64,
}

/// All that `lines` holds. Borrowed: the pipeline has these anyway.
#[derive(Clone, Copy, Debug)]
pub struct LineWork<'a> {
    /// The lines and rings as read.
    pub domain: &'a Domain,
    /// What is promised of it.
    pub limits: &'a Limits,
    /// Stretches of lines that are not in the mesh.
    pub dropped: &'a [Dropped],
    /// Where the topology was changed.
    pub changes: &'a [Change],
    /// How often, and how far things moved.
    pub tally: &'a Tally,
    /// What is wrong with the input.
    pub findings: &'a [Finding],
}
