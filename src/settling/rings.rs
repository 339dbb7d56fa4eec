//! The rings of all trials together: what moves with a node, and what it is worth then.

use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::geometry::quad::measure;
use crate::meshing::worth_of;
use crate::settling::trial::Follows;
use crate::settling::trial::Ring;
use crate::settling::trial::Trial;
use smallvec::SmallVec;

/// Nodes by their ids in the arrangement, rings by trial.
pub(super) struct Rings<'t> {
    rings: Vec<&'t Ring>,
    /// `of[start[node]..start[node + 1]]`: the rings that follow a node.
    start: Vec<u32>,
    of: Vec<u32>,
    /// How far each node has gone, metres.
    pub(super) way: Vec<Xy>,
    /// Wished edge length in each ring, metres.
    size_m: Vec<f32>,
}

impl<'t> Rings<'t> {
    /// `size_at_m`: the least wished edge length of the lines at each node.
    pub(super) fn new(trials: &'t [Trial], size_at_m: &[f64]) -> Rings<'t> {
        let rings: Vec<&Ring> = trials.iter().flat_map(|it| &it.rings).collect();
        let ids = (0..).zip(&rings);
        let pairs = ids.flat_map(|(id, ring)| ring.nodes().into_iter().map(move |it| (it, id)));
        let mut pairs: Vec<(u32, u32)> = pairs.collect();
        pairs.sort_unstable();
        pairs.dedup();
        let mut start = vec![0; size_at_m.len() + 1];
        for &(node, _) in &pairs {
            start[node as usize + 1] += 1;
        }
        for node in 0..size_at_m.len() {
            start[node + 1] += start[node];
        }
        let size_m = |ring: &&Ring| {
            let nodes = ring.nodes().into_iter();
            let sizes = nodes.map(|node| size_at_m[node as usize]);
            sizes.fold(f64::INFINITY, f64::min) as f32
        };
        Rings {
            start,
            of: pairs.into_iter().map(|it| it.1).collect(),
            way: vec![[0.0; 2]; size_at_m.len()],
            size_m: rings.iter().map(size_m).collect(),
            rings,
        }
    }

    pub(super) fn len(&self) -> u32 {
        self.rings.len() as u32
    }

    /// Nodes that a ring follows.
    pub(super) fn nodes_of(&self, ring: u32) -> SmallVec<[u32; 8]> {
        self.rings[ring as usize].nodes()
    }

    /// The rings that follow a node.
    pub(super) fn at(&self, node: u32) -> &[u32] {
        let [from, to] = [0, 1].map(|k| self.start[node as usize + k] as usize);
        &self.of[from..to]
    }

    /// The wished edge length at a node, metres; infinite if no ring follows it.
    pub(super) fn size_m(&self, node: u32) -> f64 {
        let sizes = self.at(node).iter().map(|&ring| self.ring_size_m(ring));
        sizes.fold(f64::INFINITY, f64::min)
    }

    fn ring_size_m(&self, ring: u32) -> f64 {
        f64::from(self.size_m[ring as usize])
    }

    /// What the quad is worth now, all its sides counted.
    pub(super) fn worth(&self, ring: u32) -> f64 {
        let measured = measure(&self.rings[ring as usize].moved(&self.way));
        let shortest_m = (measured.sides_m.into_iter()).fold(f64::INFINITY, f64::min);
        worth_of(&measured, shortest_m, self.ring_size_m(ring))
    }

    /// The least worth of all.
    pub(super) fn poorest(&self) -> f64 {
        let worths = (0..self.len()).map(|ring| self.worth(ring));
        worths.fold(f64::INFINITY, f64::min)
    }

    /// The least worth around a node that some ring follows, and the ring that has it.
    pub(super) fn poorest_at(&self, node: u32) -> (f64, u32) {
        let rings = self.at(node).iter().copied();
        let worths = rings.map(|ring| (self.worth(ring), ring));
        (worths.min_by(|a, b| a.0.total_cmp(&b.0))).expect("a node of a ring")
    }

    /// The least worth around a node; some value below `enough` as soon as it is known to be less. `first`: the ring
    /// that most probably is.
    pub(super) fn least(&self, node: u32, first: u32, enough: f64) -> f64 {
        let mut least = self.worth(first);
        for &ring in self.at(node) {
            if least < enough {
                break;
            }
            least = least.min(self.worth(ring));
        }
        least
    }

    /// The shortest side around a node between two nodes on lines, in wished sizes.
    pub(super) fn shortest_on_lines(&self, node: u32) -> f64 {
        let mut shortest = f64::INFINITY;
        for &ring in self.at(node) {
            let it = self.rings[ring as usize];
            let corners = it.moved(&self.way);
            for k in 0..4 {
                let next = (k + 1) % 4;
                if [k, next].iter().all(|&k| it.follows[k] != Follows::Nothing) {
                    let length_m = distance(corners[k], corners[next]);
                    shortest = shortest.min(length_m / self.ring_size_m(ring));
                }
            }
        }
        shortest
    }
}
