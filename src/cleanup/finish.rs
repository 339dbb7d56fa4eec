//! Measures the graph against the input, and makes the arrangement of it: two halves that need
//! nothing of each other.

use crate::cleanup::Cleaned;
use crate::cleanup::SHARP_DEG;
use crate::cleanup::audit;
use crate::cleanup::changes::Dropped;
use crate::cleanup::changes::Reason;
use crate::cleanup::changes::Tally;
use crate::cleanup::graph::Graph;
use crate::cleanup::leftovers;
use crate::cleanup::sharp;
use crate::cleanup::thread;
use crate::domain::finding::Finding;
use crate::noding::arrangement::Arrangement;

/// The line work after all steps, still as a graph.
pub struct Joined<'a> {
    pub(super) graph: Graph<'a>,
    /// What came into clean-up.
    pub(super) input: &'a Arrangement,
    /// False if clean-up was to change nothing.
    pub(super) is_on: bool,
}

/// How far lines moved, and what is left.
pub struct Measured {
    /// Displacements and rows; the lengths are the other half's.
    tally: Tally,
    sharp_before: u64,
    findings: Vec<Finding>,
}

/// The arrangement, and what is not in it.
pub struct Threaded {
    arrangement: Arrangement,
    dropped: Vec<Dropped>,
    length_m: f64,
    length_dropped_m: f64,
    sharp_after: u64,
}

/// One half after the other.
pub fn finish(joined: Joined) -> Cleaned {
    let (measured, threaded) = (joined.measured(), joined.threaded());
    joined.cleaned(measured, threaded)
}

impl Joined<'_> {
    /// One half: figures and findings.
    pub fn measured(&self) -> Measured {
        Measured {
            tally: Tally {
                rows: audit::rows(&self.graph),
                ..audit::displacements(&self.graph)
            },
            sharp_before: sharp::sharp_angles(self.input, SHARP_DEG),
            findings: leftovers::leftovers(&self.graph),
        }
    }

    /// The other half: what was lost, and the arrangement of the rest.
    pub fn threaded(&self) -> Threaded {
        let graph = &self.graph;
        let given = audit::stretches(graph, self.input.pieces.iter());
        let mut dropped = audit::missing(graph, &given);
        let (arrangement, torn) = match self.is_on {
            true => {
                dropped.sort_by_key(|it| it.line);
                let (domain, limits_m) = (graph.measure.domain, &graph.measure.tolerance_m);
                thread::thread(domain, graph.arrangement(), &given, &dropped, limits_m)
            }
            false => {
                // stretches of less than a cell, there and back, that the graph does not keep
                dropped.clear();
                (self.input.clone(), Vec::new())
            }
        };
        let lost = dropped.iter().filter(|it| it.reason != Reason::Shrunk);
        let length_dropped_m = lost.map(|it| it.to_m - it.from_m).sum();
        dropped.extend(torn);
        dropped.sort_by(|a, b| (a.line.cmp(&b.line)).then(a.from_m.total_cmp(&b.from_m)));
        Threaded {
            length_m: given.iter().map(|(_, from, to)| to - from).sum(),
            length_dropped_m,
            sharp_after: sharp::sharp_angles(&arrangement, SHARP_DEG),
            arrangement,
            dropped,
        }
    }

    /// Both halves together.
    pub fn cleaned(self, measured: Measured, threaded: Threaded) -> Cleaned {
        Cleaned {
            arrangement: threaded.arrangement,
            dropped: threaded.dropped,
            changes: self.graph.changes,
            tally: Tally {
                length_m: threaded.length_m,
                length_dropped_m: threaded.length_dropped_m,
                sharp_angles: [measured.sharp_before, threaded.sharp_after],
                ..measured.tally
            },
            findings: measured.findings,
        }
    }
}
