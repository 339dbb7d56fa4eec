//! How often boundary and hole rings wind around the left and the right side of each edge.

use crate::domain::line::Domain;
use crate::domain::line::Role;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::Piece;
use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::ops::Range;

/// Winding numbers of a place: of the boundary rings, of the hole rings.
type Winding = [i32; 2];

/// The edges of rings, in the orders in which a line that sweeps north meets them.
///
/// Its status holds those that it is at, west to east, each with the winding numbers of its east
/// side; the middle of an edge finds those of the face beside it at its neighbour in the west.
/// Exact: edges do not cross, so their order never changes while they are in the status, and all
/// comparisons are in doubled grid coordinates.
pub struct Rings {
    /// Of each edge of the arrangement.
    net: Vec<Winding>,
    /// Edges that are not level, by where they start and end.
    starts: Vec<(Span, Winding)>,
    ends: Vec<Span>,
}

impl Rings {
    /// O(edges + ring edges log(ring edges)).
    pub fn of(domain: &Domain, arrangement: &Arrangement) -> Rings {
        let edges = 0..arrangement.edges.len() as u32;
        let net = edges.map(|edge| net_winding(domain, arrangement.pieces_of(edge)));
        let net: Vec<Winding> = net.collect();
        let of_rings = (0..).zip(&net).filter(|(_, net)| **net != [0, 0]);
        let mut starts: Vec<(Span, Winding)> = of_rings
            .map(|(edge, &net)| (span(arrangement, edge), net))
            .filter(|(span, _)| !span.is_level())
            .collect();
        starts.sort_unstable_by(|(s, _), (t, _)| s.start_order(t));
        let mut ends: Vec<Span> = starts.iter().map(|(span, _)| *span).collect();
        ends.sort_unstable_by_key(|span| span.high.y);
        Rings { net, starts, ends }
    }

    /// Whether the left and the right side of each of `edges` lie inside the domain: within a
    /// boundary polygon and in no hole polygon. The edges of an arrangement can be asked for in
    /// parts: each sweep is one of its own. O((edges + ring edges) log(ring edges)).
    pub fn sides_inside(&self, arrangement: &Arrangement, edges: Range<u32>) -> Vec<[bool; 2]> {
        let mut sweep = Sweep::over(self);
        let first = edges.start;
        let mut inside = vec![[false; 2]; edges.len()];
        let middle = |edge: u32| (span(arrangement, edge).middle().y, edge);
        let mut by_middle: Vec<(i64, u32)> = edges.map(middle).collect();
        by_middle.sort_unstable();
        for (y, edge) in by_middle {
            let span = span(arrangement, edge);
            sweep.advance(y);
            let beside = sweep.west_of(&Span::at(span.middle()));
            inside[(edge - first) as usize] = sides(beside, span, self.net[edge as usize]);
        }
        inside
    }
}

/// An edge of the arrangement as the sweep sees it.
fn span(arrangement: &Arrangement, edge: u32) -> Span {
    let ends = arrangement.edges[edge as usize];
    Span::between(ends.map(|node| doubled(arrangement, node)))
}

/// The sweep line.
struct Sweep<'a> {
    rings: &'a Rings,
    started: usize,
    ended: usize,
    /// Edges that the line meets (just north of itself), each with the winding of its east side.
    status: BTreeMap<Span, Winding>,
}

impl Sweep<'_> {
    fn over(rings: &Rings) -> Sweep<'_> {
        Sweep {
            rings,
            started: 0,
            ended: 0,
            status: BTreeMap::new(),
        }
    }

    /// Moves the line to just north of `y`.
    fn advance(&mut self, y: i64) {
        while let Some(&(start, net)) = self.rings.starts.get(self.started)
            && start.low.y <= y
        {
            self.drop_until(start.low.y);
            let west = self.west_of(&start);
            let east = plus(west, if start.rises { -1 } else { 1 }, net);
            self.status.insert(start, east);
            self.started += 1;
        }
        self.drop_until(y);
    }

    /// Drops edges that end at `y` or before: what ends at a level goes before what starts there.
    fn drop_until(&mut self, y: i64) {
        while let Some(end) = self.rings.ends.get(self.ended)
            && end.high.y <= y
        {
            self.status.remove(end);
            self.ended += 1;
        }
    }

    /// The winding between `span` and the ring edge in its west; the far west is outside.
    fn west_of(&self, span: &Span) -> Winding {
        (self.status.range(..=*span).next_back()).map_or([0, 0], |(_, east)| *east)
    }
}

/// From the winding just east of an edge (just north of a level one) to both its sides.
fn sides(beside: Winding, span: Span, net: Winding) -> [bool; 2] {
    let is_inside = |[boundary, hole]: Winding| boundary > 0 && hole <= 0;
    if span.rises {
        [is_inside(plus(beside, 1, net)), is_inside(beside)]
    } else {
        [is_inside(beside), is_inside(plus(beside, -1, net))]
    }
}

/// By how much the winding on the left of an edge exceeds that on its right.
fn net_winding(domain: &Domain, pieces: &[Piece]) -> Winding {
    let mut net = [0, 0];
    for piece in pieces {
        let forward = if piece.from_m < piece.to_m { 1 } else { -1 };
        match domain.lines[piece.line as usize].role {
            Role::Constraint => {}
            Role::Boundary => net[0] += forward,
            Role::Hole => net[1] += forward,
        }
    }
    net
}

fn plus(winding: Winding, sign: i32, net: Winding) -> Winding {
    [winding[0] + sign * net[0], winding[1] + sign * net[1]]
}

/// A position in half cells.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Half {
    x: i64,
    y: i64,
}

fn doubled(arrangement: &Arrangement, node: u32) -> Half {
    let p = arrangement.points[node as usize];
    Half {
        x: 2 * i64::from(p.x),
        y: 2 * i64::from(p.y),
    }
}

/// An edge as the sweep sees it, or (`low == high`) a position that asks for its neighbours.
#[derive(Clone, Copy)]
struct Span {
    low: Half,
    high: Half,
    /// True if the edge's second node is north of its first.
    rises: bool,
}

impl Span {
    fn between([a, b]: [Half; 2]) -> Span {
        let rises = a.y < b.y;
        let (low, high) = if rises { (a, b) } else { (b, a) };
        Span { low, high, rises }
    }

    fn at(place: Half) -> Span {
        Span::between([place, place])
    }

    fn is_level(&self) -> bool {
        self.low.y == self.high.y
    }

    fn middle(&self) -> Half {
        Half {
            x: (self.low.x + self.high.x) / 2,
            y: (self.low.y + self.high.y) / 2,
        }
    }

    /// Where `place` lies from the span: `Less` is west of it. Half the direction (up to 2^30)
    /// times a difference in half cells (up to 2^31): exact in i64.
    fn side(&self, place: Half) -> Ordering {
        let (dx, dy) = (
            (self.high.x - self.low.x) / 2,
            (self.high.y - self.low.y) / 2,
        );
        let left = dx * (place.y - self.low.y) - dy * (place.x - self.low.x);
        0.cmp(&left)
    }

    /// By the south end, south to north and west to east; then by direction, west to east.
    fn start_order(&self, other: &Span) -> Ordering {
        (self.low.y.cmp(&other.low.y))
            .then(self.low.x.cmp(&other.low.x))
            .then_with(|| self.cmp(other))
    }
}

/// West to east, among spans that a common level meets and that do not cross.
impl Ord for Span {
    fn cmp(&self, other: &Span) -> Ordering {
        if self.low.y < other.low.y || other.is_level() && !self.is_level() {
            return other.cmp(self).reverse();
        }
        let first = other.side(self.low);
        if first != Ordering::Equal {
            return first;
        }
        if self.high.y <= other.high.y {
            other.side(self.high)
        } else {
            self.side(other.high).reverse()
        }
    }
}

impl PartialOrd for Span {
    fn partial_cmp(&self, other: &Span) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Span {
    fn eq(&self, other: &Span) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Span {}
