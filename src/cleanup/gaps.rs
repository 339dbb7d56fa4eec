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

/// What no edge near enough carries of the constraint lines, sorted. Also what was dropped, or lies outside of the
/// domain.
pub(super) fn gaps(graph: &Graph) -> Vec<Stretch> {
    let measure = graph.measure;
    let lines = 0..measure.domain.lines.len() as u32;
    let whole: Vec<Stretch> = lines
        .filter(|&line| !measure.is_rim(line))
        .map(|line| (line, 0.0, measure.length_m(line)))
        .collect();
    let near = pieces(graph).filter(|&(edge, piece)| is_near(graph, edge, piece));
    let near: Vec<&Piece> = near.map(|it| it.1).collect();
    subtract(&whole, &stretches(measure, near.into_iter()))
}

/// The nodes of edges that may cover a part of a gap, or carry it, sorted. O(gaps and what is near them).
pub(super) fn nodes_beside(graph: &Graph, gaps: &[Stretch]) -> Vec<u32> {
    let measure = graph.measure;
    let far = pieces(graph).filter(|&(edge, piece)| !is_near(graph, edge, piece));
    let mut nodes: Vec<u32> = far
        .flat_map(|(edge, _)| graph.edges[edge as usize].ends)
        .collect();
    for &(line, from_m, to_m) in gaps {
        let limit_m = measure.tolerance_m[line as usize];
        let gap = Piece { line, from_m, to_m };
        let mut way: Vec<Xy> = vec![measure.point(line, from_m)];
        way.extend(measure.vertices(&gap));
        way.push(measure.point(line, to_m));
        for pair in way.windows(2) {
            let [p, q] = [pair[0], pair[1]].map(|it| measure.on_grid(it));
            let reach = limit_m / measure.grid().cell_m;
            graph.index.any(p, q, reach, |held| {
                let pieces = &graph.edges[held.edge as usize].pieces;
                let (a, b) = graph.ends_m(held.edge);
                if pieces.iter().any(|piece| piece.line == line)
                    && apart_m([pair[0], pair[1]], [a, b]) <= limit_m
                {
                    nodes.extend(held.ends);
                }
                false
            });
        }
    }
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// All pieces, with their edges.
fn pieces<'g>(graph: &'g Graph) -> impl Iterator<Item = (u32, &'g Piece)> {
    let live = (0..).zip(&graph.edges).filter(|(_, edge)| edge.alive);
    live.flat_map(|(id, edge)| edge.pieces.iter().map(move |piece| (id, piece)))
}

/// True if a stretch is within tolerance of the edge that carries it.
fn is_near(graph: &Graph, edge: u32, piece: &Piece) -> bool {
    let (a, b) = graph.ends_m(edge);
    let limit_m = graph.measure.tolerance_m[piece.line as usize];
    graph.measure.deviation_m(piece, a, b) <= limit_m + ROUNDING_M
}

/// How much of the gaps is beyond tolerance of all edges of its line, metres.
pub(super) fn uncovered_m(graph: &Graph, gaps: &[Stretch], slack_m: f64) -> f64 {
    let carriers = carriers(graph);
    let beyond = gaps
        .iter()
        .flat_map(|gap| uncovered(graph, &carriers, gap, slack_m));
    beyond.map(|(_, from_m, to_m)| to_m - from_m).sum()
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
