//! What clean-up could not mend, as findings with their place.

use crate::cleanup::SHARP_DEG;
use crate::cleanup::SHORTEST;
use crate::cleanup::graph::Graph;
use crate::cleanup::measure::distance;
use crate::cleanup::wedges::wedges;
use crate::domain::finding::Finding;

/// Edges that are too short, then angles that are too sharp, by place.
pub(super) fn leftovers(graph: &Graph) -> Vec<Finding> {
    let mut edges = graph.live();
    edges.retain(|&edge| {
        let (a, b) = graph.ends_m(edge);
        distance(a, b) < SHORTEST * graph.edges[edge as usize].size_m
    });
    edges.sort_by_key(|&edge| {
        let ends = graph.edges[edge as usize]
            .ends
            .map(|node| graph.point(node));
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    });
    let mut findings: Vec<Finding> = edges.iter().map(|&edge| short_edge(graph, edge)).collect();
    let all: Vec<u32> = (0..graph.at.len() as u32).collect();
    let mut sharp = wedges(graph, SHARP_DEG, &all);
    sharp.sort_by(|u, v| {
        let place = |node: u32| graph.point(node);
        (place(u.hub).cmp(&place(v.hub))).then_with(|| place(u.a).cmp(&place(v.a)))
    });
    findings.extend(sharp.iter().map(|wedge| Finding {
        what: "sharp-angle",
        text: format!(
            "Two lines meet at {:.1} degrees; parting them further would move one beyond tolerance.",
            wedge.angle_deg
        ),
        feature: None,
        at_m: Some(graph.measure.grid().projected_m(graph.point(wedge.hub))),
    }));
    findings
}

fn short_edge(graph: &Graph, edge: u32) -> Finding {
    let it = &graph.edges[edge as usize];
    let (a, b) = graph.ends_m(edge);
    let line = it.pieces.iter().map(|piece| piece.line).min();
    Finding {
        what: "short-edge",
        text: format!(
            "An edge of {:.3} m remains where the size is {} m; contracting it would move a line \
             beyond tolerance.",
            distance(a, b),
            it.size_m
        ),
        feature: line.map(|line| graph.measure.domain.lines[line as usize].source),
        at_m: Some(graph.measure.grid().projected_m(graph.point(it.ends[0]))),
    }
}
