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
    /// Where it is in the pool; nowhere if it was not asked for.
    at: Vec<Option<(u32, u32)>>,
    pool: Vec<u32>,
}

impl Answers {
    fn new(len: usize) -> Answers {
        Answers {
            at: vec![None; len],
            pool: Vec::new(),
        }
    }

    fn put(&mut self, id: u32, list: &[u32]) {
        let from = self.pool.len() as u32;
        self.pool.extend_from_slice(list);
        self.at[id as usize] = Some((from, self.pool.len() as u32));
    }

    fn get(&self, id: u32) -> Option<&[u32]> {
        let (from, to) = self.at[id as usize]?;
        Some(&self.pool[from as usize..to as usize])
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

    /// Edges near a node, not its own.
    pub(super) fn edges(&mut self, graph: &Graph, node: u32) -> &[u32] {
        if self.edges.at[node as usize].is_none() {
            let reach = self.reach * graph.size_at_m(node) / graph.measure.grid().cell_m;
            (graph.index).edges_near(node, graph.point(node), reach, &mut self.found);
            self.edges.put(node, &self.found);
        }
        self.edges.get(node).expect("it was put there")
    }

    /// Nodes near an edge, not its ends, in the order of their ids.
    pub(super) fn nodes(&mut self, graph: &Graph, edge: u32) -> &[u32] {
        if self.nodes.at[edge as usize].is_none() {
            let it = &graph.edges[edge as usize];
            let [p, q] = it.ends.map(|end| graph.point(end));
            let reach = self.reach * it.size_m / graph.measure.grid().cell_m;
            (graph.index).nodes_near(p, q, reach, &mut self.found);
            self.found
                .retain(|&node| !it.ends.contains(&node) && graph.degree(node) > 0);
            self.nodes.put(edge, &self.found);
        }
        self.nodes.get(edge).expect("it was put there")
    }
}
