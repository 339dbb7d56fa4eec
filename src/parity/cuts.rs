//! The radii as odd cuts: a family of nested or disjoint node sets with a dual value each.
//!
//! The proof that a choice of edges is cheapest. Every set S holds an odd number of odd nodes and
//! not the outside, so any choice that makes all nodes even takes an edge of the cut around S. If
//! no edge pays more than twice its weight to the sets that it leaves, then half of all values
//! together is a lower bound on any choice's cost: linear programming duality, in whole numbers.

use crate::parity::flood::Flood;
use crate::parity::flood::NONE;
use crate::parity::graph::Edge;
use crate::parity::graph::Graph;
use crate::parity::graph::OUTSIDE;

/// A laminar family of odd sets. 16 bytes a set, 4 a node: sets are stored as a forest, a node
/// belongs to the least set around it and to all sets above that.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cuts {
    /// The next larger set around each set, or `u32::MAX`; parents precede children.
    pub parent: Vec<u32>,
    /// Dual value of each set, positive, in half units of weight.
    pub value2: Vec<i64>,
    /// The least set around each node, or `u32::MAX`.
    pub set_of: Vec<u32>,
}

impl Cuts {
    /// The family of a flood that was stopped, finished or not.
    pub fn of(flood: &Flood, nodes: usize) -> Cuts {
        let mut cuts = Cuts {
            set_of: vec![NONE; nodes],
            ..Cuts::default()
        };
        let mut stack: Vec<(u32, u32)> = (0..flood.regions.len() as u32)
            .rev()
            .filter(|&id| {
                let region = &flood.regions[id as usize];
                region.alive && region.parent == NONE
            })
            .map(|id| (id, NONE))
            .collect();
        // A region is a nest of sets, one more each time its flood reached a node: outermost first.
        while let Some((id, around)) = stack.pop() {
            let region = &flood.regions[id as usize];
            let (mut set, mut radius) = (around, flood.radius(id));
            for &node in region.shell.iter().rev() {
                cuts.nest(&mut set, &mut radius, flood.arrival(node));
                cuts.set_of[node as usize] = set;
            }
            cuts.nest(&mut set, &mut radius, 0);
            stack.extend(region.members.iter().map(|member| (member.region, set)));
        }
        cuts
    }

    fn nest(&mut self, set: &mut u32, radius: &mut i64, down_to: i64) {
        if *radius > down_to {
            self.parent.push(*set);
            self.value2.push(*radius - down_to);
            *set = self.parent.len() as u32 - 1;
            *radius = down_to;
        }
    }

    /// The bound that the family proves, in half units of weight.
    pub fn bound2(&self) -> i64 {
        self.value2.iter().sum()
    }

    /// Calls `visit` with each set that `edge` leaves or enters.
    pub fn crossed(&self, edge: &Edge, mut visit: impl FnMut(u32)) {
        let least = |node: u32| match node {
            OUTSIDE => NONE,
            _ => self.set_of[node as usize],
        };
        // Parents precede children, so the later of two sets cannot contain the other one.
        let (mut a, mut b) = (least(edge.a), least(edge.b));
        while a != b {
            let inner = if b == NONE || (a != NONE && a > b) {
                &mut a
            } else {
                &mut b
            };
            visit(*inner);
            *inner = self.parent[*inner as usize];
        }
    }

    /// Twice the edge's weight minus what it pays: its reduced cost in half units, negative if the
    /// family proves nothing.
    pub fn slack2(&self, edge: &Edge) -> i64 {
        let mut slack2 = 2 * edge.weight;
        self.crossed(edge, |set| slack2 -= self.value2[set as usize]);
        slack2
    }

    /// The bound that the family proves for `graph`, whole units: recomputed, nothing is trusted.
    pub fn proven(&self, graph: &Graph) -> Result<i64, String> {
        let sets = self.parent.len();
        if self.set_of.len() != graph.odd.len() || self.value2.len() != sets {
            return Err("the certificate has arrays of other lengths".into());
        }
        let mut odd = vec![false; sets];
        for (node, &set) in (self.set_of.iter().enumerate()).filter(|(_, set)| **set != NONE) {
            let set = (odd.get_mut(set as usize)).ok_or("a node in a set that is not there")?;
            *set ^= graph.odd[node];
        }
        for set in (0..sets).rev() {
            let parent = self.parent[set];
            if !odd[set] || self.value2[set] <= 0 || (parent != NONE && parent as usize >= set) {
                return Err(format!("set {set} of the certificate proves nothing"));
            }
            if parent != NONE {
                odd[parent as usize] ^= true;
            }
        }
        match graph.edges.iter().find(|edge| self.slack2(edge) < 0) {
            Some(edge) => Err(format!("curve {} pays more than it costs", edge.label)),
            // Rounded up: costs are whole.
            None => Ok((self.bound2() + 1) / 2),
        }
    }
}
