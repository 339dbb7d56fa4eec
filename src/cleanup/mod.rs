//! Arrangement + SizeWish -> Arrangement that can be meshed at that size, and the table of changes.

mod audit;
pub mod changes;
mod clear;
mod collapse;
mod graph;
mod importance;
mod index;
mod measure;
mod operate;
mod relax;
mod separate;
mod simplify;
mod stations;
mod wedges;

use crate::cleanup::changes::Change;
use crate::cleanup::changes::Dropped;
use crate::cleanup::changes::Tally;
use crate::cleanup::graph::Graph;
use crate::cleanup::measure::Measure;
use crate::domain::finding::Finding;
use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::noding::arrangement::Arrangement;

/// How far a line may be from the mesh edges that represent it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// A share of the wished size along the line; at most half.
    ShareOfSize(f64),
    /// Metres, for all lines.
    Metres(f64),
}

/// What clean-up may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Zero switches clean-up off.
    pub tolerance: Tolerance,
}

/// The line work, ready to be meshed.
#[derive(Clone, Debug)]
pub struct Cleaned {
    /// Nodes, edges and what they represent.
    pub arrangement: Arrangement,
    /// Stretches of lines that are not in the arrangement any more.
    pub dropped: Vec<Dropped>,
    /// Where the topology changed, in the order in which it happened.
    pub changes: Vec<Change>,
    /// How often and how far.
    pub tally: Tally,
    /// What could not be had.
    pub findings: Vec<Finding>,
}

/// Cleans a noded and clipped arrangement up to the mesh size.
pub fn clean(
    domain: &Domain,
    sizes: &SizeWish,
    arrangement: Arrangement,
    options: &Options,
) -> Cleaned {
    let measure = Measure::new(domain, sizes, options);
    let side = 0.5 * sizes.default_m / domain.grid.cell_m;
    let mut graph = Graph::new(&arrangement, measure, side.max(4.0));
    let off =
        matches!(options.tolerance, Tolerance::ShareOfSize(t) | Tolerance::Metres(t) if t <= 0.0);
    if !off {
        steps(&mut graph);
    }
    let (dropped, tally) = audit::audit(&graph, &arrangement);
    Cleaned {
        arrangement: if off {
            arrangement
        } else {
            graph.arrangement()
        },
        dropped,
        changes: graph.changes,
        tally,
        findings: Vec::new(),
    }
}

fn steps(graph: &mut Graph) {
    let fine = simplify::Smooth {
        deviation: 0.03,
        at_corners: 0.03,
        on_rim: 0.03,
        gap: 0.0,
        angle_deg: 0.0,
        over_ends: false,
    };
    let smooth = simplify::Smooth {
        deviation: 0.2,
        at_corners: 0.1,
        on_rim: 0.1,
        gap: 0.3,
        angle_deg: 25.0,
        over_ends: true,
    };
    let narrow = |share| separate::Narrow {
        edge: 0.25,
        gap: 0.18,
        end: 0.25,
        share,
    };
    let zip = |share| wedges::Zip {
        below_deg: 25.0,
        gap: 0.35,
        share,
    };
    let thin = |share| collapse::Thin {
        width: 0.25,
        reach: 0.5,
        share,
    };
    let wanted = |share| relax::Wanted {
        edge: 0.36,
        gap: 0.31,
        share,
        rounds: 40,
    };
    simplify::simplify(graph, &fine);
    // what can be had within half the tolerance, then what needs all of it
    separate::separate(graph, &narrow(0.5));
    simplify::simplify(graph, &smooth);
    for share in [0.5, 0.5, 1.0, 1.0] {
        let zipped = wedges::zip_wedges(graph, &zip(share));
        let mut closed = 0;
        for _ in 0..6 {
            let steps = collapse::collapse_thin(graph, &thin(share));
            closed += steps;
            if steps == 0 {
                break;
            }
        }
        separate::separate(graph, &narrow(share));
        simplify::simplify(graph, &smooth);
        if zipped + closed == 0 && share == 1.0 {
            break;
        }
    }
    relax::relax(graph, &wanted(0.5));
    relax::relax(graph, &wanted(0.9));
    let rest = separate::Narrow {
        edge: 0.3,
        gap: 0.22,
        end: 0.25,
        share: 1.0,
    };
    separate::separate(graph, &rest);
    simplify::simplify(graph, &smooth);
    relax::relax(graph, &wanted(0.9));
}
