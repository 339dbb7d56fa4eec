//! Nodes of clean line work, moved one after the other as a later stage asks, within what clean-up
//! promises: topology stays, each stretch within its share of the tolerance, and all but 1 % of their length within
//! half of it, or what clean-up had left of them.

use crate::cleanup::Options;
use crate::cleanup::SHARP_DEG;
use crate::cleanup::audit;
use crate::cleanup::changes::Tally;
use crate::cleanup::gaps;
use crate::cleanup::graph::Graph;
use crate::cleanup::graph::Stand;
use crate::cleanup::importance::is_rim_corner;
use crate::cleanup::leftovers;
use crate::cleanup::measure::Measure;
use crate::cleanup::measure::NEAR;
use crate::cleanup::measure::ROUNDING_M;
use crate::cleanup::measure::distance;
use crate::cleanup::operate::Shift;
use crate::cleanup::relax::along_rim;
use crate::cleanup::sharp;
use crate::domain::finding::Finding;
use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::geometry::point::Xy;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::Piece;
use smallvec::SmallVec;

/// Clean line work whose nodes may be shifted.
pub struct Shifts<'m> {
    graph: Graph<'m>,
    /// By edge of the graph, that of the arrangement.
    edge: Vec<u32>,
}

/// How far the stretches at a node may be from their edges.
pub struct Limits {
    /// In the order of its edges and their pieces, metres.
    each_m: SmallVec<[f64; 16]>,
    /// How much of them may be farther away than half of their tolerance, metres.
    beyond_m: f64,
}

/// Of the tolerance: what a stretch may take as long as there is [`Shifts::spare_m`]. (Measured on twelve cities: all of
/// it gains .1 % of the time-step proxy.)
const WIDE: f64 = 0.8;

/// How much of the length of all lines may be farther away than half of its tolerance: a little less than the 1 % that
/// is promised.
const FAR_PART: f64 = 0.0097;

/// Hands clean line work to `work`, and takes over where nodes are afterwards; nothing if no line may
/// be moved. Ids stay, so points may come out of their order.
///
/// Edges without pieces (seams, rungs) are not lines: their ends stay. So do the nodes of edges that cover a stretch for
/// the one that should carry it (`gaps`).
pub fn shift(
    domain: &Domain,
    sizes: &SizeWish,
    options: &Options,
    arrangement: &mut Arrangement,
    work: impl FnOnce(&mut Shifts),
) {
    let measure = Measure::new(domain, sizes, options);
    if measure.allows_any() {
        let mut shifts = Shifts::of(arrangement, &measure);
        let graph = &mut shifts.graph;
        for node in gaps::gaps(graph).nodes_beside(graph) {
            graph.set_stand(node, Stand::Tied);
        }
        work(&mut shifts);
        shifts.write(arrangement);
    }
}

/// What is to be told anew of line work that was shifted: how far lines are away, in `tally`; returned, what
/// is still too short, too narrow or too sharp.
pub fn retell(
    domain: &Domain,
    sizes: &SizeWish,
    options: &Options,
    arrangement: &Arrangement,
    tally: &mut Tally,
) -> Vec<Finding> {
    let measure = Measure::new(domain, sizes, options);
    let graph = Shifts::of(arrangement, &measure).graph;
    let moved = audit::displacements(&graph);
    *tally = Tally {
        rows: std::mem::take(&mut tally.rows),
        length_m: tally.length_m,
        length_dropped_m: tally.length_dropped_m,
        sharp_angles: [
            tally.sharp_angles[0],
            sharp::sharp_angles(arrangement, SHARP_DEG),
        ],
        ..moved
    };
    leftovers::leftovers(&graph)
}

impl<'m> Shifts<'m> {
    fn of(arrangement: &Arrangement, measure: &'m Measure<'m>) -> Shifts<'m> {
        let all = 0..arrangement.edges.len() as u32;
        let (lines, others): (Vec<u32>, Vec<u32>) =
            all.partition(|&edge| !arrangement.pieces_of(edge).is_empty());
        let mut graph = Graph::of(arrangement, &lines, measure);
        for (pieces, &id) in graph.pieces.iter_mut().zip(&lines) {
            // all of them: the graph thins bundles out, and here they are written back
            *pieces = arrangement.pieces_of(id).into();
        }
        graph.take_nodes();
        for &edge in &others {
            for node in arrangement.edges[edge as usize] {
                graph.set_stand(node, Stand::Tied);
            }
        }
        Shifts { graph, edge: lines }
    }

    /// How many nodes there are.
    pub fn nodes(&self) -> u32 {
        self.graph.at.len() as u32
    }

    /// Where a node is, local metres.
    fn at_m(&self, node: u32) -> Xy {
        self.graph.metres(node)
    }

    /// Least wished edge length of the lines at a node, metres.
    pub fn size_at_m(&self, node: u32) -> f64 {
        self.graph.size_at_m(node)
    }

    /// False if a node has to stay whatever is asked: ends of seams, corners of the outline.
    pub fn may_move(&self, node: u32) -> bool {
        self.graph.is_free(node) && !is_rim_corner(&self.graph, node)
    }

    /// What of a wished move is open to a node: on the outline, the part along it; from grid point to
    /// grid point. Metres.
    pub fn open_to(&self, node: u32, by: Xy) -> Xy {
        let (at, by) = (self.at_m(node), along_rim(&self.graph, node, by));
        let measure = self.graph.measure;
        let to = measure.metres(measure.on_grid([at[0] + by[0], at[1] + by[1]]));
        [to[0] - at[0], to[1] - at[1]]
    }

    /// Moves a node by so many metres, if the way is clear, and no stretch at it comes farther from its edge than
    /// `limits` allow, which are of the node where it is.
    pub fn shift(&mut self, node: u32, by: Xy, limits: &Limits) -> bool {
        let (at, measure) = (self.at_m(node), self.graph.measure);
        let to = measure.on_grid([at[0] + by[0], at[1] + by[1]]);
        let mut limits_m = limits.each_m.iter();
        let mut left_m = limits.beyond_m + ROUNDING_M;
        let shift = self.graph.shift_if(node, to, |piece, a, b| {
            let limit_m = limits_m.next().expect("one for each stretch");
            if measure.deviation_m(piece, a, b) > *limit_m {
                return false;
            }
            left_m -= measure.beyond_m(piece, a, b);
            left_m >= 0.0
        });
        shift == Shift::Done
    }

    /// How far stretches at a node may usually be from their edges: half of their tolerance, or as far as they are.
    pub fn limits(&self, node: u32) -> Limits {
        self.limits_within(node, NEAR, 0.0)
    }

    /// The same with [`WIDE`] of it, for no more than `more_m` of them.
    pub fn wide_limits(&self, node: u32, more_m: f64) -> Limits {
        self.limits_within(node, WIDE, more_m)
    }

    fn limits_within(&self, node: u32, share: f64, more_m: f64) -> Limits {
        let (graph, measure) = (&self.graph, self.graph.measure);
        let star = graph.star[node as usize].iter();
        let limits_m = star.flat_map(|&edge| {
            let (a, b) = graph.ends_m(edge);
            let pieces = graph.pieces[edge as usize].iter();
            pieces.map(move |piece| {
                let usual_m = share * measure.tolerance_m(piece.line);
                usual_m.max(measure.deviation_m(piece, a, b))
            })
        });
        Limits {
            each_m: limits_m.collect(),
            beyond_m: graph.beyond_m(node) + more_m,
        }
    }

    /// How much of the stretches at a node is farther from its edge than half of its tolerance, metres.
    pub fn beyond_m(&self, node: u32) -> f64 {
        self.graph.beyond_m(node)
    }

    /// How much more of all lines may be, metres; negative if it is too much already.
    pub fn spare_m(&self) -> f64 {
        let pieces = self.graph.pieces.iter().flatten();
        let length_m = |piece: &Piece| (piece.to_m - piece.from_m).abs();
        let all_m: f64 = pieces.map(length_m).sum();
        FAR_PART * all_m - self.all_beyond_m()
    }

    fn all_beyond_m(&self) -> f64 {
        let edges = 0..self.graph.edges.len() as u32;
        edges.map(|edge| self.graph.edge_beyond_m(edge)).sum()
    }

    fn write(&self, arrangement: &mut Arrangement) {
        arrangement.points.clone_from(&self.graph.at);
        for (held, &id) in self.graph.pieces.iter().zip(&self.edge) {
            let [from, to] = [0, 1].map(|k| arrangement.piece_start[id as usize + k] as usize);
            let pieces = &mut arrangement.pieces[from..to];
            debug_assert_eq!(
                pieces.len(),
                held.len(),
                "stretches are neither lost nor made"
            );
            pieces.copy_from_slice(held);
            pieces.sort_by(|p, q| p.order(q));
        }
    }
}

/// Checks that no stretch is farther from its edge than [`WIDE`] of its tolerance, or than it was; that no more than
/// [`FAR_PART`] of their length is farther away than half of it, or than was; that no less is covered of what no edge
/// carries; that no edge has become shorter than the least that is asked for anywhere; rounding aside; and that
/// corners of the outline stayed.
pub fn check(
    domain: &Domain,
    sizes: &SizeWish,
    options: &Options,
    [before, after]: [&Arrangement; 2],
) -> Result<(), String> {
    let measure = Measure::new(domain, sizes, options);
    let (was, is) = (Shifts::of(before, &measure), Shifts::of(after, &measure));
    let rounding_m = 2.0 * domain.grid.cell_m;
    let finest_m = (sizes.by_kind_m.iter().copied()).fold(sizes.default_m, f64::min);
    let pieces = was.graph.pieces.iter().zip(&is.graph.pieces);
    for (id, (one, other)) in (0..).zip(pieces) {
        let ((a, b), (c, d)) = (was.graph.ends_m(id), is.graph.ends_m(id));
        let (old_m, new_m) = (distance(a, b), distance(c, d));
        if new_m < old_m.min(options.min_edge * finest_m) - rounding_m {
            return Err(format!("edge {id} is {new_m} m long, and was {old_m} m"));
        }
        for (old, new) in one.iter().zip(other) {
            let usual_m = WIDE * measure.tolerance_m(new.line);
            let limit_m = usual_m.max(measure.deviation_m(old, a, b)) + rounding_m;
            let away_m = measure.deviation_m(new, c, d);
            if away_m > limit_m {
                let line = new.line;
                return Err(format!(
                    "line {line} is {away_m} m away, at most {limit_m} m is allowed"
                ));
            }
        }
    }
    let [old_m, new_m] = [&was, &is].map(Shifts::all_beyond_m);
    let slack_m = rounding_m + ROUNDING_M * f64::from(was.nodes());
    if new_m > old_m + slack_m && is.spare_m() < -slack_m {
        return Err(format!(
            "{new_m} m of lines are farther away than half of their tolerance, and were {old_m} m"
        ));
    }
    let gaps = gaps::gaps(&was.graph);
    let [before_m, after_m] = [&was.graph, &is.graph].map(|it| gaps.uncovered_m(it));
    if after_m > before_m + rounding_m {
        return Err(format!(
            "{after_m} m of lines are beyond tolerance of all edges of theirs, and were {before_m} m"
        ));
    }
    let moved = |&node: &u32| was.graph.point(node) != is.graph.point(node);
    let mut moved = (0..was.nodes()).filter(moved);
    match moved.find(|&node| is_rim_corner(&was.graph, node)) {
        Some(node) => Err(format!("node {node}, a corner of the outline, has moved")),
        None => Ok(()),
    }
}
