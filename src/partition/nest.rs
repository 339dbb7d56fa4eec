//! In which sub-domain an inner walk lies.

use crate::geometry::point::Point;
use crate::geometry::predicates::orient;
use crate::noding::arrangement::Arrangement;
use crate::partition::star::HalfEdge;
use std::cmp::Ordering;
use std::collections::BTreeSet;

/// An edge that crosses the sweep line, `a < b`; or a node, `a == b`.
#[derive(Clone, Copy, Debug)]
struct Strand {
    a: Point,
    b: Point,
    edge: u32,
}

/// From bottom to top along the sweep line. Strands that the line crosses at the same time meet at
/// most at their ends, so the one that begins later is clearly above or below the other.
impl Ord for Strand {
    fn cmp(&self, other: &Strand) -> Ordering {
        let height = match self.a.cmp(&other.a) {
            Ordering::Equal => orient(other.a, other.b, self.b),
            Ordering::Greater => orient(other.a, other.b, self.a),
            Ordering::Less => -orient(self.a, self.b, other.a),
        };
        height
            .cmp(&0)
            .then((self.a, self.b).cmp(&(other.a, other.b)))
    }
}

impl PartialOrd for Strand {
    fn partial_cmp(&self, other: &Strand) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Strand {
    fn eq(&self, other: &Strand) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Strand {}

/// For each of `points` (ascending), the half-edge directly below it, with the point on its left;
/// or `None` if there is none. They lie on no edge, but may be a node at which no edge ends in the
/// order of the points, as is the least node of an inner walk.
///
/// The sweep line runs through one point after the other in their order, by x and then y: as if it
/// leaned a little to the right at its foot. Vertical edges need no care then.
pub(super) fn halves_below(arrangement: &Arrangement, points: &[Point]) -> Vec<Option<HalfEdge>> {
    let strand = |edge: u32| {
        let [a, b] = arrangement.edges[edge as usize].map(|node| arrangement.points[node as usize]);
        Strand { a, b, edge }
    };
    let mut by_end: Vec<u32> = (0..arrangement.edges.len() as u32).collect();
    by_end.sort_by_key(|&edge| arrangement.edges[edge as usize][1]);
    let mut line = BTreeSet::new();
    let (mut begun, mut ended) = (0, 0);
    let mut below = Vec::with_capacity(points.len());
    for &at in points {
        // Nodes are sorted by their points.
        let node = arrangement.points.partition_point(|&it| it < at) as u32;
        while begun < arrangement.edges.len() && arrangement.edges[begun][0] < node {
            // All that ends up to where this one begins has to leave before it enters.
            let from = arrangement.edges[begun][0];
            ended = end_strands(arrangement, &by_end, ended, from + 1, &mut line);
            line.insert(strand(begun as u32));
            begun += 1;
        }
        let is_node = arrangement.points.get(node as usize) == Some(&at);
        let until = node + u32::from(is_node);
        ended = end_strands(arrangement, &by_end, ended, until, &mut line);
        let here = Strand {
            a: at,
            b: at,
            edge: 0,
        };
        let next = line.range(..here).next_back();
        below.push(next.map(|found| found.edge << 1));
    }
    below
}

/// Takes the edges that end before node `until` off the line; `by_end[..ended]` are off.
fn end_strands(
    arrangement: &Arrangement,
    by_end: &[u32],
    mut ended: usize,
    until: u32,
    line: &mut BTreeSet<Strand>,
) -> usize {
    while ended < by_end.len() && arrangement.edges[by_end[ended] as usize][1] < until {
        let edge = by_end[ended];
        let [a, b] = arrangement.edges[edge as usize].map(|node| arrangement.points[node as usize]);
        line.remove(&Strand { a, b, edge });
        ended += 1;
    }
    ended
}
