//! How far a stretch of an input line is from the edge that represents it.

use crate::cleanup::Options;
use crate::cleanup::rules::PRIORITY_MAX;
use crate::cleanup::rules::Rule;
use crate::cleanup::rules::SmallLoops;
use crate::cleanup::steps::Step;
use crate::domain::line::Domain;
use crate::domain::line::LineId;
use crate::domain::line::Role;
use crate::domain::size::SizeWish;
use crate::geometry::grid::Grid;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::noding::arrangement::Piece;
use std::iter::once;

/// The input lines with their stations, sizes, ranks and tolerances, in metres.
pub struct Measure<'a> {
    pub(super) domain: &'a Domain,
    /// The vertices of all lines: those of lines that begin near each other are near each other, as they are read by
    /// turns.
    vertices: Vec<Vertex>,
    courses: Vec<Course>,
    /// Wished edge length along each line.
    pub(super) size_m: Vec<f64>,
    /// Who stays where it is when two lines meet: the higher one. Rings before held lines before
    /// others, then by priority, long before short.
    pub(super) rank: Vec<f64>,
    /// Lines that stay loops however small they are.
    keeps_loops: Vec<bool>,
    /// Least length of an edge, in wished sizes.
    pub(super) min_edge: f64,
    /// A line turns at a corner if its direction changes by more than this, degrees.
    pub(super) corner_deg: f64,
    without: Vec<Step>,
    /// Wished edge length where no line says otherwise.
    pub(super) default_m: f64,
}

/// What is looked up for a line whenever a stretch of it is measured.
#[derive(Clone, Copy, Debug, Default)]
struct Course {
    /// Its vertices.
    from: u32,
    until: u32,
    /// How far it may be from its edges.
    tolerance_m: f64,
}

/// A vertex of an input line; together, as they are always read together.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    /// Way along the line, metres.
    station_m: f64,
    at: Xy,
}

/// Distances to one place, found in two ways, differ by less than this, metres.
pub(super) const ROUNDING_M: f64 = 1e-6;

/// Of the tolerance, that is a quarter of the size: what 99 % of the lines are to stay within.
pub(super) const NEAR: f64 = 0.5;

/// Added to the rank of rings.
pub(super) const RIM_RANK: f64 = 1e13;
/// Added to the rank of held lines.
const HOLD_RANK: f64 = 1e12;
/// A node this near to a corner of its line, along the line, stands for it, mesh sizes.
const AT_CORNER: f64 = 0.1;
/// What one step of priority counts: more than any line is long, metres.
pub(super) const PRIORITY_RANK: f64 = 1e9;

impl<'a> Measure<'a> {
    /// Measures the lines of a domain.
    pub fn new(domain: &'a Domain, sizes: &SizeWish, options: &Options) -> Measure<'a> {
        let mut made = Measure {
            domain,
            vertices: Vec::new(),
            courses: vec![Course::default(); domain.lines.len()],
            size_m: vec![0.0; domain.lines.len()],
            rank: vec![0.0; domain.lines.len()],
            keeps_loops: vec![false; domain.lines.len()],
            min_edge: options.min_edge,
            corner_deg: options.corner_deg,
            without: options.without.clone(),
            default_m: sizes.default_m,
        };
        for id in by_place(domain) {
            let line = &domain.lines[id];
            let stations = domain.stations_m(id as LineId);
            let length = *stations.last().expect("a line has two points");
            let from = made.vertices.len() as u32;
            let vertices = stations.iter().zip(&line.points);
            made.vertices
                .extend(vertices.map(|(&station_m, &p)| Vertex {
                    station_m,
                    at: domain.grid.local_m(p),
                }));
            let kind = usize::from(line.kind);
            made.courses[id] = Course {
                from,
                until: made.vertices.len() as u32,
                tolerance_m: options.tolerance_m(sizes, kind),
            };
            let rule = &options.by_kind[kind];
            made.size_m[id] = sizes.by_kind_m[kind];
            made.rank[id] = length + standing(line.role, rule);
            made.keeps_loops[id] = rule.small_loops == SmallLoops::Keep;
        }
        made
    }

    /// True if this step is not left out.
    pub(super) fn does(&self, step: Step) -> bool {
        !self.without.contains(&step)
    }

    /// How far a line may be from its edges.
    #[inline]
    pub(super) fn tolerance_m(&self, line: LineId) -> f64 {
        self.courses[line as usize].tolerance_m
    }

    /// False if no line may be moved at all.
    pub(super) fn allows_any(&self) -> bool {
        self.courses.iter().any(|it| it.tolerance_m > 0.0)
    }

    /// True if loops of this line must stay loops.
    pub(super) fn keeps_loops(&self, line: LineId) -> bool {
        self.keeps_loops[line as usize]
    }

    /// True if two edges with these pieces, both away from one node, may not fall onto each other:
    /// a closed line that is to be kept would lose its inside there.
    pub(super) fn would_flatten(&self, pieces: &[Piece], others: &[Piece]) -> bool {
        let is_forward = |piece: &Piece| piece.from_m < piece.to_m;
        pieces.iter().any(|piece| {
            self.keeps_loops(piece.line)
                && self.is_closed(piece.line)
                && (others.iter())
                    .any(|it| it.line == piece.line && is_forward(it) != is_forward(piece))
        })
    }

    /// True if a line ends where it starts.
    pub(super) fn is_closed(&self, line: LineId) -> bool {
        let points = &self.domain.lines[line as usize].points;
        points.first() == points.last()
    }

    pub(super) fn grid(&self) -> &Grid {
        &self.domain.grid
    }

    pub(super) fn is_rim(&self, line: LineId) -> bool {
        self.domain.lines[line as usize].role != Role::Constraint
    }

    /// Of all lines.
    pub(super) fn vertices_len(&self) -> usize {
        self.vertices.len()
    }

    #[inline]
    fn vertices_of(&self, line: LineId) -> &[Vertex] {
        let Course { from, until, .. } = self.courses[line as usize];
        &self.vertices[from as usize..until as usize]
    }

    /// Length of a line as read, metres.
    pub(super) fn length_m(&self, line: LineId) -> f64 {
        self.vertices[self.courses[line as usize].until as usize - 1].station_m
    }

    /// The point of `line` at `station_m`.
    pub(super) fn point(&self, line: LineId, station_m: f64) -> Xy {
        let vertices = self.vertices_of(line);
        point_before(vertices, passed(vertices, station_m), station_m)
    }

    /// True if the line as read turns there at a corner: by more than the corner angle, between
    /// segments that are long enough to be edges, within [`AT_CORNER`] of the station.
    pub(super) fn is_corner(&self, line: LineId, station_m: f64) -> bool {
        let vertices = self.vertices_of(line);
        let last = vertices.len() - 1;
        let size_m = self.size_m[line as usize];
        let next = vertices.partition_point(|it| it.station_m < station_m);
        let next = next.min(last);
        let before = next.saturating_sub(1);
        let away = |k: usize| (vertices[k].station_m - station_m).abs();
        let k = if away(before) < away(next) {
            before
        } else {
            next
        };
        if away(k) > AT_CORNER * size_m {
            return false;
        }
        let (before, after) = match k {
            _ if 0 < k && k < last => (k - 1, k + 1),
            _ if self.is_closed(line) => (last - 1, 1),
            _ => return false,
        };
        let [a, o, b] = [before, k, after].map(|k| vertices[k].at);
        let least_m = self.min_edge * size_m;
        distance(a, o).min(distance(o, b)) >= least_m
            && 180.0 - between_deg(o, a, b) > self.corner_deg
    }

    /// Largest distance between the stretch and the edge `a b`, with the stretch's ends held
    /// against the edge's. It bounds the Hausdorff distance both ways: the edge is convex, so the
    /// stretch is farthest at a vertex; and between two ends that are near, the stretch passes
    /// over all of the edge.
    pub(super) fn deviation_m(&self, piece: &Piece, a: Xy, b: Xy) -> f64 {
        let ends = distance(self.point(piece.line, piece.from_m), a)
            .max(distance(self.point(piece.line, piece.to_m), b));
        let aside = self.vertices(piece).map(|p| to_segment(p, a, b).0);
        aside.fold(ends, f64::max)
    }

    /// True if [`Measure::deviation_m`] is at most `share` of the line's tolerance.
    pub(super) fn fits(&self, piece: &Piece, a: Xy, b: Xy, share: f64) -> bool {
        self.deviation_within_m(piece, a, b, share).is_some()
    }

    /// [`Measure::deviation_m`], if it is at most `share` of the line's tolerance.
    pub(super) fn deviation_within_m(
        &self,
        piece: &Piece,
        a: Xy,
        b: Xy,
        share: f64,
    ) -> Option<f64> {
        let limit = share * self.tolerance_m(piece.line);
        let vertices = self.vertices_of(piece.line);
        let (from, to) = ((piece.from_m, a), (piece.to_m, b));
        let (low, high) = match from.0 <= to.0 {
            true => (from, to),
            false => (to, from),
        };
        let near_m = |k: usize, (station_m, end): (f64, Xy)| {
            let away_m = distance(point_before(vertices, k, station_m), end);
            (away_m <= limit).then_some(away_m)
        };
        // one search, then along the line: this is asked most often of all
        let mut k = passed(vertices, low.0);
        let mut most_m = near_m(k, low)?;
        while k < vertices.len() && vertices[k].station_m < high.0 {
            let away_m = to_segment(vertices[k].at, a, b).0;
            if away_m > limit {
                return None;
            }
            most_m = most_m.max(away_m);
            k += 1;
        }
        // a vertex at the end belongs to it, as it does when its place is asked for
        k += usize::from(k < vertices.len() && vertices[k].station_m <= high.0);
        Some(most_m.max(near_m(k, high)?))
    }

    /// How much of a stretch is farther than [`NEAR`] of its tolerance from the edge `a b`, metres.
    pub(super) fn beyond_m(&self, piece: &Piece, a: Xy, b: Xy) -> f64 {
        // most are near from end to end
        match self.fits(piece, a, b, NEAR) {
            true => 0.0,
            false => self.parts_beyond_m(piece, a, b),
        }
    }

    /// The same of a stretch that is not near from end to end: by the middles of the quarters of its segments, as
    /// `audit` measures, but against this one edge. It is no less.
    pub(super) fn parts_beyond_m(&self, piece: &Piece, a: Xy, b: Xy) -> f64 {
        let limit_m = NEAR * self.tolerance_m(piece.line);
        let mut beyond_m = 0.0;
        let mut way = self.way(piece);
        let mut from = way.next().expect("a stretch has two ends");
        for to in way {
            let places = quarters(from, to).into_iter();
            let far = places.filter(|&p| to_segment(p, a, b).0 > limit_m);
            beyond_m += 0.25 * far.count() as f64 * distance(from, to);
            from = to;
        }
        beyond_m
    }

    /// The vertices of the line strictly inside the stretch, in the direction of the line.
    pub(super) fn vertices(&self, piece: &Piece) -> impl Iterator<Item = Xy> {
        let (low, high) = (piece.from_m.min(piece.to_m), piece.from_m.max(piece.to_m));
        let vertices = self.vertices_of(piece.line);
        let from = vertices.partition_point(|it| it.station_m <= low);
        (vertices[from..].iter())
            .take_while(move |it| it.station_m < high)
            .map(|it| it.at)
    }

    /// A stretch from end to end, in the direction of the line.
    pub(super) fn way(&self, piece: &Piece) -> impl Iterator<Item = Xy> {
        let (low, high) = (piece.from_m.min(piece.to_m), piece.from_m.max(piece.to_m));
        let [first, last] = [low, high].map(|station_m| self.point(piece.line, station_m));
        once(first).chain(self.vertices(piece)).chain(once(last))
    }

    /// The station between `low_m` and `high_m` whose point is nearest to `p`, and how far it is.
    pub(super) fn nearest(&self, line: LineId, low_m: f64, high_m: f64, p: Xy) -> (f64, f64) {
        let vertices = self.vertices_of(line);
        nearest_after(vertices, passed(vertices, low_m), [low_m, high_m], p)
    }

    /// The same of the part around `at_m` that reaches three times as far along the line as `p` is away from there; and
    /// whether there is such a part.
    pub(super) fn nearest_around(
        &self,
        line: LineId,
        at_m: f64,
        [low_m, high_m]: [f64; 2],
        p: Xy,
    ) -> (f64, f64, bool) {
        let vertices = self.vertices_of(line);
        let mut k = passed(vertices, at_m);
        let away_m = 3.0 * distance(point_before(vertices, k, at_m), p);
        let (from, to) = ((at_m - away_m).max(low_m), (at_m + away_m).min(high_m));
        // it begins a vertex or two back: no need to search again
        while k > 0 && vertices[k - 1].station_m > from {
            k -= 1;
        }
        let (station_m, least_m) = nearest_after(vertices, k, [from, to], p);
        (station_m, least_m, from < to)
    }

    /// The grid point nearest to `p`.
    pub(super) fn on_grid(&self, p: Xy) -> Point {
        let [x, y] = p.map(|v| (v / self.grid().cell_m).round() as i32);
        Point::new(x, y)
    }

    /// `p` in metres.
    #[inline]
    pub(super) fn metres(&self, p: Point) -> Xy {
        self.grid().local_m(p)
    }
}

/// All lines, those that begin near each other mostly near each other: by the bits of both coordinates in turn.
fn by_place(domain: &Domain) -> Vec<usize> {
    const MASKS: [(u32, u64); 5] = [
        (16, 0x0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555),
    ];
    let spread = |v: i32| {
        let above_zero = (i64::from(v) - i64::from(i32::MIN)) as u64;
        MASKS.iter().fold(above_zero, |bits, (shift, mask)| {
            (bits | bits << shift) & mask
        })
    };
    let place = |p: Point| spread(p.x) << 1 | spread(p.y);
    let all = domain.lines.iter().map(|line| place(line.points[0]));
    let mut order: Vec<(u64, usize)> = all.zip(0..).collect();
    order.sort_unstable();
    order.into_iter().map(|it| it.1).collect()
}

/// How many of these vertices a station has passed.
#[inline]
fn passed(vertices: &[Vertex], station_m: f64) -> usize {
    vertices.partition_point(|it| it.station_m <= station_m)
}

/// The point at a station that has passed `k` vertices.
#[inline]
fn point_before(vertices: &[Vertex], k: usize, station_m: f64) -> Xy {
    let k = k.clamp(1, vertices.len() - 1);
    between(vertices[k - 1], vertices[k], station_m)
}

/// [`Measure::nearest`], where `low_m` has passed `k` vertices.
fn nearest_after(vertices: &[Vertex], k: usize, [low_m, high_m]: [f64; 2], p: Xy) -> (f64, f64) {
    let mut k = k.clamp(1, vertices.len() - 1) - 1;
    let mut best = (low_m, f64::INFINITY);
    while k + 1 < vertices.len() && vertices[k].station_m < high_m {
        let (one, next) = (vertices[k], vertices[k + 1]);
        let (from, to) = (one.station_m.max(low_m), next.station_m.min(high_m));
        let (a, b) = (between(one, next, from), between(one, next, to));
        let (away, t) = to_segment(p, a, b);
        if away < best.1 {
            best = (from + t * (to - from), away);
        }
        k += 1;
    }
    best
}

/// The point at a station between two vertices.
#[inline]
fn between(one: Vertex, next: Vertex, station_m: f64) -> Xy {
    let t = ((station_m - one.station_m) / (next.station_m - one.station_m)).clamp(0.0, 1.0);
    [0, 1].map(|k| one.at[k] + t * (next.at[k] - one.at[k]))
}

/// The middles of the quarters of a segment. The distance to an edge is convex along it: they are fine enough.
#[inline]
pub(super) fn quarters(u: Xy, v: Xy) -> [Xy; 4] {
    [0.125, 0.375, 0.625, 0.875].map(|t| [0, 1].map(|k| u[k] + t * (v[k] - u[k])))
}

/// What a line's role and rule add to its rank. Never negative.
fn standing(role: Role, rule: &Rule) -> f64 {
    let rim = if role == Role::Constraint {
        0.0
    } else {
        RIM_RANK
    };
    let held = if rule.hold_m.is_some() {
        HOLD_RANK
    } else {
        0.0
    };
    let priority = (rule.priority + PRIORITY_MAX).clamp(0, 2 * PRIORITY_MAX);
    rim + held + PRIORITY_RANK * f64::from(priority)
}

/// False if the angle between the directions from `o` to `a` and to `b` is surely not below the one
/// with this tangent. Most are not, and need no arc tangent.
pub(super) fn may_be_below(o: Xy, a: Xy, b: Xy, tangent: f64) -> bool {
    let (u, v) = ([a[0] - o[0], a[1] - o[1]], [b[0] - o[0], b[1] - o[1]]);
    let (cross, dot) = (u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]);
    cross.abs() <= 1.000_001 * tangent * dot
}

/// The angle between the directions from `o` to `a` and to `b`, degrees, up to 180.
pub(super) fn between_deg(o: Xy, a: Xy, b: Xy) -> f64 {
    let (u, v) = ([a[0] - o[0], a[1] - o[1]], [b[0] - o[0], b[1] - o[1]]);
    let (cross, dot) = (u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]);
    cross.abs().atan2(dot).to_degrees()
}

/// Distance between two positions, metres.
#[inline]
pub(super) fn distance(a: Xy, b: Xy) -> f64 {
    distance_m2(a, b).sqrt()
}

/// Its square, square metres.
#[inline]
fn distance_m2(a: Xy, b: Xy) -> f64 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    dx * dx + dy * dy
}

/// Distance of `p` from the segment `a b`, and where the nearest point lies on it, in 0..1.
#[inline]
pub(super) fn to_segment(p: Xy, a: Xy, b: Xy) -> (f64, f64) {
    let (away_m2, t) = to_segment_m2(p, a, b);
    (away_m2.sqrt(), t)
}

/// The same with the square of the distance.
#[inline]
pub(super) fn to_segment_m2(p: Xy, a: Xy, b: Xy) -> (f64, f64) {
    let (ux, uy) = (b[0] - a[0], b[1] - a[1]);
    let length2 = ux * ux + uy * uy;
    let t = if length2 > 0.0 {
        (((p[0] - a[0]) * ux + (p[1] - a[1]) * uy) / length2).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (distance_m2(p, [a[0] + t * ux, a[1] + t * uy]), t)
}
