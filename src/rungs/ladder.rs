//! Rungs laid one by one, each only if it keeps the promises beside all before it.

use crate::geometry::point::Point;
use crate::geometry::predicates::orient;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::Piece;
use crate::partition::subdomains::Partition;
use crate::rungs::ANGLE_DEG;
use crate::rungs::AROUND;
use crate::rungs::CLEAR;
use crate::rungs::CORNERS;
use crate::rungs::LONG;
use crate::rungs::LONGEST_WALK;
use crate::rungs::ONE_ROW;
use crate::rungs::Options;
use crate::rungs::RUN_ON;
use crate::rungs::SHORTEST;
use crate::rungs::SMALL_WALK;
use crate::rungs::SNAP;
use crate::rungs::propose::Candidate;
use crate::rungs::propose::nearest;
use crate::rungs::web::Corner;
use crate::rungs::web::Web;
use crate::seams::clearance::Buckets;
use crate::seams::clearance::distance_between;
use rustc_hash::FxHashMap;
use std::f64::consts::PI;

/// An edge is split only if all edges that it does not touch are farther than this, cells: the
/// rounding of the new node bends it by less than one.
const SPLIT_CLEAR: f64 = 3.0;

/// The arrangement while rungs are laid.
pub(super) struct Ladder<'a> {
    pub arrangement: &'a Arrangement,
    pub web: Web,
    /// Edges of the arrangement as given, by place.
    pub walls: Buckets,
    /// Size at each edge as given, and its least at each node, cells.
    size_of: &'a [f64],
    size_at: Vec<f64>,
    /// The edge as given that each foot lies on, from the first node that was not given.
    split_at: Vec<u32>,
    options: Options,
    /// Ends of the rungs, and the rungs by place.
    laid: Vec<[u32; 2]>,
    placed: Buckets,
    /// All parts of the edges that were split.
    parts: FxHashMap<u32, Vec<u32>>,
}

/// Where a rung would end.
#[derive(Clone, Copy)]
enum Foot {
    /// At a node.
    Node(u32),
    /// Within an edge, which the half-edge has on the rung's side.
    Within(u32),
}

impl Foot {
    fn within(self) -> Option<u32> {
        match self {
            Foot::Node(_) => None,
            Foot::Within(half) => Some(half),
        }
    }
}

/// What became of a candidate.
#[derive(Clone, Copy, PartialEq)]
enum Laid {
    Now,
    /// Its only fault is that it would leave a small room odd.
    Later,
    Never,
}

/// A walk that a rung would close.
#[derive(Clone, Copy)]
struct Closed {
    /// Its angles at the rung, radians.
    ends: [f64; 2],
    /// What its first and its last half-edge have beyond the rung, cells.
    beyond: [f64; 2],
}

impl<'a> Ladder<'a> {
    pub fn new(
        arrangement: &'a Arrangement,
        partition: &Partition,
        size_of: &'a [f64],
        options: &Options,
    ) -> Ladder<'a> {
        let mut size_at = vec![f64::INFINITY; arrangement.points.len()];
        for (edge, &size) in arrangement.edges.iter().zip(size_of) {
            for &node in edge {
                size_at[node as usize] = size_at[node as usize].min(size);
            }
        }
        let largest = size_of.iter().copied().fold(1.0, f64::max);
        Ladder {
            arrangement,
            web: Web::of(arrangement, partition),
            walls: Buckets::of(arrangement, 2 * largest as i32),
            size_of,
            size_at,
            split_at: Vec::new(),
            options: *options,
            laid: Vec::new(),
            placed: Buckets::new(2 * largest as i32),
            parts: FxHashMap::default(),
        }
    }

    /// Number of rungs.
    pub fn rungs(&self) -> usize {
        self.laid.len()
    }

    /// Longest rung at a node, cells.
    pub fn reach(&self, node: u32) -> f64 {
        self.longest(node) * self.size_at[node as usize]
    }

    /// The same in sizes.
    fn longest(&self, node: u32) -> f64 {
        match self.split_edge(node) {
            Some(_) => RUN_ON.min(self.options.longest),
            None => self.options.longest,
        }
    }

    /// The edge as given that a foot has split.
    fn split_edge(&self, node: u32) -> Option<u32> {
        let foot = (node as usize).checked_sub(self.arrangement.points.len())?;
        Some(self.split_at[foot])
    }

    /// True if a node is an end of an edge as given, or a foot on it.
    pub fn is_at(&self, node: u32, edge: u32) -> bool {
        self.arrangement.edges[edge as usize].contains(&node) || self.split_edge(node) == Some(edge)
    }

    /// Lays the candidates that keep the promises, in order. Those that would leave a small room odd come
    /// again at the end: by then others may have made it even.
    pub fn lay_all(&mut self, candidates: Vec<Candidate>) {
        let mut late = Vec::new();
        for candidate in candidates {
            if self.lay(candidate) == Laid::Later {
                late.push(candidate);
            }
        }
        for candidate in late {
            self.lay(candidate);
        }
    }

    /// Lays the candidate's rung if it keeps the promises.
    fn lay(&mut self, candidate: Candidate) -> Laid {
        let Candidate { node, edge, .. } = candidate;
        let at = self.web.points[node as usize];
        let mut size = self.size_at[node as usize].min(self.size_of[edge as usize]);
        let mut longest = self.longest(node);
        let part = self.nearest_part(at, edge);
        let (to, foot) = self.foot(at, part, SNAP * size);
        if let Foot::Node(target) = foot {
            size = size.min(self.size_at[target as usize]);
            longest = longest.min(self.longest(target));
        }
        let length = at.distance(to);
        if length < SHORTEST * size || length > longest * size {
            return Laid::Never;
        }
        let Some(from) = self.roomy_corner(node, to) else {
            return Laid::Never;
        };
        let Some(into) = self.foot_corner(node, foot, to) else {
            return Laid::Never;
        };
        let tip = match length <= ONE_ROW * size {
            true => LONG * size,
            false => f64::INFINITY,
        };
        if !self.closes_blocks(&from, foot, to, &into, tip)
            || !self.is_clear(candidate, to, foot, size)
        {
            return Laid::Never;
        }
        if self.makes_odd(&from, foot, to, &into, size) {
            return Laid::Later;
        }
        let (target, into) = match foot {
            Foot::Node(target) => (target, into.out),
            Foot::Within(half) => {
                let split = self.web.split(half, to);
                let parts = self.parts.entry(edge).or_insert_with(|| vec![edge]);
                parts.push(split.second);
                self.split_at.push(edge);
                self.size_at.push(self.size_of[edge as usize]);
                (split.node, split.after)
            }
        };
        self.web.bridge(from.out, into);
        self.placed.insert(self.laid.len() as u32, [at, to]);
        self.laid.push([node, target]);
        Laid::Now
    }

    /// The part of an edge that is nearest to a point now.
    fn nearest_part(&self, at: Point, edge: u32) -> u32 {
        let whole = [edge];
        let parts = self.parts.get(&edge).map_or(&whole[..], Vec::as_slice);
        let distance2 = |part: u32| nearest(at, self.web.ends(part)).1;
        let best = parts
            .iter()
            .min_by(|&&p, &&q| distance2(p).total_cmp(&distance2(q)));
        *best.expect("an edge has a part")
    }

    /// The place on `edge` nearest to `at`, or an end of the edge that is within `snap` of it.
    fn foot(&self, at: Point, edge: u32, snap: f64) -> (Point, Foot) {
        let ends = self.web.ends(edge);
        let (foot, _) = nearest(at, ends);
        let far = ends.map(|end| end.distance(foot));
        let near = u32::from(far[1] < far[0]);
        if far[near as usize] >= snap {
            let is_right = orient(ends[0], ends[1], at) < 0;
            return (foot, Foot::Within(2 * edge + u32::from(is_right)));
        }
        let node = self.web.tail[(2 * edge + near) as usize];
        (ends[near as usize], Foot::Node(node))
    }

    /// The corner at `node` that looks towards `to`, if a rung leaves enough to both sides of it.
    fn roomy_corner(&self, node: u32, to: Point) -> Option<Corner> {
        let least = ANGLE_DEG.to_radians();
        self.web
            .corner(node, to)
            .filter(|it| it.before_rad.min(it.after_rad) >= least)
    }

    /// The corner at the other end. Within an edge it is made up: `out` is the half-edge itself.
    fn foot_corner(&self, node: u32, foot: Foot, to: Point) -> Option<Corner> {
        let at = self.web.points[node as usize];
        match foot {
            Foot::Node(target) => {
                let mut around = self.web.out[target as usize].iter();
                if around.any(|&half| self.web.head(half) == node) {
                    return None;
                }
                self.roomy_corner(target, at)
            }
            Foot::Within(half) => {
                let before_rad = self.web.turn_from_rad(half, to, at);
                let corner = Corner {
                    out: half,
                    before_rad,
                    after_rad: PI - before_rad,
                };
                let least = ANGLE_DEG.to_radians();
                let has_room = corner.before_rad.min(corner.after_rad) >= least;
                (has_room && self.web.is_inside(half)).then_some(corner)
            }
        }
    }

    /// True if the walks that the rung would close have corners enough, or if it joins two walks. A
    /// walk of three will do if its other sides are `tip` or longer.
    fn closes_blocks(&self, from: &Corner, foot: Foot, to: Point, into: &Corner, tip: f64) -> bool {
        let (stop, parts) = match foot {
            Foot::Node(_) => (into.out, [0.0; 2]),
            Foot::Within(half) => {
                let ends = self.web.ends(half >> 1);
                let behind = ends[(half & 1) as usize].distance(to);
                let next = self.web.next[half as usize];
                (next, [behind, self.web.length(half) - behind])
            }
        };
        let ahead = Closed {
            ends: [from.after_rad, into.before_rad],
            beyond: [parts[0], 0.0],
        };
        let back = Closed {
            ends: [from.before_rad, into.after_rad],
            beyond: [0.0, parts[1]],
        };
        self.is_block(into.out, from.out, ahead, tip) && self.is_block(from.out, stop, back, tip)
    }

    /// True if there are more small odd rooms with the rung than without it.
    fn makes_odd(&self, from: &Corner, foot: Foot, to: Point, into: &Corner, size: f64) -> bool {
        let around = AROUND * size;
        let rung = self.web.points[self.web.tail[from.out as usize] as usize].distance(to);
        let stop = match foot {
            Foot::Node(_) => into.out,
            Foot::Within(half) => self.web.next[half as usize],
        };
        let [ahead, back] = [(into.out, from.out), (from.out, stop)].map(|(first, stop)| {
            let edges = self.edges_of_small(first, stop, around - rung, foot.within(), to)?;
            Some(edges + 1)
        });
        let whole = self.edges_of_small(from.out, from.out, around, None, to);
        // on the other side of a slit is the same room again
        let across = (foot.within().map(|half| half ^ 1))
            .filter(|&half| self.web.is_inside(half) && !self.is_soon_after(half, from.out))
            .and_then(|half| self.edges_of_small(half, half, around, None, to));
        let odd = |edges: Option<usize>| i32::from(edges.is_some_and(|edges| edges % 2 == 1));
        let even = |edges: Option<usize>| i32::from(edges.is_some_and(|edges| edges % 2 == 0));
        odd(ahead) + odd(back) + even(across) > odd(whole) + odd(across)
    }

    /// Number of edges of a walk from the half-edge `first` until the one before `stop`, if they are few
    /// and together shorter than `around`; `cut`, the half-edge with the foot `to`, is there in part.
    fn edges_of_small(
        &self,
        first: u32,
        stop: u32,
        around: f64,
        cut: Option<u32>,
        to: Point,
    ) -> Option<usize> {
        let (mut half, mut total, mut also) = (first, 0.0, 0);
        for edges in 1..=SMALL_WALK {
            total += match cut == Some(half) {
                true => {
                    let [a, b] = self.web.ends(half >> 1).map(|end| end.distance(to));
                    // the walk leaves the foot along `first`, or comes to it
                    if (half == first) == (half & 1 == 0) {
                        b
                    } else {
                        a
                    }
                }
                false => self.web.length(half),
            };
            // the foot splits the other side of a slit, too
            also += usize::from(cut == Some(half ^ 1));
            if total >= around {
                return None;
            }
            half = self.web.next[half as usize];
            if half == stop {
                return Some(edges + also);
            }
        }
        None
    }

    /// True if the walk comes to `sought` within the length of a small one from `half` on.
    fn is_soon_after(&self, half: u32, sought: u32) -> bool {
        let walk = std::iter::successors(Some(half), |&it| Some(self.web.next[it as usize]));
        walk.take(SMALL_WALK).any(|it| it == sought)
    }

    /// Follows the walk from the half-edge `first` until the one before `stop`. One that comes back
    /// without meeting `stop` is another one than the rung's other end lies on: the rung joins the
    /// two.
    fn is_block(&self, first: u32, stop: u32, closed: Closed, tip: f64) -> bool {
        let flattest = PI - self.options.corner_deg.to_radians();
        let is_corner = |angle: f64| angle < flattest;
        let at_ends = (closed.ends.iter())
            .filter(|&&angle| is_corner(angle))
            .count();
        let mut corners = at_ends;
        let mut half = first;
        let mut side = self.web.length(first) - closed.beyond[0];
        let mut shortest = f64::INFINITY;
        for _ in 0..LONGEST_WALK {
            if corners >= CORNERS {
                return true;
            }
            half = self.web.next[half as usize];
            if half == stop {
                let shortest = shortest.min(side - closed.beyond[1]);
                return at_ends == 2 && corners + 1 == CORNERS && shortest >= tip;
            }
            if half == first {
                return true;
            }
            if is_corner(self.web.angle_rad(half)) {
                corners += 1;
                shortest = shortest.min(side);
                side = 0.0;
            }
            side += self.web.length(half);
        }
        false
    }

    /// True if the rung is far enough from all that it does not touch, and a split does no harm.
    fn is_clear(&self, candidate: Candidate, to: Point, foot: Foot, size: f64) -> bool {
        let Candidate { node, edge, .. } = candidate;
        let rung = [self.web.points[node as usize], to];
        let clear = CLEAR * size;
        let target = match foot {
            Foot::Node(target) => Some(target),
            Foot::Within(_) => None,
        };
        let splits = |wall: u32| target.is_none() && wall == edge;
        let ends = || [Some(node), target].into_iter().flatten();
        let is_apart = |others: [u32; 2]| {
            let there = others.map(|it| self.web.points[it as usize]);
            distance_between(rung, there) >= clear
        };
        let walls = self.walls.near(rung, clear).into_iter();
        let mut walls =
            walls.filter(|&wall| !splits(wall) && !ends().any(|end| self.is_at(end, wall)));
        let placed = self.placed.near(rung, clear).into_iter();
        let mut placed = placed.map(|it| self.laid[it as usize]);
        walls.all(|wall| is_apart(self.arrangement.edges[wall as usize]))
            && placed.all(|it| ends().any(|end| it.contains(&end)) || is_apart(it))
            && (target.is_some() || self.may_be_split(edge))
    }

    fn may_be_split(&self, edge: u32) -> bool {
        let nodes = self.arrangement.edges[edge as usize];
        let place = |nodes: [u32; 2]| nodes.map(|it| self.web.points[it as usize]);
        let near = self.walls.near(place(nodes), SPLIT_CLEAR);
        near.into_iter().all(|other| {
            let others = self.arrangement.edges[other as usize];
            others.iter().any(|it| nodes.contains(it))
                || distance_between(place(nodes), place(others)) >= SPLIT_CLEAR
        })
    }

    /// The arrangement with all that was laid.
    pub fn arrangement(&self) -> Arrangement {
        let given = self.arrangement;
        let mut edges: Vec<([u32; 2], Vec<Piece>)> =
            Vec::with_capacity(given.edges.len() + 2 * self.laid.len());
        for edge in 0..given.edges.len() as u32 {
            let Some(parts) = self.parts.get(&edge) else {
                let pieces = given.pieces_of(edge).to_vec();
                edges.push((given.edges[edge as usize], pieces));
                continue;
            };
            let [a, b] = given.edges[edge as usize].map(|it| self.web.points[it as usize]);
            for &part in parts {
                let ends = [0, 1].map(|k| {
                    let node = self.web.tail[(2 * part + k) as usize];
                    let p = self.web.points[node as usize];
                    (node, a.distance(p) / (a.distance(p) + b.distance(p)))
                });
                edges.push(given.part_of(edge, ends[0], ends[1]));
            }
        }
        edges.extend(self.laid.iter().map(|&nodes| (nodes, Vec::new())));
        Arrangement::from_parts(&self.web.points, edges)
    }
}
