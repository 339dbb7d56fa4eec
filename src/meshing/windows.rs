//! Convex windows: parts of the mesh that look from inside like a polygon of three to six sides.
//!
//! Inside a part of a quad mesh without holes, the counts of quads say how its outline turns: a node
//! of the outline with one quad inside is a *corner*, with two it is on a *side*, with three or more
//! it is reflex. A window has no reflex node. It grows from one irregular node to the next ones, and
//! whatever lies around a reflex node is taken in: like a convex hull, but in counts instead of
//! places. By Gauss and Bonnet, a window has four corners less one for each inner node of valence 3,
//! and one more for each of valence 5: one that holds as many of either has four.
//!
//! A held node that is surrounded counts as if it had as many quads as its angle wants: what fills
//! the window can mend it too.

use crate::meshing::kernel::Kernel;
use crate::meshing::kernel::before;
use crate::meshing::kernel::quad_of;
use crate::meshing::patterns::counts;
use crate::meshing::spokes::signed_spokes;
use crate::meshing::triangulate::NONE;

/// Largest window, quads. Measured on two cities: 80 to 600 give the same mesh.
const MOST_QUADS: usize = 100;

/// So far, in edges, an irregular node looks for others, and so many of them at most. Measured on
/// two cities: 8 edges leave a sixth more irregular nodes, 16 need a tenth more time.
const REACH: usize = 12;
const MOST_NEAR: usize = 5;

/// So many times a window is made wider for one pattern.
const MOST_PUSHES: usize = 4;

/// A held node with so many quads more or less than its angle asks for is as it should be: between
/// two counts there is nothing to choose.
const HELD_SLACK: f32 = 0.55;

/// A convex part of the mesh.
pub(crate) struct Window {
    /// Its quads, sorted.
    pub quads: Vec<u32>,
    /// The nodes around it, counter-clockwise.
    pub outline: Vec<u32>,
    /// Entries of the outline that are corners.
    pub corners: Vec<usize>,
    /// How many irregular nodes a pattern would take out.
    pub irregular: usize,
}

/// How many quads a node should have.
fn wanted(kernel: &Kernel, node: u32) -> u32 {
    let (count, ideal) = (kernel.valence[node as usize], kernel.ideal[node as usize]);
    if !kernel.held[node as usize] {
        4
    } else if (count as f32 - ideal).abs() < HELD_SLACK {
        count
    } else {
        (ideal.round() as u32).max(1)
    }
}

/// True if `node` is there and has not as many quads as it should.
pub(crate) fn is_irregular(kernel: &Kernel, node: u32) -> bool {
    let count = kernel.valence[node as usize];
    count != 0 && count != wanted(kernel, node)
}

/// A window while it grows. Kept from one to the next, as its arrays are as long as the mesh.
#[derive(Default)]
pub(crate) struct Growth {
    quads: Vec<u32>,
    /// Quad -> is it in the window?
    taken: Vec<bool>,
    /// Node -> how many of its quads are.
    count: Vec<u32>,
    /// Nodes with a count.
    nodes: Vec<u32>,
    /// Nodes whose counts have changed since [`close`](Growth::close).
    doubtful: Vec<u32>,
    /// Nodes within reach of the seed, nearest first, and from which node each was reached.
    reached: Vec<u32>,
    from: Vec<u32>,
}

impl Growth {
    /// Ever larger windows around the irregular node `seed`: each holds one more of the irregular
    /// nodes near it.
    pub fn windows(&mut self, kernel: &Kernel, seed: u32) -> Vec<Window> {
        let near = self.near(kernel, seed);
        let mut windows = Vec::new();
        let mut held: Vec<u32> = Vec::new();
        self.restart(kernel, seed, &[]);
        for &target in &near {
            if self.has_all(kernel, target) {
                continue;
            }
            self.reach(kernel, seed, target);
            match self.close(kernel).then(|| self.roomy(kernel)).flatten() {
                Some(window) => {
                    held.push(target);
                    windows.push(window);
                }
                None => self.restart(kernel, seed, &held),
            }
        }
        windows
    }

    /// The irregular nodes nearest to `seed` in edges, by a search that does not pass held nodes.
    fn near(&mut self, kernel: &Kernel, seed: u32) -> Vec<u32> {
        for node in self.reached.drain(..) {
            self.from[node as usize] = NONE;
        }
        self.from.resize(kernel.nodes.len(), NONE);
        let mut near = Vec::new();
        self.from[seed as usize] = seed;
        self.reached.push(seed);
        let (mut done, mut edges, mut level_end) = (0, 0, 1);
        while done < self.reached.len() && near.len() < MOST_NEAR {
            if done == level_end {
                (edges, level_end) = (edges + 1, self.reached.len());
                if edges == REACH {
                    break;
                }
            }
            let node = self.reached[done];
            done += 1;
            if node != seed && is_irregular(kernel, node) {
                near.push(node);
            }
            if kernel.held[node as usize] && node != seed {
                continue;
            }
            for side in kernel.spokes(node) {
                let other = kernel.end(side);
                if self.from[other as usize] == NONE {
                    self.from[other as usize] = node;
                    self.reached.push(other);
                }
            }
        }
        near
    }

    /// Begins again with the quads around `seed` and on the ways to `targets`.
    fn restart(&mut self, kernel: &Kernel, seed: u32, targets: &[u32]) {
        for quad in self.quads.drain(..) {
            self.taken[quad as usize] = false;
        }
        for node in self.nodes.drain(..) {
            self.count[node as usize] = 0;
        }
        self.doubtful.clear();
        self.taken.resize(kernel.quads.len(), false);
        self.count.resize(kernel.nodes.len(), 0);
        self.add_around(kernel, seed);
        for &target in targets {
            self.reach(kernel, seed, target);
        }
        self.close(kernel);
    }

    /// Takes in the quads around `target`, and those along the way to it from `seed`.
    fn reach(&mut self, kernel: &Kernel, seed: u32, target: u32) {
        self.add_around(kernel, target);
        let mut node = target;
        while node != seed {
            let to = self.from[node as usize];
            for side in kernel.spokes(node) {
                for (side, end) in [
                    (side, kernel.end(side)),
                    (before(side), kernel.start(before(side))),
                ] {
                    if end == to {
                        self.add(kernel, quad_of(side));
                    }
                }
            }
            node = to;
        }
    }

    fn add_around(&mut self, kernel: &Kernel, node: u32) {
        for side in kernel.spokes(node) {
            self.add(kernel, quad_of(side));
        }
    }

    fn add(&mut self, kernel: &Kernel, quad: u32) {
        if std::mem::replace(&mut self.taken[quad as usize], true) {
            return;
        }
        self.quads.push(quad);
        for node in kernel.quads[quad as usize] {
            if self.count[node as usize] == 0 {
                self.nodes.push(node);
            }
            self.count[node as usize] += 1;
            self.doubtful.push(node);
        }
    }

    /// True if all quads around `node` are in the window.
    fn has_all(&self, kernel: &Kernel, node: u32) -> bool {
        self.count[node as usize] == kernel.valence[node as usize]
    }

    /// Takes in what is around reflex nodes and where the window touches itself, until it is
    /// convex; false if it cannot be, or becomes too large.
    fn close(&mut self, kernel: &Kernel) -> bool {
        while let Some(node) = self.doubtful.pop() {
            if self.has_all(kernel, node) {
                if kernel.held[node as usize] && wanted(kernel, node) >= 3 {
                    return false;
                }
                continue;
            }
            let count = self.count[node as usize];
            if count >= 3 || (count == 2 && self.is_split(kernel, node)) {
                self.add_around(kernel, node);
            }
            if self.quads.len() > MOST_QUADS {
                return false;
            }
        }
        true
    }

    /// True if the two quads of the window at `node` are not side by side.
    fn is_split(&self, kernel: &Kernel, node: u32) -> bool {
        let beside = |side: u32| {
            let twin = kernel.twin(before(side));
            twin != NONE && self.taken[quad_of(twin) as usize]
        };
        let mut inside =
            (kernel.spokes(node).into_iter()).filter(|&side| self.taken[quad_of(side) as usize]);
        !inside.any(beside)
    }

    /// The window, with sides moved out where a spoke of its pattern would have no length.
    fn roomy(&mut self, kernel: &Kernel) -> Option<Window> {
        for _ in 0..MOST_PUSHES {
            let window = self.window(kernel)?;
            let counts = counts(window.outline.len(), &window.corners);
            let Some(spokes) = signed_spokes(&counts) else {
                return Some(window);
            };
            let mut any = false;
            for side in (0..counts.len()).filter(|&side| spokes[side] < 1) {
                self.push_out(kernel, &window, side, counts[side]);
                any = true;
            }
            if !any {
                return Some(window);
            }
            if !self.close(kernel) {
                return None;
            }
        }
        self.window(kernel)
    }

    /// Takes in the row of quads beyond a side.
    fn push_out(&mut self, kernel: &Kernel, window: &Window, side: usize, count: usize) {
        let n = window.outline.len();
        for entry in window.corners[side]..window.corners[side] + count {
            let [from, to] = [entry, entry + 1].map(|entry| window.outline[entry % n]);
            for spoke in kernel.spokes(to) {
                if kernel.end(spoke) == from {
                    self.add(kernel, quad_of(spoke));
                }
            }
        }
    }

    /// What has been taken in, if its outline is one simple loop.
    fn window(&self, kernel: &Kernel) -> Option<Window> {
        let mut edges: Vec<(u32, u32)> = Vec::with_capacity(2 * self.quads.len() + 2);
        for side in self.quads.iter().flat_map(|&quad| 4 * quad..4 * quad + 4) {
            let twin = kernel.twin(side);
            if twin == NONE || !self.taken[quad_of(twin) as usize] {
                edges.push((kernel.start(side), kernel.end(side)));
            }
        }
        edges.sort_unstable();
        let mut outline = Vec::with_capacity(edges.len());
        outline.push(edges[0].0);
        let mut node = edges[0].1;
        while node != outline[0] {
            if outline.len() == edges.len() {
                return None;
            }
            outline.push(node);
            let at = edges.partition_point(|edge| edge.0 < node);
            node = edges.get(at).filter(|edge| edge.0 == node)?.1;
        }
        let count = |node: u32| match kernel.held[node as usize] && self.has_all(kernel, node) {
            true => wanted(kernel, node),
            false => self.count[node as usize],
        };
        if outline.len() != edges.len() {
            return None;
        }
        let is_corner = |&entry: &usize| count(outline[entry]) == 1;
        let corners = (0..outline.len()).filter(is_corner).collect();
        let is_gone = |&&node: &&u32| self.has_all(kernel, node) && is_irregular(kernel, node);
        let mut quads = self.quads.clone();
        quads.sort_unstable();
        Some(Window {
            corners,
            irregular: self.nodes.iter().filter(is_gone).count(),
            quads,
            outline,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::edits::Operation;
    use crate::meshing::edits::edit;
    use crate::meshing::kernel::grid;

    /// A grid of 12 x 12 with one edge turned: two nodes of valence 3 and two of 5.
    fn turned() -> Kernel {
        let mut kernel = grid(12, 12);
        let swap = Operation::Swap {
            side: 4 * (5 * 12 + 5) + 1,
            left: true,
        };
        let edit = edit(&kernel, swap).expect("inside");
        kernel.replace(&edit.old, &edit.new).expect("outlines fit");
        kernel
    }

    #[test]
    fn windows_have_the_corners_that_gauss_and_bonnet_ask_for() {
        let kernel = turned();
        let seeds: Vec<u32> = (0..kernel.nodes.len() as u32)
            .filter(|&node| is_irregular(&kernel, node))
            .collect();
        assert_eq!(seeds.len(), 4);
        let mut growth = Growth::default();
        for &seed in &seeds {
            let windows = growth.windows(&kernel, seed);
            assert!(windows.iter().any(|window| window.irregular == 4));
            for window in windows {
                let inside = |node: u32| {
                    let quads = window.quads.iter();
                    let around = quads.filter(|&&quad| kernel.quads[quad as usize].contains(&node));
                    around.count()
                };
                let mut charge = 0;
                for &node in &seeds {
                    let valence = kernel.valence[node as usize];
                    if inside(node) == valence as usize {
                        charge += 4 - valence as i32;
                    }
                }
                assert_eq!(window.corners.len() as i32, 4 - charge);
                for (entry, &node) in window.outline.iter().enumerate() {
                    let quads = if window.corners.contains(&entry) {
                        1
                    } else {
                        2
                    };
                    assert_eq!(inside(node), quads, "convex");
                }
                assert!(window.quads.len() <= MOST_QUADS);
            }
        }
    }
}
