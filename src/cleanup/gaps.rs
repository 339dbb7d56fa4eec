//! Stretches that are not within tolerance of an edge that carries them, but of another one of the same line.
//!
//! Merging leaves them where a line turns back on itself or ends, with no edge or a far one, and `audit` takes them for
//! covered. So whoever moves a node by what its own stretches allow may leave them behind: the nodes of edges that
//! cover such a stretch, or carry it, have to stay.

use crate::cleanup::audit::Stretch;
use crate::cleanup::audit::carriers;
use crate::cleanup::audit::stretches;
use crate::cleanup::audit::subtract;
use crate::cleanup::audit::uncovered;
use crate::cleanup::graph::Graph;
use crate::cleanup::measure::ROUNDING_M;
use crate::cleanup::measure::to_segment;
use crate::geometry::point::Xy;
use crate::geometry::quad::cross;
use crate::noding::arrangement::Piece;

/// What no edge near enough carries.
pub(super) struct Gaps {
    /// Of constraint lines, sorted. Also what was dropped, or lies outside of the domain.
    stretches: Vec<Stretch>,
    /// The ends of edges that carry a stretch from too far away.
    carriers: Vec<u32>,
}

/// Looks for all gaps. O(stretches).
pub(super) fn gaps(graph: &Graph) -> Gaps {
    let measure = graph.measure;
    let (mut near, mut carriers) = (Vec::new(), Vec::new());
    for edge in graph.live() {
        let (a, b) = graph.ends_m(edge);
        for piece in &graph.pieces[edge as usize] {
            let limit_m = measure.tolerance_m(piece.line);
            match measure.deviation_m(piece, a, b) <= limit_m + ROUNDING_M {
                true => near.push(piece),
                false => carriers.extend(graph.edges[edge as usize].ends),
            }
        }
    }
    let lines = 0..measure.domain.lines.len() as u32;
    let whole: Vec<Stretch> = lines
        .filter(|&line| !measure.is_rim(line))
        .map(|line| (line, 0.0, measure.length_m(line)))
        .collect();
    Gaps {
        stretches: subtract(&whole, &stretches(measure, near.into_iter())),
        carriers,
    }
}

impl Gaps {
    /// The nodes of edges that may cover a part of a gap, or carry it, some more than once. O(gaps and what is near
    /// them).
    pub(super) fn nodes_beside(&self, graph: &Graph) -> Vec<u32> {
        let measure = graph.measure;
        let mut nodes = self.carriers.clone();
        for &(line, from_m, to_m) in &self.stretches {
            let limit_m = measure.tolerance_m(line);
            let reach = limit_m / measure.grid().cell_m;
            let way: Vec<Xy> = measure.way(&Piece { line, from_m, to_m }).collect();
            for pair in way.windows(2) {
                let [p, q] = [pair[0], pair[1]].map(|it| measure.on_grid(it));
                graph.index.any(p, q, reach, |held| {
                    let mut pieces = graph.pieces[held.edge as usize].iter();
                    let (a, b) = graph.ends_m(held.edge);
                    if pieces.any(|piece| piece.line == line)
                        && apart_m([pair[0], pair[1]], [a, b]) <= limit_m
                    {
                        nodes.extend(held.ends);
                    }
                    false
                });
            }
        }
        nodes
    }

    /// How much of the gaps is beyond tolerance of all edges of its line in a graph, metres.
    pub(super) fn uncovered_m(&self, graph: &Graph) -> f64 {
        let carriers = carriers(graph);
        let gaps = self.stretches.iter();
        let beyond = gaps.flat_map(|gap| uncovered(graph, &carriers, gap, 0.0));
        beyond.map(|(_, from_m, to_m)| to_m - from_m).sum()
    }
}

/// The distance between two segments.
fn apart_m([p, q]: [Xy; 2], [a, b]: [Xy; 2]) -> f64 {
    let are_parted = |a: Xy, b: Xy, p: Xy, q: Xy| cross(a, b, p) * cross(a, b, q) > 0.0;
    if !are_parted(a, b, p, q) && !are_parted(p, q, a, b) {
        return 0.0;
    }
    let ends = [(p, a, b), (q, a, b), (a, p, q), (b, p, q)];
    let away = ends.map(|(end, u, v)| to_segment(end, u, v).0);
    away.into_iter().fold(f64::INFINITY, f64::min)
}
