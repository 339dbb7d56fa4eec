//! Measures the graph against the input, and makes the arrangement of it: parts that need nothing of
//! each other.

use crate::cleanup::Cleaned;
use crate::cleanup::SHARP_DEG;
use crate::cleanup::audit;
use crate::cleanup::audit::Stretch;
use crate::cleanup::changes::Dropped;
use crate::cleanup::changes::Reason;
use crate::cleanup::changes::Tally;
use crate::cleanup::changes::length_m;
use crate::cleanup::graph::Graph;
use crate::cleanup::leftovers;
use crate::cleanup::measure::Measure;
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

/// What the input alone tells: known before the graph is.
pub struct Given {
    /// Union of the pieces, by line.
    stretches: Vec<Stretch>,
    sharp: u64,
}

/// How far lines moved: displacements and rows.
pub struct Moved(Tally);

/// What is still too short, too narrow or too sharp.
pub struct Left(Vec<Finding>);

/// The arrangement, and what is not in it.
pub struct Threaded {
    arrangement: Arrangement,
    dropped: Vec<Dropped>,
    length_m: f64,
    length_dropped_m: f64,
    sharp_after: u64,
}

/// One part after the other.
pub fn finish(joined: Joined) -> Cleaned {
    let given = Given::of(joined.graph.measure, joined.input);
    let (moved, left) = (joined.moved(), joined.left());
    let threaded = joined.threaded(&given);
    joined.cleaned(&given, moved, left, threaded)
}

impl Given {
    pub(super) fn of(measure: &Measure, input: &Arrangement) -> Given {
        Given {
            stretches: audit::stretches(measure, input.pieces.iter()),
            sharp: sharp::sharp_angles(input, SHARP_DEG),
        }
    }
}

impl Joined<'_> {
    /// The figures.
    pub fn moved(&self) -> Moved {
        Moved(Tally {
            rows: audit::rows(&self.graph),
            ..audit::displacements(&self.graph)
        })
    }

    /// The findings.
    pub fn left(&self) -> Left {
        Left(leftovers::leftovers(&self.graph))
    }

    /// What was lost, and the arrangement of the rest.
    pub fn threaded(&self, given: &Given) -> Threaded {
        let (graph, given) = (&self.graph, &given.stretches);
        let mut dropped = audit::missing(graph, given);
        let (arrangement, torn) = match self.is_on {
            true => {
                dropped.sort_by_key(|it| it.line);
                let (domain, measure) = (graph.measure.domain, graph.measure);
                let limit_m = |line| measure.tolerance_m(line);
                thread::thread(domain, graph.arrangement(), given, &dropped, limit_m)
            }
            false => {
                // stretches of less than a cell, there and back, that the graph does not keep
                dropped.clear();
                (self.input.clone(), Vec::new())
            }
        };
        let lost = dropped.iter().filter(|it| it.reason != Reason::Shrunk);
        let length_dropped_m = length_m(lost);
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

    /// All parts together.
    pub fn cleaned(self, given: &Given, moved: Moved, left: Left, threaded: Threaded) -> Cleaned {
        Cleaned {
            arrangement: threaded.arrangement,
            dropped: threaded.dropped,
            changes: self.graph.changes,
            tally: Tally {
                length_m: threaded.length_m,
                length_dropped_m: threaded.length_dropped_m,
                sharp_angles: [given.sharp, threaded.sharp_after],
                ..moved.0
            },
            findings: left.0,
            was_on: self.is_on,
        }
    }
}
