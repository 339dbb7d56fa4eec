//! The quads of a trial mesh around the nodes of the line work, and how they move with those.

use crate::boundary::walks::Site;
use crate::boundary::walks::Walks;
use crate::boundary::walks::walks;
use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::meshing;
use crate::meshing::patch::Loops;
use crate::meshing::patch::Patch;
use crate::partition::subdomains::SubdomainId;
use smallvec::SmallVec;

/// What a corner of a quad follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Follows {
    /// Nothing: it lies inside.
    Nothing,
    /// A node of the line work, all its way.
    Node(u32),
    /// Two, each with its share of the way: it divides the edge between them.
    Edge([(u32, f32); 2]),
}

/// A quad with a corner at a node of the line work, or at the next one along an edge there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ring {
    /// Counter-clockwise, metres.
    pub(super) corners: [Xy; 4],
    pub(super) follows: [Follows; 4],
}

impl Ring {
    /// The nodes that it follows; some may come twice.
    pub(super) fn nodes(&self) -> SmallVec<[u32; 8]> {
        let mut nodes = SmallVec::new();
        for follows in self.follows {
            match follows {
                Follows::Nothing => {}
                Follows::Node(node) => nodes.push(node),
                Follows::Edge([a, b]) => nodes.extend([a.0, b.0]),
            }
        }
        nodes
    }

    /// Its corners when each node has gone so far, metres.
    pub(super) fn moved(&self, way: &[Xy]) -> [Xy; 4] {
        [0, 1, 2, 3].map(|k| {
            let [x, y] = self.corners[k];
            match self.follows[k] {
                Follows::Nothing => [x, y],
                Follows::Node(node) => {
                    let by = way[node as usize];
                    [x + by[0], y + by[1]]
                }
                Follows::Edge([(a, s), (b, t)]) => {
                    let (u, v) = (way[a as usize], way[b as usize]);
                    let (s, t) = (f64::from(s), f64::from(t));
                    [x + s * u[0] + t * v[0], y + s * u[1] + t * v[1]]
                }
            }
        })
    }
}

/// What is kept of the trial mesh of one sub-domain.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trial {
    pub(super) rings: Vec<Ring>,
}

impl Trial {
    /// True if a quad here follows one of these nodes, by id.
    pub fn sees(&self, is_of: &[bool]) -> bool {
        let mut nodes = self.rings.iter().flat_map(Ring::nodes);
        nodes.any(|node| is_of[node as usize])
    }
}

/// Meshes one sub-domain on trial.
pub fn trial(site: &Site, subdomain: SubdomainId) -> Trial {
    let walked = walks(site, subdomain);
    let loops = Loops::of(&walked, site.sizes.default_m);
    match meshing::mesh(&loops, &meshing::Options::trial()) {
        Ok(meshed) => kept(&walked, site.arrangement.points.len() as u64, &meshed.patch),
        // our mistake, but nothing is lost: the mesh itself will say where
        Err(_) => Trial::default(),
    }
}

/// What is kept of a patch. Global ids below `fixed` are nodes of the line work.
fn kept(walked: &Walks, fixed: u64, patch: &Patch) -> Trial {
    let (follows, is_near) = on_walks(walked, fixed);
    let is_ring = |quad: &&[u32; 4]| {
        let mut corners = quad.iter().map(|&corner| is_near.get(corner as usize));
        corners.any(|it| it.copied().unwrap_or(false))
    };
    let follows = |corner: u32| follows.get(corner as usize).copied();
    let ring = |quad: &[u32; 4]| Ring {
        corners: quad.map(|corner| patch.nodes[corner as usize]),
        follows: quad.map(|corner| follows(corner).unwrap_or(Follows::Nothing)),
    };
    Trial {
        rings: patch.quads.iter().filter(is_ring).map(ring).collect(),
    }
}

/// For each node on the walks, what it follows, and if it is a node of the line work or next to one.
fn on_walks(walked: &Walks, fixed: u64) -> (Vec<Follows>, Vec<bool>) {
    let mut follows = vec![Follows::Nothing; walked.nodes.len()];
    let mut is_near = vec![false; walked.nodes.len()];
    let is_fixed = |node: u32| walked.ids[node as usize] < fixed;
    let place = |node: u32| walked.nodes[node as usize];
    let id = |node: u32| walked.ids[node as usize] as u32;
    for walk in &walked.walks {
        let begin = walk.iter().position(|&node| is_fixed(node));
        let begin = begin.expect("a walk passes a node of the line work");
        let around: Vec<u32> = [&walk[begin..], &walk[..=begin]].concat();
        let mut from = 0;
        while from + 1 < around.len() {
            let between = around[from + 1..].iter().take_while(|&&it| !is_fixed(it));
            let to = from + 1 + between.count();
            let [a, b] = [around[from], around[to]];
            follows[a as usize] = Follows::Node(id(a));
            is_near[a as usize] = true;
            let length_m = distance(place(a), place(b));
            for k in from + 1..to {
                let node = around[k];
                let share = (distance(place(a), place(node)) / length_m) as f32;
                follows[node as usize] = Follows::Edge([(id(a), 1.0 - share), (id(b), share)]);
                is_near[node as usize] |= k == from + 1 || k + 1 == to;
            }
            from = to;
        }
    }
    (follows, is_near)
}

#[cfg(test)]
mod tests {
    use super::Follows;
    use super::Ring;
    use super::kept;
    use crate::boundary::walks::Walks;
    use crate::meshing::patch::Method;
    use crate::meshing::patch::Patch;

    /// A block of 4 x 1 quads; its long sides are edges of four intervals, its short ones of one.
    fn block() -> (Walks, Patch) {
        let below = (0..5).map(|x| [f64::from(x), 0.0]);
        let above = (0..5).rev().map(|x| [f64::from(x), 1.0]);
        let nodes: Vec<[f64; 2]> = below.chain(above).collect();
        let walked = Walks {
            ids: vec![3, 10, 11, 12, 0, 1, 13, 14, 15, 2],
            walks: vec![vec![6, 7, 8, 9, 0, 1, 2, 3, 4, 5]],
            on_seam: vec![vec![false; 10]],
            across_m: Vec::new(),
            nodes: nodes.clone(),
        };
        let patch = Patch {
            nodes,
            quads: vec![[0, 1, 8, 9], [1, 2, 7, 8], [2, 3, 6, 7], [3, 4, 5, 6]],
            method: Method::Mapping,
            last_resort_quads: 0,
        };
        (walked, patch)
    }

    #[test]
    fn rings_move_as_boundary_will_place_their_corners() {
        let (walked, patch) = block();
        let trial = kept(&walked, 4, &patch);
        assert_eq!(trial.rings.len(), 4, "all are at a node or next to one");
        let way = [[0.4, 0.0], [0.0, 0.8], [-0.4, 0.4], [0.0, -0.2]];
        let ends = |a: usize, b: usize, t: f64| {
            [0, 1].map(|x| walked.nodes[a][x] * (1.0 - t) + walked.nodes[b][x] * t)
        };
        // by walk node: where equal parts of the moved edges are
        let place = |node: usize| {
            let moved = |node: usize, id: usize| [0, 1].map(|x| walked.nodes[node][x] + way[id][x]);
            let [a, b, t] = match node {
                0..=4 => [0, 4, node],
                _ => [5, 9, node - 5],
            };
            let id = |node: usize| walked.ids[node] as usize;
            let (p, q) = (moved(a, id(a)), moved(b, id(b)));
            let t = t as f64 / 4.0;
            assert_eq!(ends(a, b, t), walked.nodes[node]);
            [0, 1].map(|x| p[x] * (1.0 - t) + q[x] * t)
        };
        for (ring, quad) in trial.rings.iter().zip(&patch.quads) {
            for (corner, &node) in ring.moved(&way).iter().zip(quad) {
                let [x, y] = place(node as usize);
                assert!((corner[0] - x).hypot(corner[1] - y) < 1e-6);
            }
        }
    }

    #[test]
    fn a_trial_sees_the_nodes_of_its_rings() {
        let (walked, patch) = block();
        let trial = kept(&walked, 4, &patch);
        assert!(trial.sees(&[false, false, true, false]));
        assert!(!trial.sees(&[false; 4]));
        let ring: &Ring = &trial.rings[1];
        assert_eq!(ring.follows[0], Follows::Edge([(3, 0.75), (0, 0.25)]));
    }
}
