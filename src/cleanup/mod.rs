//! Arrangement + SizeWish -> Arrangement that can be meshed at that size, and the table of changes.
//!
//! Downstream every node becomes a mesh node and every edge at least one element side. Real line
//! work is dirty far below the mesh size h: millimetre gaps, near duplicates, dual carriageways,
//! slivers. This stage merges what cannot be told apart at size h and pushes the rest apart.
//!
//! # Promises
//! 1. The result is planar, and no node has jumped over an edge.
//! 2. Each stretch of a line is within the tolerance of the edge that carries it, and the edge of
//!    the stretch (Hausdorff, measured to the input as read, never from step to step); what is
//!    not, is in `dropped`.
//! 3. Tags survive all merges: a merged edge carries the stretches of all its lines.
//! 4. Holes and boundaries may move within the tolerance, but none goes; corners of the outline
//!    stay unless an edge between two of them is too short.
//! 5. Every edge shorter than [`Options::min_edge`] h that is left is a finding with its place, its
//!    lines and its length, and so is every gap between a node and an edge that is narrower, and
//!    every angle below [`SHARP_DEG`] degrees.
//!    Simplification leaves junctions as nodes, and corners that turn by more than
//!    [`Options::corner_deg`] between edges of at least that length, in the line as read or as it
//!    is by now; other steps may merge them with what is near.
//! 6. Same input, same bits, in whatever order, or at once, districts are cleaned. A tolerance of
//!    zero changes nothing.
//! 7. What a kind of line asks for ([`rules`]) holds in every step: its own tolerance, no move
//!    beyond what it is held to, closed lines of it that keep an inside. Where two lines merge, the
//!    one of higher priority moves only if the other cannot.
//! 8. Lines meet only where they come within the sum of their tolerances: those that are everywhere
//!    farther apart keep their topology.
//!
//! On 18 real cases at two sizes each, settling after it, 99 % of the line length lies within .21 to .30 h of its
//! edges (below a quarter of the size but for four runs with the densest line work), and the 0.1 %
//! quantile of the sides of the finished meshes is .23 to .63 h.
//!
//! # Needs
//! An arrangement that is noded and clipped ([`noding::clip()`](crate::noding::clip())).
//!
//! # Method
//! One planar graph and five local operations on it, each refused unless exact predicates show that
//! the way is clear and all stretches concerned stay within tolerance; so nothing can break.
//! 1. `simplify`: nodes on a straight way go, the least deviation first.
//! 2. `separate`: short edges are contracted, near misses joined, the narrowest first. Of two nodes
//!    the less important moves (`importance`).
//! 3. `wedges`: lines that leave a node at an acute angle share their way until they are far enough
//!    apart. Where the tolerance forbids it, long arms get nodes, so that they can be joined or
//!    pushed apart bit by bit.
//! 4. `collapse`: faces that are too thin to hold elements are closed, and small triangles, which
//!    need six sides; small loops are dropped.
//! 5. `relax`: with frozen topology, nodes and edges push each other apart. Once everywhere, and
//!    again where a later step changed something. Beyond half of the tolerance a push takes only as much of
//!    the lines as it is worth.
//! 6. `tips`: tips that are still acute get an edge across, and with it a fourth corner, or the
//!    corner alone. Triangles that are still small are closed.
//! 7. `even`: small faces with an odd number of edges are made even, small triangles four-sided.
//! 8. `audit`: everything is measured against the input again; `thread`: the edges of each line are
//!    made one way from end to end; `leftovers`: what could not be had is named. Parts that can be
//!    done at once (`finish`); what the input alone tells, while bands are joined. [`rooms`] looks afterwards whether a sub-domain with room for
//!    elements was lost; that is measured, not promised.
//!
//! Steps 6, 7 and 5 run twice. Steps 1 to 4 run first with half of the tolerance, then with most of it: what
//! needs much movement is done only where nothing else helps. `operate` holds the operations,
//! `attempt` takes back what was tried together and failed, `clear` is the exact test, `stations`
//! and `measure` keep the books of stretches, `graph`, `edge`, `index` and `cells` are the graph.
//!
//! Large line work is cut into districts that are cleaned on their own (`districts`), all steps in
//! each; then in the same way the bands between them, and all steps run a last time in the whole
//! graph, at the few places where bands meet.
//!
//! The aims (separation of h/4, then relaxation) are those of S2Builder's snap rounding, which also
//! merges first. Unlike it we do not snap to sites: with a veto on each operation bundles of lines
//! do not drift, and planarity needs no argument about Voronoi cells.
//!
//! # Cost
//! Near-linear: each operation looks at a few cells of a grid (`cells`, `index`); later rounds look
//! only at what was changed. An attempt that failed changes nothing, and within a pass `separate`
//! tries it again only where an edge changed since. Relaxation asks once in three rounds what is near
//! (`nearby`); it is half of all instructions, separation a sixth. Cores share districts and bands, and two or three of
//! them the end; what one core does alone is a tenth of the time that two need for all. Memory: some 300
//! bytes an edge.
//!
//! # Not here
//! Crossings (`noding`), sub-domains and curves (`partition`), what elements think of where nodes are
//! (`settling`, by way of [`shifts`], which keeps what `gaps` names where it is), chords of curves (none: nodes are
//! mesh nodes, so tolerance is used up here).

mod attempt;
mod audit;
mod cells;
pub mod changes;
pub mod check;
mod clear;
mod collapse;
mod districts;
mod edge;
mod even;
mod finish;
mod gaps;
mod graph;
mod importance;
mod index;
mod layout;
mod leftovers;
mod measure;
mod nearby;
mod operate;
mod relax;
pub mod rooms;
pub mod rules;
mod separate;
mod sharp;
pub mod shifts;
mod simplify;
mod stations;
pub mod steps;
mod thread;
mod tips;
mod wedges;

use crate::cleanup::changes::Change;
use crate::cleanup::changes::Dropped;
use crate::cleanup::changes::Tally;
use crate::cleanup::collapse::Thin;
use crate::cleanup::even::Even;
use crate::cleanup::graph::Graph;
use crate::cleanup::relax::Wanted;
use crate::cleanup::rules::Rule;
use crate::cleanup::separate::Narrow;
use crate::cleanup::simplify::Smooth;
use crate::cleanup::steps::Step;
use crate::cleanup::tips::Blunt;
use crate::cleanup::wedges::Zip;
use crate::domain::finding::Finding;
use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::geometry::point::Xy;
use crate::noding::arrangement::Arrangement;

pub use crate::cleanup::districts::Made;
pub use crate::cleanup::districts::Met;
pub use crate::cleanup::districts::Site;
pub use crate::cleanup::districts::clean_band;
pub use crate::cleanup::districts::clean_district;
pub use crate::cleanup::districts::join;
pub use crate::cleanup::districts::layout;
pub use crate::cleanup::districts::meet;
pub use crate::cleanup::districts::site;
pub use crate::cleanup::finish::Given;
pub use crate::cleanup::finish::Joined;
pub use crate::cleanup::finish::finish;
pub use crate::cleanup::layout::Band;
pub use crate::cleanup::layout::District;
pub use crate::cleanup::layout::GRAIN;
pub use crate::cleanup::layout::Grain;
pub use crate::cleanup::layout::Layout;
pub use crate::cleanup::measure::Measure;

/// How far a line may be from the mesh edges that represent it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// A share of the wished size along the line; half is usual.
    ShareOfSize(f64),
    /// Metres, for all lines.
    Metres(f64),
}

impl Tolerance {
    /// In metres, where the wished size is `size_m`.
    pub fn at_m(self, size_m: f64) -> f64 {
        match self {
            Tolerance::ShareOfSize(share) => share * size_m,
            Tolerance::Metres(metres) => metres,
        }
    }
}

/// What clean-up may do.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Where no kind says otherwise. Zero for all lines switches clean-up off.
    pub tolerance: Tolerance,
    /// By kind of line; as long as [`Domain::kinds`].
    pub by_kind: Vec<Rule>,
    /// Least length of an edge, as a share of the wished size along its lines; [`SHORTEST`] is
    /// usual.
    pub min_edge: f64,
    /// If the line work was cleaned before: the places that had to be left as they are, projected
    /// metres. Where nothing else is too short, too narrow or too sharp, it is left alone.
    pub left: Option<Vec<Xy>>,
    /// A line turns at a corner if its direction changes by more than this, degrees.
    pub corner_deg: f64,
    /// Steps that are left out, to measure what they are worth.
    pub without: Vec<Step>,
}

/// The line work, ready to be meshed.
#[derive(Clone, Debug, PartialEq)]
pub struct Cleaned {
    /// Nodes, edges and what they represent.
    pub arrangement: Arrangement,
    /// Stretches of lines that are not in the arrangement any more, by line and station.
    pub dropped: Vec<Dropped>,
    /// Where something changed, in the order in which it happened.
    pub changes: Vec<Change>,
    /// How often and how far.
    pub tally: Tally,
    /// What is still too short or too sharp.
    pub findings: Vec<Finding>,
    /// False if clean-up was to change nothing: no tolerance, or all was clean already.
    pub was_on: bool,
}

/// Edges shorter than this share of the mesh size are findings, unless the job says otherwise.
pub const SHORTEST: f64 = 0.25;
/// Angles below this are findings, degrees.
pub const SHARP_DEG: f64 = 20.0;

/// Cleans a noded and clipped arrangement up to the mesh size; one district after the other.
pub fn clean(
    domain: &Domain,
    sizes: &SizeWish,
    arrangement: Arrangement,
    options: &Options,
) -> Cleaned {
    let measure = Measure::new(domain, sizes, options);
    let layout = layout(domain, sizes, &arrangement, &GRAIN);
    let site = site(measure, layout, arrangement, options);
    let districts = site.districts().iter();
    let made = districts.map(|it| clean_district(&site, it)).collect();
    let met = meet(&site, made);
    let bands = site.bands().iter();
    let bands = bands.map(|it| clean_band(&site, &met, it)).collect();
    finish(join(&site, met, bands))
}

/// Removes only what no one could see.
const FINE: Smooth = Smooth {
    deviation: 0.03,
    at_corners: 0.03,
    on_rim: 0.03,
    gap: 0.0,
    angle_deg: 0.0,
    over_ends: false,
};
/// Keeps the shape at the mesh size, and all that the other steps won.
const SMOOTH: Smooth = Smooth {
    deviation: 0.2,
    at_corners: 0.1,
    on_rim: 0.1,
    gap: 0.3,
    angle_deg: 25.0,
    over_ends: true,
};
/// What one pass may do.
struct Pass {
    narrow: Narrow,
    zip: Zip,
    thin: Thin,
}
/// With half of the tolerance, which leaves 99 % of the lines within a quarter of the size: nearly
/// all room is made here. (Measured on seven cities: a pass with a little more of it, before the one with most, gains
/// nothing, for a tenth of the time. On twelve: where faces up to .25 wide are closed, and not up to .21, 99 % of the
/// lines lie .003 of the size farther away, for cells that grow by less than .5 %.)
const GENTLE: Pass = Pass {
    narrow: Narrow {
        edge: 0.25,
        gap: 0.3,
        end: 0.25,
        share: 0.5,
    },
    zip: Zip {
        below_deg: 30.0,
        gap: 0.45,
        share: 0.5,
    },
    thin: Thin {
        width: 0.22,
        triangle: 0.29,
        reach: 0.5,
        share: 0.5,
        drops_loops: false,
    },
};
/// With most of it, but only for what no mesh could bear. (Measured on twelve cities: with all of it the .1 %
/// quantile of the time-step proxy grows by .6 %, but the displacement that 99 % of the lines stay below by
/// .0045 of the size.)
const LAST: Pass = Pass {
    narrow: Narrow {
        edge: 0.2,
        gap: 0.1,
        end: 0.25,
        share: 0.8,
    },
    zip: Zip {
        below_deg: 10.0,
        gap: 0.2,
        share: 0.8,
    },
    thin: Thin {
        width: 0.15,
        triangle: 0.2,
        reach: 0.5,
        share: 0.8,
        drops_loops: true,
    },
};
/// What is merged because relaxation could not push it apart.
const STUCK: Narrow = Narrow {
    edge: 0.3,
    gap: 0.25,
    end: 0.25,
    share: 1.0,
};
/// Triangles that relaxation could not open either. (Measured on five cities: the .1 % quantile of
/// the time-step proxy grows by up to 8 %, that of edges by up to 14 %, and the 1 % quantile of
/// shapes by up to .014; as late as this only the hopeless ones go, and the displacement that 99 %
/// of the lines stay below grows by .003 of the size, .009 at most. Before relaxation with all of
/// the tolerance, or up to .25 here, it grows more, for no more.)
const HOPELESS: Thin = Thin {
    width: 0.0,
    triangle: 0.22,
    reach: 0.5,
    share: 1.0,
    drops_loops: false,
};
/// What is left of acute tips when all has found its place. (Measured on five cities: with .8 of the
/// tolerance half of the gain is gone. Up to 52 degrees, the 1 % quantile of shapes grows by up to .009,
/// but more than 1 % of the lines of two more cities lie beyond a quarter of the size.
/// The other line and the corner, on nine cities: the .1 % quantile of the time-step proxy grows by 2 to
/// 16 %, the 1 % quantile of shapes by up to .034, the displacement that 99 % of the lines stay below by
/// .003 of the size at most.)
const BLUNT: Blunt = Blunt {
    below_deg: 45.0,
    across: 0.45,
    least: 0.3,
    most: 0.6,
    corner: 0.6,
    shares: [0.9, 1.0, 0.6],
};
/// Small faces with an odd number of edges. (Measured on six cities: the .1 % quantile of the time-step
/// proxy grows by up to 13 %, the 1 % quantile of shapes by up to .008, the displacement that 99 % of the lines stay
/// below by .001 to .005 of the size. Faces with six edges, two of them contracted, gain no more, for twice
/// the displacement.)
const EVEN: Even = Even {
    small: 6.0,
    large: 6.0,
    edge: 0.55,
    triangle: 0.28,
    share: 1.0,
};
/// More than what should hold in the end: steps are damped, and lines are in each other's way. (Measured
/// on twelve cities: a gap of .45 lowers the .1 % quantiles of the time-step proxy by 2.8 % and of edges by 1.7 %, the 1 %
/// quantile of shapes by .007, and the displacement that 99 % of the lines stay below by .002 of the size;
/// .55 raises the first two by .9 and 1.5 %, but the displacement by .007.)
const WANTED: Wanted = Wanted {
    edge: 0.45,
    gap: 0.5,
    shares: [0.5, 0.8],
    rounds: 8,
};
/// Zipping, closing and merging make work for each other; more rounds than this find hardly any.
const ROUNDS_MAX: usize = 6;
/// Relaxation opens some of the tips that could not be blunted before it. (Measured on nine cities: the .1 %
/// quantile of the time-step proxy grows by up to 6 %; a third round gains nothing.)
const FINAL_ROUNDS: usize = 2;

/// All steps, in order.
fn make_room(graph: &mut Graph) {
    graph.take_nodes();
    simplify::simplify(graph, &FINE, &graph.nodes());
    let least = graph.measure.min_edge;
    for pass in [&GENTLE, &LAST] {
        let narrow = Narrow {
            edge: pass.narrow.edge.max(least),
            ..pass.narrow
        };
        separate::separate(graph, &narrow, &graph.nodes());
        let mut nodes = graph.nodes();
        for _ in 0..ROUNDS_MAX {
            simplify::simplify(graph, &SMOOTH, &nodes);
            let mark = graph.touched.len();
            wedges::zip_wedges(graph, &pass.zip, &nodes);
            collapse::collapse_thin(graph, &pass.thin, &nodes);
            nodes = graph.nodes_since(mark);
            if nodes.is_empty() {
                break;
            }
            separate::separate(graph, &narrow, &nodes);
            nodes = graph.nodes_since(mark);
        }
    }
    let stuck = Narrow {
        edge: STUCK.edge.max(1.1 * least),
        ..STUCK
    };
    let wanted = Wanted {
        edge: WANTED.edge.max(1.2 * least),
        ..WANTED
    };
    let mut mark = graph.touched.len();
    wedges::divide_wedges(graph, &GENTLE.zip, &graph.nodes());
    relax::relax(graph, &wanted, &graph.nodes());
    for round in 0..FINAL_ROUNDS {
        // later on, what nothing has touched since would fail as it did
        let nodes = |graph: &Graph| match round {
            0 => graph.nodes(),
            _ => graph.nodes_since(mark),
        };
        let relaxed = graph.touched.len();
        tips::blunt_tips(graph, &BLUNT, &nodes(graph));
        separate::separate(graph, &stuck, &nodes(graph));
        collapse::collapse_thin(graph, &HOPELESS, &nodes(graph));
        simplify::simplify(graph, &SMOOTH, &graph.nodes_since(mark));
        // two nodes that became one may have left a wedge between their long edges
        wedges::divide_wedges(graph, &GENTLE.zip, &graph.nodes_since(mark));
        even::make_even(graph, &EVEN, &nodes(graph));
        relax::relax(graph, &wanted, &graph.nodes_since(relaxed));
        mark = relaxed;
    }
}
