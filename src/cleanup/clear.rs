//! Is the way free? The exact test behind every operation: nothing may be crossed or swept over.

use smallvec::SmallVec;

use crate::cleanup::graph::Graph;
use crate::cleanup::measure::to_segment;
use crate::geometry::point::Point;
use crate::geometry::predicates::on_segment;
use crate::geometry::predicates::orient;

/// An edge that changes its place, and all that it sweeps on its way.
pub(super) struct Sweep {
    /// The swept triangle; its first two corners are the long side that is searched around.
    pub(super) triangle: [Point; 3],
    /// Where edges will be: these may not touch any other.
    pub(super) fresh: SmallVec<[(Point, Point); 2]>,
}

/// What makes room for a sweep, and what may not be in its way.
pub(super) struct Room<'a> {
    /// Edges that leave.
    pub(super) gone: &'a [u32],
    /// A node that leaves its place.
    pub(super) mover: Option<Point>,
    /// A corner of the triangle that must not hold a node yet.
    pub(super) vacant: Option<Point>,
}

impl Graph<'_> {
    /// True if `v` can go to `p` with its edges to these ends, all of its neighbours but one that may be at `p`, and
    /// loses the others. `vacant`: `p`, if no node may be there.
    ///
    /// It is enough that no edge touches the way of `v` itself, and that the triangles which its edges sweep hold no
    /// node. For what touches a new edge from outside comes into its triangle there; it cannot leave it by the old
    /// edge, which nothing crosses, nor end in it, so that it leaves by the way of `v`.
    pub(super) fn star_is_clear(
        &self,
        v: u32,
        p: Point,
        ends: &[u32],
        vacant: Option<Point>,
    ) -> bool {
        let q = self.point(v);
        let is_met = self.index.any_at([q, p, p], 0.0, |held| {
            let [s, t] = held.at();
            !held.ends.contains(&v) && touches(q, p, s, t)
        });
        !is_met
            && ends.iter().all(|&end| {
                let end = self.point(end);
                !on_segment(q, p, end) && !self.holds_node([q, end, p], vacant)
            })
    }

    /// True if a node lies in the closed triangle, other than at its corners, or at one that is to be vacant.
    fn holds_node(&self, triangle: [Point; 3], vacant: Option<Point>) -> bool {
        let [a, b, c] = triangle;
        let is_in = |at: Point| match triangle.contains(&at) {
            true => vacant == Some(at),
            false => in_triangle(at, triangle),
        };
        self.index.any_node_at(triangle, height(a, b, c), is_in)
    }

    /// True if the sweeps meet no node and their fresh segments no edge. Equal edges do not count:
    /// they will take up the fresh one.
    ///
    /// This keeps the graph planar, and in the same order around each node: an edge that does not
    /// cross the old segment, nor the new one, nor has an end in between, is not passed.
    pub(super) fn is_clear(&self, sweeps: &[Sweep], room: &Room) -> bool {
        sweeps.iter().all(|sweep| {
            let [a, b, c] = sweep.triangle;
            let wide = orient(a, b, c);
            let (low, high) = (wide.min(0), wide.max(0));
            let blocks = |end: u32| !room.allows(sweep.triangle, self.point(end));
            let ends_of = |&edge: &u32| self.edges[edge as usize].ends;
            if room.gone.iter().flat_map(ends_of).any(blocks) {
                return false;
            }
            !self.index.any_at([a, b, c], height(a, b, c), |held| {
                // most that come so near are those that leave
                if room.gone.contains(&held.edge) {
                    return false;
                }
                let [p, q] = held.at();
                // the triangle lies in the strip along its long side, most edges beside that
                let (s, t) = (orient(a, b, p), orient(a, b, q));
                if (s.max(t) < low) | (s.min(t) > high) {
                    return false;
                }
                let is_allowed = room.allows(sweep.triangle, p)
                    && room.allows(sweep.triangle, q)
                    && (sweep.fresh.iter()).all(|&(u, v)| !touches(u, v, p, q));
                !is_allowed
            })
        })
    }
}

impl Room<'_> {
    fn allows(&self, triangle: [Point; 3], end: Point) -> bool {
        if Some(end) == self.mover {
            return true;
        }
        if triangle.contains(&end) {
            return self.vacant != Some(end);
        }
        // most ends are told by the bounding box
        !in_triangle(end, triangle)
    }
}

/// Distance of `c` from the segment `a b`, in cells.
fn height(a: Point, b: Point, c: Point) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| [f64::from(p.x), f64::from(p.y)]);
    to_segment(c, a, b).0
}

/// True if `p` lies in the closed triangle, of whatever orientation, flat ones included.
fn in_triangle(p: Point, [a, b, c]: [Point; 3]) -> bool {
    let within = |v: i32, u: i32, w: i32, x: i32| u.min(w).min(x) <= v && v <= u.max(w).max(x);
    if !within(p.x, a.x, b.x, c.x) || !within(p.y, a.y, b.y, c.y) {
        return false;
    }
    let sides = [orient(a, b, p), orient(b, c, p), orient(c, a, p)];
    sides.iter().all(|&side| side >= 0) || sides.iter().all(|&side| side <= 0)
}

/// True if the segments `a b` and `c d` have a point in common other than an end of both. Equal
/// segments do not touch.
pub(super) fn touches(a: Point, b: Point, c: Point, d: Point) -> bool {
    if are_apart([a, b], [c, d]) {
        return false;
    }
    match (a == c, a == d, b == c, b == d) {
        (true, _, _, true) | (_, true, true, _) => false,
        (true, ..) => overlap(a, b, d),
        (_, true, ..) => overlap(a, b, c),
        (_, _, true, _) => overlap(b, a, d),
        (.., true) => overlap(b, a, c),
        _ => meet(a, b, c, d),
    }
}

/// True if one of the segments `hub u` and `hub v` lies on the other.
fn overlap(hub: Point, u: Point, v: Point) -> bool {
    on_segment(hub, u, v) || on_segment(hub, v, u)
}

/// True if the bounding boxes have no point in common.
#[inline]
fn are_apart([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    (a.x.max(b.x) < c.x.min(d.x))
        | (a.y.max(b.y) < c.y.min(d.y))
        | (c.x.max(d.x) < a.x.min(b.x))
        | (c.y.max(d.y) < a.y.min(b.y))
}

/// True if the closed segments, whose boxes meet, have a common point.
fn meet(a: Point, b: Point, c: Point, d: Point) -> bool {
    // on one line, overlapping boxes are overlapping segments
    let sides = |p: Point, q: Point, r: Point, s: Point| {
        orient(p, q, r).signum() * orient(p, q, s).signum()
    };
    sides(a, b, c, d) <= 0 && sides(c, d, a, b) <= 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cleanup::Measure;
    use crate::cleanup::Options;
    use crate::cleanup::SHORTEST;
    use crate::cleanup::Tolerance;
    use crate::cleanup::rules::Rule;
    use crate::domain::line::Domain;
    use crate::domain::line::Line;
    use crate::domain::line::Role;
    use crate::domain::size::SizeWish;
    use crate::geometry::grid::Grid;
    use crate::noding;
    use proptest::prelude::*;

    /// Lines of two points each in a square, on a grid of 1 m.
    fn domain(lines: &[[i32; 4]]) -> Domain {
        let line = |role: Role, points: Vec<Point>| Line {
            source: 0,
            role,
            kind: 0,
            name: String::new(),
            points,
        };
        let ring = [(-1, -1), (13, -1), (13, 13), (-1, 13), (-1, -1)];
        let ring = ring.map(|(x, y)| Point::new(x, y)).to_vec();
        let mut all = vec![line(Role::Boundary, ring)];
        all.extend(
            lines
                .iter()
                .filter(|[x, y, u, v]| (x, y) != (u, v))
                .map(|&[x, y, u, v]| {
                    line(Role::Constraint, vec![Point::new(x, y), Point::new(u, v)])
                }),
        );
        Domain {
            grid: Grid {
                origin_m: [0.0, 0.0],
                cell_m: 1.0,
            },
            epsg: None,
            kinds: vec![String::new()],
            lines: all,
            digest: 0,
        }
    }

    /// No other node in a swept triangle, no edge that stays touched by a new one or by the way: all pairs.
    fn slow(graph: &Graph, v: u32, p: Point) -> bool {
        let q = graph.point(v);
        let stays = |edge: &u32| !graph.edges[*edge as usize].ends.contains(&v);
        let all = graph.live();
        let others = graph.all_nodes().into_iter().filter(|&node| node != v);
        let others: Vec<Point> = others.map(|node| graph.point(node)).collect();
        let at = |edge: u32| {
            graph.edges[edge as usize]
                .ends
                .map(|node| graph.point(node))
        };
        !others.contains(&p)
            && graph.neighbours(v).iter().all(|&end| {
                let end = graph.point(end);
                let is_swept = |&it: &Point| it != end && in_triangle(it, [q, end, p]);
                let is_touched = |edge: &u32| {
                    let [s, t] = at(*edge);
                    touches(p, end, s, t) || touches(q, p, s, t)
                };
                !on_segment(q, p, end)
                    && !others.iter().any(is_swept)
                    && !all.iter().filter(|edge| stays(edge)).any(is_touched)
            })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn a_star_is_clear_as_all_pairs_tell(
            lines in prop::collection::vec(prop::array::uniform4(0..13), 1..9),
            by in [-4..5, -4..5],
        ) {
            let domain = domain(&lines);
            let sizes = SizeWish {
                default_m: 4.0,
                by_kind_m: vec![4.0],
                rows_by_kind: vec![1],
            };
            let options = Options {
                tolerance: Tolerance::ShareOfSize(0.5),
                by_kind: vec![Rule::FREE],
                min_edge: SHORTEST,
                left: None,
                corner_deg: 30.0,
                without: Vec::new(),
            };
            let noded = noding::node(&domain, &noding::Options { tile_cells: 1 << 20 });
            let (arrangement, _) = noding::clip(&domain, noded);
            let measure = Measure::new(&domain, &sizes, &options);
            let mut graph = Graph::new(&arrangement, &measure);
            graph.take_nodes();
            for v in graph.all_nodes() {
                let q = graph.point(v);
                let p = Point::new(q.x + by[0], q.y + by[1]);
                if p != q {
                    let ends = graph.neighbours(v);
                    let told = graph.star_is_clear(v, p, &ends, Some(p));
                    prop_assert_eq!(told, slow(&graph, v, p), "{:?} to {:?}", q, p);
                }
            }
        }
    }
}
