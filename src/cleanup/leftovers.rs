//! What clean-up could not mend, as findings with their place.

use crate::cleanup::SHARP_DEG;
use crate::cleanup::graph::Graph;
use crate::cleanup::measure::distance;
use crate::cleanup::measure::to_segment;
use crate::cleanup::separate::gap_m;
use crate::cleanup::wedges::wedges;
use crate::domain::finding::Finding;
use crate::domain::line::LineId;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;

/// Edges that are too short, gaps that are too narrow, angles that are too sharp, each by place.
pub(super) fn leftovers(graph: &Graph) -> Vec<Finding> {
    let mut findings = short_edges(graph);
    findings.extend(narrow_gaps(graph));
    findings.extend(sharp_angles(graph));
    findings
}

fn short_edges(graph: &Graph) -> Vec<Finding> {
    let mut edges = graph.live();
    edges.retain(|&edge| {
        let (a, b) = graph.ends_m(edge);
        distance(a, b) < graph.measure.min_edge * graph.edges[edge as usize].size_m
    });
    edges.sort_by_key(|&edge| ends_in_order(graph, edge));
    edges.iter().map(|&edge| short_edge(graph, edge)).collect()
}

fn ends_in_order(graph: &Graph, edge: u32) -> [Point; 2] {
    let ends = graph.edges[edge as usize].ends;
    let mut ends = ends.map(|node| graph.point(node));
    ends.sort_unstable();
    ends
}

fn short_edge(graph: &Graph, edge: u32) -> Finding {
    let it = &graph.edges[edge as usize];
    let (a, b) = graph.ends_m(edge);
    let lines = lines_of(graph, &[edge]);
    Finding {
        what: "short-edge",
        text: format!(
            "An edge of {:.3} m remains on {} where the size is {} m; contracting it would move a \
             line beyond its tolerance.",
            distance(a, b),
            named(graph, &lines),
            it.size_m
        ),
        feature: feature(graph, &lines),
        at_m: projected(graph, [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]),
    }
}

/// Nodes too near to an edge that is not their own.
fn narrow_gaps(graph: &Graph) -> Vec<Finding> {
    let mut gaps: Vec<(Point, [Point; 2], u32, u32, f64)> = Vec::new();
    let mut found = Vec::new();
    for node in graph.all_nodes() {
        let limit_m = graph.measure.min_edge * graph.size_at_m(node);
        let reach = limit_m / graph.measure.grid().cell_m;
        let at = graph.point(node);
        graph.index.near(at, at, reach, &mut found);
        for &edge in &found {
            let limit_m = limit_m.min(graph.measure.min_edge * graph.edges[edge as usize].size_m);
            if let Some(gap) = gap_m(graph, node, edge).filter(|&gap| gap < limit_m) {
                gaps.push((at, ends_in_order(graph, edge), node, edge, gap));
            }
        }
    }
    gaps.sort_by_key(|it| (it.0, it.1));
    let finding = |&(_, _, node, edge, gap): &(Point, [Point; 2], u32, u32, f64)| {
        let [ours, theirs] =
            [&graph.star[node as usize][..], &[edge]].map(|it| lines_of(graph, it));
        let (a, b) = graph.ends_m(edge);
        let (p, t) = (graph.metres(node), to_segment(graph.metres(node), a, b).1);
        let foot = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
        Finding {
            what: "narrow-gap",
            text: format!(
                "A gap of {gap:.3} m remains between {} and {}; closing it would move a line beyond \
                 its tolerance, or close a passage.",
                named(graph, &ours),
                named(graph, &theirs)
            ),
            feature: feature(graph, &ours),
            at_m: projected(graph, [0.5 * (p[0] + foot[0]), 0.5 * (p[1] + foot[1])]),
        }
    };
    gaps.iter().map(finding).collect()
}

fn sharp_angles(graph: &Graph) -> Vec<Finding> {
    let mut sharp = wedges(graph, SHARP_DEG, &graph.all_nodes());
    sharp.sort_by(|u, v| {
        let place = |node: u32| graph.point(node);
        (place(u.hub).cmp(&place(v.hub))).then_with(|| place(u.a).cmp(&place(v.a)))
    });
    let finding = |wedge: &crate::cleanup::wedges::Wedge| {
        let arms = [wedge.a, wedge.b].map(|end| graph.find(wedge.hub, end));
        let [one, other] = arms.map(|edge| lines_of(graph, edge.as_slice()));
        Finding {
            what: "sharp-angle",
            text: format!(
                "{} and {} meet at {:.1} degrees; parting them further would move one beyond its \
                 tolerance.",
                named(graph, &one),
                named(graph, &other),
                wedge.angle_deg
            ),
            feature: feature(graph, &one),
            at_m: projected(graph, graph.metres(wedge.hub)),
        }
    };
    sharp.iter().map(finding).collect()
}

/// The lines on some edges, each once.
fn lines_of(graph: &Graph, edges: &[u32]) -> Vec<LineId> {
    let pieces = (edges.iter()).flat_map(|&edge| &graph.edges[edge as usize].pieces);
    let mut lines: Vec<LineId> = pieces.map(|piece| piece.line).collect();
    lines.sort_unstable();
    lines.dedup();
    lines
}

/// The lines in words. Bundles are long: three say enough.
fn named(graph: &Graph, lines: &[LineId]) -> String {
    let domain = graph.measure.domain;
    let mut words: Vec<String> = (lines.iter().take(3))
        .map(|&line| domain.words_for(line))
        .collect();
    if lines.len() > 3 {
        words.push(format!("{} more", lines.len() - 3));
    }
    words.join(", ")
}

fn feature(graph: &Graph, lines: &[LineId]) -> Option<u32> {
    let line = *lines.first()?;
    Some(graph.measure.domain.lines[line as usize].source)
}

fn projected(graph: &Graph, [x, y]: Xy) -> Option<Xy> {
    let origin_m = graph.measure.grid().origin_m;
    Some([x + origin_m[0], y + origin_m[1]])
}
