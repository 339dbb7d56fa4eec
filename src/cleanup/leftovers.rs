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

/// True if all that is too short, too narrow or too sharp lies at these places, projected metres.
pub(super) fn are_only(graph: &Graph, left: &[Xy]) -> bool {
    let mut left = left.to_vec();
    left.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let same_m = graph.measure.grid().cell_m;
    let is_known = |at_m: Xy| {
        let from = left.partition_point(|it| it[0] < at_m[0] - same_m);
        (left[from..].iter())
            .take_while(|it| it[0] <= at_m[0] + same_m)
            .any(|it| (it[1] - at_m[1]).abs() <= same_m)
    };
    let edges_are = (graph.live().iter())
        .all(|&edge| !is_short(graph, edge) || is_known(projected(graph, middle(graph, edge))));
    let mut found = Vec::new();
    edges_are
        && (graph.all_nodes().iter()).all(|&node| {
            (gaps_at(graph, node, &mut found).iter()).all(|gap| is_known(projected(graph, gap.at)))
        })
        && (wedges(graph, SHARP_DEG, &graph.all_nodes()).iter())
            .all(|wedge| is_known(projected(graph, graph.metres(wedge.hub))))
}

fn is_short(graph: &Graph, edge: u32) -> bool {
    let (a, b) = graph.ends_m(edge);
    distance(a, b) < graph.measure.min_edge * graph.edges[edge as usize].size_m
}

fn middle(graph: &Graph, edge: u32) -> Xy {
    let (a, b) = graph.ends_m(edge);
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
}

fn short_edges(graph: &Graph) -> Vec<Finding> {
    let mut edges = graph.live();
    edges.retain(|&edge| is_short(graph, edge));
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
        at_m: Some(projected(graph, middle(graph, edge))),
    }
}

/// A node too near to an edge that is not its own.
struct Gap {
    node: u32,
    edge: u32,
    width_m: f64,
    /// Half way across, local metres.
    at: Xy,
}

fn gaps_at(graph: &Graph, node: u32, found: &mut Vec<u32>) -> Vec<Gap> {
    let limit_m = graph.measure.min_edge * graph.size_at_m(node);
    let limit = limit_m / graph.measure.grid().cell_m;
    (graph.index).edges_near(node, graph.point(node), limit, found);
    let gap = |&edge: &u32| {
        let limit_m = limit_m.min(graph.measure.min_edge * graph.edges[edge as usize].size_m);
        let width_m = gap_m(graph, node, edge).filter(|&it| it < limit_m)?;
        let ((a, b), at) = (graph.ends_m(edge), graph.metres(node));
        let t = to_segment(at, a, b).1;
        let foot = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
        Some(Gap {
            node,
            edge,
            width_m,
            at: [0.5 * (at[0] + foot[0]), 0.5 * (at[1] + foot[1])],
        })
    };
    found.iter().filter_map(gap).collect()
}

fn narrow_gaps(graph: &Graph) -> Vec<Finding> {
    let mut found = Vec::new();
    let mut gaps: Vec<Gap> = (graph.all_nodes().iter())
        .flat_map(|&node| gaps_at(graph, node, &mut found))
        .collect();
    gaps.sort_by_key(|it| (graph.point(it.node), ends_in_order(graph, it.edge)));
    let finding = |gap: &Gap| {
        let [ours, theirs] =
            [&graph.star[gap.node as usize][..], &[gap.edge]].map(|it| lines_of(graph, it));
        Finding {
            what: "narrow-gap",
            text: format!(
                "A gap of {:.3} m remains between {} and {}; closing it would move a line beyond \
                 its tolerance, or close a passage.",
                gap.width_m,
                named(graph, &ours),
                named(graph, &theirs)
            ),
            feature: feature(graph, &ours),
            at_m: Some(projected(graph, gap.at)),
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
            at_m: Some(projected(graph, graph.metres(wedge.hub))),
        }
    };
    sharp.iter().map(finding).collect()
}

/// The lines on some edges, each once.
fn lines_of(graph: &Graph, edges: &[u32]) -> Vec<LineId> {
    let pieces = (edges.iter()).flat_map(|&edge| &graph.pieces[edge as usize]);
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

fn projected(graph: &Graph, [x, y]: Xy) -> Xy {
    let origin_m = graph.measure.grid().origin_m;
    [x + origin_m[0], y + origin_m[1]]
}
