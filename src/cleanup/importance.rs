//! Which of two nodes stays where it is.

use crate::cleanup::graph::Graph;
use crate::cleanup::measure::between_deg;
use crate::geometry::point::Point;

/// Compared field by field; the greater stays.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(super) struct Importance {
    /// A corner of the outline, or a place where it touches itself.
    pub(super) is_rim_corner: bool,
    /// Highest rank of the edges there.
    pub(super) rank: f64,
    /// 3 junction, 2 end, 1 corner, 0 on the way.
    pub(super) role: u8,
    /// Ties are broken by place.
    pub(super) at: Point,
}

impl Importance {
    pub(super) fn of(graph: &Graph, node: u32) -> Importance {
        let star = &graph.star[node as usize];
        let rank = star.iter().map(|&e| graph.edges[e as usize].rank);
        let turns =
            turn_deg(graph, node, |_| true).is_some_and(|turn| turn > graph.measure.corner_deg);
        Importance {
            is_rim_corner: is_rim_corner(graph, node),
            rank: rank.fold(0.0, f64::max),
            role: match star.len() {
                1 => 2,
                2 => u8::from(turns),
                _ => 3,
            },
            at: graph.point(node),
        }
    }
}

/// True at corners of the outline and where it touches itself.
pub(super) fn is_rim_corner(graph: &Graph, node: u32) -> bool {
    let star = &graph.star[node as usize];
    if !star.iter().any(|&e| graph.edges[e as usize].is_rim()) {
        return false;
    }
    let turn = turn_deg(graph, node, |e| graph.edges[e as usize].is_rim());
    turn.is_none_or(|turn| turn > graph.measure.corner_deg)
}

/// By how much the way over `node` along the edges that `counts` picks turns, degrees; `None`
/// unless they are two.
pub(super) fn turn_deg(graph: &Graph, node: u32, counts: impl Fn(u32) -> bool) -> Option<f64> {
    let mut picked = graph.star[node as usize]
        .iter()
        .copied()
        .filter(|&e| counts(e));
    let (e, f) = (picked.next()?, picked.next()?);
    if picked.next().is_some() {
        return None;
    }
    let [a, b] = [e, f].map(|edge| graph.metres(graph.edges[edge as usize].other(node)));
    Some(180.0 - between_deg(graph.metres(node), a, b))
}
