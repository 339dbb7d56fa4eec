//! Which edges are near a node, and which nodes are near an edge: asked once for several rounds of
//! relaxation, in which edges keep their ids and nodes move little.

use crate::cleanup::graph::Graph;

/// Answers as long as they hold.
pub(super) struct Nearby {
    /// Metres around nodes and edges of size one.
    reach: f64,
    edges: Answers,
    nodes: Answers,
    /// Scratch.
    found: Vec<u32>,
}

/// A list for each node, or for each edge, that was asked for.
struct Answers {
    /// Where it begins in the pool, with its length; zero if it was not asked for.
    at: Vec<u32>,
    pool: Vec<u32>,
    /// What was asked for: forgetting it takes no longer than asking did.
    asked: Vec<u32>,
}

impl Answers {
    fn new(len: usize) -> Answers {
        Answers {
            at: vec![0; len],
            // no list begins at zero
            pool: vec![0],
            asked: Vec::new(),
        }
    }

    fn forget(&mut self) {
        for id in self.asked.drain(..) {
            self.at[id as usize] = 0;
        }
        self.pool.truncate(1);
    }

    fn is_known(&self, id: u32) -> bool {
        self.at[id as usize] > 0
    }

    fn put(&mut self, id: u32, list: &[u32]) {
        self.at[id as usize] = self.pool.len() as u32;
        self.pool.push(list.len() as u32);
        self.pool.extend_from_slice(list);
        self.asked.push(id);
    }

    /// Of one that is known.
    fn get(&self, id: u32) -> &[u32] {
        let from = self.at[id as usize] as usize;
        &self.pool[from + 1..from + 1 + self.pool[from] as usize]
    }
}

impl Nearby {
    /// Knows nothing yet. `reach`, in mesh sizes: the distance that counts, and what a node may
    /// move in the meantime.
    pub(super) fn new(graph: &Graph, reach: f64) -> Nearby {
        Nearby {
            reach,
            edges: Answers::new(graph.at.len()),
            nodes: Answers::new(graph.edges.len()),
            found: Vec::new(),
        }
    }

    /// Knows nothing again: nodes have moved.
    pub(super) fn forget(&mut self) {
        self.edges.forget();
        self.nodes.forget();
    }

    /// Edges near a node, not its own.
    pub(super) fn edges(&mut self, graph: &Graph, node: u32) -> &[u32] {
        if !self.edges.is_known(node) {
            let reach = self.reach * graph.size_at_m(node) / graph.measure.grid().cell_m;
            (graph.index).edges_near(node, graph.point(node), reach, &mut self.found);
            self.edges.put(node, &self.found);
        }
        self.edges.get(node)
    }

    /// Nodes near an edge, not its ends, in the order of their ids.
    pub(super) fn nodes(&mut self, graph: &Graph, edge: u32) -> &[u32] {
        if !self.nodes.is_known(edge) {
            let it = &graph.edges[edge as usize];
            let [p, q] = it.ends.map(|end| graph.point(end));
            let reach = self.reach * it.size_m / graph.measure.grid().cell_m;
            self.found.clear();
            (graph.index).each_node_near(p, q, reach, |node| {
                if !it.ends.contains(&node) {
                    self.found.push(node);
                }
            });
            self.found.sort_unstable();
            self.nodes.put(edge, &self.found);
        }
        self.nodes.get(edge)
    }
}
