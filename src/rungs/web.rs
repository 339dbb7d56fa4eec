//! The faces of the arrangement as half-edges that can be split and bridged.
//!
//! Edge `e` has the half-edges `2 e`, from its first node to its second, and `2 e + 1`; the face is
//! on the left (de Berg and others, Computational Geometry, chapter 2).

use crate::geometry::point::Point;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::Partition;
use std::f64::consts::TAU;

/// No half-edge: the outside.
const NONE: u32 = u32::MAX;

/// Nodes, half-edges, and the walks around faces; the outside has no walks.
pub(super) struct Web {
    /// Nodes; new ones at the end.
    pub points: Vec<Point>,
    /// The node that each half-edge leaves.
    pub tail: Vec<u32>,
    /// The half-edge after each one on its walk.
    pub next: Vec<u32>,
    /// The half-edge before it.
    prev: Vec<u32>,
    /// The half-edges that leave each node, in no order.
    pub out: Vec<Vec<u32>>,
}

/// The room between two neighbouring half-edges at a node, as seen along a direction in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    /// The half-edge that leaves the node with the room on its left.
    pub out: u32,
    /// From `out` counter-clockwise to the direction, radians.
    pub before_rad: f64,
    /// From there to the other side of the room, radians.
    pub after_rad: f64,
}

/// What a split made.
pub(super) struct Split {
    pub node: u32,
    /// The new edge: the second part.
    pub second: u32,
    /// The half-edge that leaves the new node with the asked face on its left.
    pub after: u32,
}

impl Web {
    /// The walks of all sub-domains.
    pub fn of(arrangement: &Arrangement, partition: &Partition) -> Web {
        let halves = 2 * arrangement.edges.len();
        let mut web = Web {
            points: arrangement.points.clone(),
            tail: arrangement.edges.iter().flatten().copied().collect(),
            next: vec![NONE; halves],
            prev: vec![NONE; halves],
            out: vec![Vec::new(); arrangement.points.len()],
        };
        for half in 0..halves as u32 {
            web.out[web.tail[half as usize] as usize].push(half);
        }
        for walk in partition.subdomains.iter().flat_map(|it| &it.walks) {
            let mut halves: Vec<u32> = Vec::new();
            for &half_curve in walk {
                let curve = &partition.curves[(half_curve >> 1) as usize];
                let along = (curve.edges.iter().zip(&curve.nodes)).map(|(&edge, &from)| {
                    2 * edge + u32::from(web.tail[2 * edge as usize] != from)
                });
                match half_curve & 1 {
                    0 => halves.extend(along),
                    _ => halves.extend(along.rev().map(|half| half ^ 1)),
                }
            }
            for (k, &half) in halves.iter().enumerate() {
                web.link(half, halves[(k + 1) % halves.len()]);
            }
        }
        web
    }

    fn link(&mut self, half: u32, next: u32) {
        self.next[half as usize] = next;
        self.prev[next as usize] = half;
    }

    /// True if there is a face on the left.
    pub fn is_inside(&self, half: u32) -> bool {
        self.next[half as usize] != NONE
    }

    /// The node that `half` reaches.
    pub fn head(&self, half: u32) -> u32 {
        self.tail[(half ^ 1) as usize]
    }

    /// Its length, cells.
    pub fn length(&self, half: u32) -> f64 {
        let [a, b] = self.ends(half >> 1);
        a.distance(b)
    }

    /// The places of an edge's nodes.
    pub fn ends(&self, edge: u32) -> [Point; 2] {
        [0, 1].map(|k| self.points[self.tail[(2 * edge + k) as usize] as usize])
    }

    fn direction_rad(&self, half: u32) -> f64 {
        let [a, b] = [self.tail[half as usize], self.head(half)];
        direction_rad(self.points[a as usize], self.points[b as usize])
    }

    /// The angle of the face at the node that `half` leaves, radians, in (0, 2 pi].
    pub fn angle_rad(&self, half: u32) -> f64 {
        let before = self.prev[half as usize];
        turn_rad(self.direction_rad(half), self.direction_rad(before ^ 1))
    }

    /// From the direction of `half` counter-clockwise to that from `a` to `b`, radians.
    pub fn turn_from_rad(&self, half: u32, a: Point, b: Point) -> f64 {
        turn_rad(self.direction_rad(half), direction_rad(a, b))
    }

    /// The corner of a face at `node` that looks towards `to`.
    pub fn corner(&self, node: u32, to: Point) -> Option<Corner> {
        let at = self.points[node as usize];
        let mut around = self.out[node as usize].iter();
        around.find_map(|&out| {
            if !self.is_inside(out) {
                return None;
            }
            let before_rad = self.turn_from_rad(out, at, to);
            let after_rad = self.angle_rad(out) - before_rad;
            (after_rad > 0.0).then_some(Corner {
                out,
                before_rad,
                after_rad,
            })
        })
    }

    fn add_edge(&mut self, a: u32, b: u32) -> u32 {
        let edge = self.tail.len() as u32 / 2;
        self.tail.extend([a, b]);
        self.next.extend([NONE; 2]);
        self.prev.extend([NONE; 2]);
        self.out[a as usize].push(2 * edge);
        self.out[b as usize].push(2 * edge + 1);
        edge
    }

    /// Splits the edge of `half` at a new node. The edge keeps its first part.
    pub fn split(&mut self, half: u32, at: Point) -> Split {
        let (forth, back) = (half & !1, half | 1);
        let far = self.tail[back as usize];
        let (after_far, before_far) = (self.next[forth as usize], self.prev[back as usize]);
        let node = self.points.len() as u32;
        self.points.push(at);
        self.out.push(vec![back]);
        self.out[far as usize].retain(|&it| it != back);
        self.tail[back as usize] = node;
        let second = self.add_edge(node, far);
        let (second_forth, second_back) = (2 * second, 2 * second + 1);
        if after_far != NONE {
            self.link(forth, second_forth);
            // At a tip the walk turns back along the same edge.
            let next = if after_far == back {
                second_back
            } else {
                after_far
            };
            self.link(second_forth, next);
        }
        if before_far != NONE {
            if before_far != forth {
                self.link(before_far, second_back);
            }
            self.link(second_back, back);
        }
        let after = if half == forth { second_forth } else { back };
        Split {
            node,
            second,
            after,
        }
    }

    /// Adds an edge between the corners of a face that two half-edges leave.
    pub fn bridge(&mut self, from: u32, to: u32) {
        let (before_from, before_to) = (self.prev[from as usize], self.prev[to as usize]);
        let edge = self.add_edge(self.tail[from as usize], self.tail[to as usize]);
        self.link(before_from, 2 * edge);
        self.link(2 * edge, to);
        self.link(before_to, 2 * edge + 1);
        self.link(2 * edge + 1, from);
    }
}

fn direction_rad(a: Point, b: Point) -> f64 {
    let (dx, dy) = (
        i64::from(b.x) - i64::from(a.x),
        i64::from(b.y) - i64::from(a.y),
    );
    (dy as f64).atan2(dx as f64)
}

/// From one direction counter-clockwise to another, radians, in (0, 2 pi].
fn turn_rad(from: f64, to: f64) -> f64 {
    let turn = to - from;
    if turn <= 0.0 { turn + TAU } else { turn }
}
