//! Regions that grow, freeze and shrink on the dual graph: the dual variables of the matching.
//!
//! A region starts as one odd node of radius 0. Its radius is a dual variable: how far the flood
//! has advanced from what was inside when the region began. A region made of others (a blossom)
//! floods on from their rims. All radii are linear in one common time, so that what happens next
//! is the earliest entry of one queue. Distances are in doubled weights; all times are whole.

use crate::parity::graph::Graph;
use crate::parity::graph::OUTSIDE;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// No region, no tree, no node.
pub const NONE: u32 = u32::MAX;
/// The mate of a region that is matched to the outside.
pub const OUTSIDE_MATE: u32 = u32::MAX - 1;
const NEVER: i64 = i64::MAX;

/// Two odd nodes whose floods meet: `from` in the region in question, `to` in the other one, or
/// [`OUTSIDE`]. The shortest path between them is as long as the radii between them sum to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    pub from: u32,
    pub to: u32,
}

impl Touch {
    pub fn reversed(self) -> Touch {
        Touch {
            from: self.to,
            to: self.from,
        }
    }
}

/// `at_zero + slope * time`; the slope is -1, 0 or 1.
#[derive(Clone, Copy, Debug)]
struct Radius {
    at_zero: i64,
    slope: i64,
}

impl Radius {
    fn value(self, time: i64) -> i64 {
        self.at_zero + self.slope * time
    }
}

/// The time at which something should be looked at, and the earliest queue entry for it: one entry
/// a thing suffices, late ones are postponed when they surface.
#[derive(Clone, Copy, Debug)]
struct Alarm {
    wanted: i64,
    queued: i64,
}

const NO_ALARM: Alarm = Alarm {
    wanted: NEVER,
    queued: NEVER,
};

/// What the flood knows of a node.
#[derive(Clone, Debug)]
struct Spot {
    /// The region that reached it, or NONE.
    region: u32,
    /// The outermost region around that.
    top: u32,
    /// The odd node that it was reached from.
    source: u32,
    /// Radius of `region` when it arrived.
    arrival: i64,
    /// Radii of the regions from `region` up to but without `top`, minus `arrival`.
    wrapped: i64,
    alarm: Alarm,
}

/// A member of a blossom's cycle and how it touches the next one.
#[derive(Clone, Copy, Debug)]
pub struct Member {
    pub region: u32,
    pub touch: Touch,
}

/// A region; see the head of this file.
#[derive(Clone, Debug)]
pub struct Region {
    radius: Radius,
    /// The blossom that it is a member of, or NONE.
    pub parent: u32,
    /// The odd cycle of a blossom; empty for the region of one odd node.
    pub members: Vec<Member>,
    /// Nodes that it reached itself, in order of arrival.
    pub shell: Vec<u32>,
    /// The region that it is matched to, OUTSIDE_MATE, or NONE.
    pub mate: u32,
    /// Where it touches its mate.
    pub mate_touch: Touch,
    /// Its node in an alternating tree, or NONE.
    pub tree: u32,
    /// False once a blossom was taken apart.
    pub alive: bool,
    alarm: Alarm,
}

/// What the matching must react to.
#[derive(Clone, Copy, Debug)]
pub enum Meeting {
    /// A growing region reached the outside.
    Outside { region: u32, touch: Touch },
    /// Two regions touch, at least one of them growing.
    Regions { a: u32, b: u32, touch: Touch },
    /// A shrinking region of one odd node is down to that node.
    Imploded { region: u32 },
    /// A shrinking blossom is down to its members.
    Shattered { region: u32 },
}

/// The flood.
pub struct Flood<'a> {
    graph: &'a Graph,
    spots: Vec<Spot>,
    pub regions: Vec<Region>,
    /// Entries (time, kind, id); kind 0 is a node, 1 a shrinking region.
    queue: BinaryHeap<Reverse<(i64, u8, u32)>>,
    now: i64,
    /// Queue entries handled.
    pub events: u64,
}

impl<'a> Flood<'a> {
    /// A growing region of radius 0 at each odd node; region `k` is that of the k-th odd node.
    pub fn new(graph: &'a Graph) -> Flood<'a> {
        let spot = Spot {
            region: NONE,
            top: NONE,
            source: NONE,
            arrival: 0,
            wrapped: 0,
            alarm: NO_ALARM,
        };
        let mut flood = Flood {
            graph,
            spots: vec![spot; graph.odd.len()],
            regions: Vec::new(),
            queue: BinaryHeap::new(),
            now: 0,
            events: 0,
        };
        for node in (0..graph.odd.len() as u32).filter(|&node| graph.odd[node as usize]) {
            let region = flood.push_region(Vec::new(), vec![node]);
            let spot = &mut flood.spots[node as usize];
            (spot.region, spot.top, spot.source) = (region, region, node);
        }
        for region in 0..flood.regions.len() as u32 {
            flood.schedule_nodes(region);
        }
        flood
    }

    fn push_region(&mut self, members: Vec<Member>, shell: Vec<u32>) -> u32 {
        self.regions.push(Region {
            radius: Radius {
                at_zero: -self.now,
                slope: 1,
            },
            parent: NONE,
            members,
            shell,
            mate: NONE,
            mate_touch: Touch {
                from: NONE,
                to: NONE,
            },
            tree: NONE,
            alive: true,
            alarm: NO_ALARM,
        });
        self.regions.len() as u32 - 1
    }

    /// Radius of `region` now.
    pub fn radius(&self, region: u32) -> i64 {
        self.regions[region as usize].radius.value(self.now)
    }

    /// Radius of its region when `node` was reached.
    pub fn arrival(&self, node: u32) -> i64 {
        self.spots[node as usize].arrival
    }

    /// The member of `blossom` that holds the odd node `source`.
    pub fn member_with(&self, blossom: u32, source: u32) -> usize {
        let mut region = self.spots[source as usize].region;
        while self.regions[region as usize].parent != blossom {
            region = self.regions[region as usize].parent;
        }
        let members = &self.regions[blossom as usize].members;
        (members.iter().position(|member| member.region == region))
            .expect("a blossom knows its members")
    }

    // ---- state changes, asked for by the matching ----

    pub fn grow(&mut self, region: u32) {
        self.set_slope(region, 1);
        self.schedule_nodes(region);
    }

    pub fn freeze(&mut self, region: u32) {
        let drew_back = self.regions[region as usize].radius.slope < 0;
        self.set_slope(region, 0);
        // What was growing rings too early now and is looked at again then; what was shrinking
        // did not listen for others.
        if drew_back {
            self.schedule_nodes(region);
        }
    }

    pub fn shrink(&mut self, region: u32) {
        self.set_slope(region, -1);
        for node in self.nodes_within(region) {
            self.spots[node as usize].alarm.wanted = NEVER;
        }
        self.schedule_shrinking(region);
    }

    /// Wraps the regions of an odd cycle into a new one, growing from radius 0.
    pub fn wrap(&mut self, members: Vec<Member>) -> u32 {
        let blossom = self.push_region(Vec::new(), Vec::new());
        let mut turned = Vec::new();
        for member in &members {
            let radius = self.radius(member.region);
            let region = &mut self.regions[member.region as usize];
            (region.parent, region.tree, region.mate) = (blossom, NONE, NONE);
            // The reach of what was growing goes on as before, so do its alarms.
            if region.radius.slope <= 0 {
                turned.push(member.region);
            }
            self.set_slope(member.region, 0);
            for node in self.nodes_within(member.region) {
                let spot = &mut self.spots[node as usize];
                spot.top = blossom;
                spot.wrapped += radius;
            }
        }
        self.regions[blossom as usize].members = members;
        for region in turned {
            self.schedule_nodes(region);
        }
        blossom
    }

    /// Takes a shrinking blossom of radius 0 apart; its members go on shrinking until the caller
    /// says otherwise.
    pub fn unwrap(&mut self, blossom: u32) -> Vec<Member> {
        let members = std::mem::take(&mut self.regions[blossom as usize].members);
        self.set_slope(blossom, 0);
        self.regions[blossom as usize].alive = false;
        for member in &members {
            let radius = self.radius(member.region);
            self.set_slope(member.region, -1);
            self.regions[member.region as usize].parent = NONE;
            for node in self.nodes_within(member.region) {
                let spot = &mut self.spots[node as usize];
                spot.top = member.region;
                spot.wrapped -= radius;
            }
        }
        members
    }

    fn set_slope(&mut self, region: u32, slope: i64) {
        let at_zero = self.radius(region) - slope * self.now;
        let region = &mut self.regions[region as usize];
        region.radius = Radius { at_zero, slope };
        region.alarm.wanted = NEVER;
    }

    /// All nodes of a region, those of its members included.
    fn nodes_within(&self, region: u32) -> Vec<u32> {
        let mut nodes = Vec::new();
        let mut stack = vec![region];
        while let Some(region) = stack.pop() {
            let region = &self.regions[region as usize];
            nodes.extend_from_slice(&region.shell);
            stack.extend(region.members.iter().map(|member| member.region));
        }
        nodes
    }

    // ---- time ----

    /// Runs the flood to the next thing that the matching must react to; `None` if nothing grows
    /// into anything any more or after `events_max` queue entries in all.
    pub fn next_meeting(&mut self, events_max: u64) -> Option<Meeting> {
        while self.events < events_max {
            let Reverse((time, kind, id)) = self.queue.pop()?;
            self.events += 1;
            let alarm = match kind {
                0 => &mut self.spots[id as usize].alarm,
                _ => &mut self.regions[id as usize].alarm,
            };
            if alarm.queued != time {
                continue;
            }
            alarm.queued = NEVER;
            if alarm.wanted != time {
                let wanted = alarm.wanted;
                self.set_alarm(kind, id, wanted);
                continue;
            }
            alarm.wanted = NEVER;
            self.now = time;
            let meeting = match kind {
                0 => self.look_at_node(id),
                _ => self.look_at_shrinking(id),
            };
            if meeting.is_some() {
                return meeting;
            }
        }
        None
    }

    fn set_alarm(&mut self, kind: u8, id: u32, time: i64) {
        let alarm = match kind {
            0 => &mut self.spots[id as usize].alarm,
            _ => &mut self.regions[id as usize].alarm,
        };
        alarm.wanted = time;
        if time < alarm.queued {
            alarm.queued = time;
            self.queue.push(Reverse((time, kind, id)));
        }
    }

    fn schedule_nodes(&mut self, region: u32) {
        for node in self.nodes_within(region) {
            self.schedule_node(node);
        }
    }

    fn schedule_node(&mut self, node: u32) {
        match self.next_contact(node) {
            Some((time, _)) => self.set_alarm(0, node, time),
            None => self.spots[node as usize].alarm.wanted = NEVER,
        }
    }

    /// When the last node of its shell leaves, or the radius is down to 0.
    fn schedule_shrinking(&mut self, region: u32) {
        let it = &self.regions[region as usize];
        let until = it
            .shell
            .last()
            .map_or(0, |&node| self.spots[node as usize].arrival);
        let time = it.radius.at_zero - until;
        self.set_alarm(1, region, time);
    }

    /// How far the flood reaches beyond `node`.
    fn reach(&self, node: u32) -> Radius {
        let spot = &self.spots[node as usize];
        if spot.top == NONE {
            return Radius {
                at_zero: 0,
                slope: 0,
            };
        }
        let radius = self.regions[spot.top as usize].radius;
        Radius {
            at_zero: radius.at_zero + spot.wrapped,
            slope: radius.slope,
        }
    }

    /// When the flood at `node` next fills one of its edges, and which neighbour that is.
    fn next_contact(&self, node: u32) -> Option<(i64, usize)> {
        let own = self.reach(node);
        if own.slope < 0 {
            return None;
        }
        let top = self.spots[node as usize].top;
        let mut best: Option<(i64, usize)> = None;
        for (k, next) in self.graph.neighbours(node).iter().enumerate() {
            let other = if next.node == OUTSIDE {
                Radius {
                    at_zero: 0,
                    slope: 0,
                }
            } else if top != NONE && self.spots[next.node as usize].top == top {
                continue;
            } else {
                self.reach(next.node)
            };
            let closing = own.slope + other.slope;
            // A shrinking flood draws back as fast as another one advances: they never meet.
            if other.slope < 0 || closing == 0 {
                continue;
            }
            let left = next.weight2 - own.at_zero - other.at_zero;
            debug_assert!(left % closing == 0, "floods meet at whole times");
            let time = left / closing;
            if best.is_none_or(|(least, _)| time < least) {
                best = Some((time, k));
            }
        }
        best
    }

    fn look_at_node(&mut self, node: u32) -> Option<Meeting> {
        let (time, k) = self.next_contact(node)?;
        // Looked at again at once if this is a contact: more may be due at the same time.
        self.set_alarm(0, node, time);
        if time > self.now {
            return None;
        }
        debug_assert!(time == self.now, "nothing is missed");
        let other = self.graph.neighbours(node)[k].node;
        let spot = &self.spots[node as usize];
        if other == OUTSIDE {
            let touch = Touch {
                from: spot.source,
                to: OUTSIDE,
            };
            return Some(Meeting::Outside {
                region: spot.top,
                touch,
            });
        }
        let beyond = &self.spots[other as usize];
        match (spot.top, beyond.top) {
            (NONE, _) => self.arrive(other, node),
            (_, NONE) => self.arrive(node, other),
            (a, b) => {
                let touch = Touch {
                    from: spot.source,
                    to: beyond.source,
                };
                return Some(Meeting::Regions { a, b, touch });
            }
        }
        None
    }

    /// The flood at `from` reaches the empty node `to`.
    fn arrive(&mut self, from: u32, to: u32) {
        let Spot { top, source, .. } = self.spots[from as usize];
        let arrival = self.radius(top);
        let spot = &mut self.spots[to as usize];
        (spot.region, spot.top, spot.source) = (top, top, source);
        (spot.arrival, spot.wrapped) = (arrival, -arrival);
        self.regions[top as usize].shell.push(to);
        self.schedule_node(to);
    }

    fn look_at_shrinking(&mut self, region: u32) -> Option<Meeting> {
        let it = &mut self.regions[region as usize];
        match (it.shell.len(), it.members.is_empty()) {
            (0, _) => return Some(Meeting::Shattered { region }),
            (1, true) => return Some(Meeting::Imploded { region }),
            _ => {}
        }
        let node = it.shell.pop().expect("a shell of nodes");
        let spot = &mut self.spots[node as usize];
        (spot.region, spot.top, spot.source) = (NONE, NONE, NONE);
        (spot.arrival, spot.wrapped) = (0, 0);
        self.schedule_node(node);
        self.schedule_shrinking(region);
        None
    }
}
