//! The dual graph: a node a sub-domain, an edge where changing a curve's count changes parity.

/// Node id of the outside, which absorbs any parity. No edge leaves from it but to a node.
pub const OUTSIDE: u32 = u32::MAX;

/// One edge: to change its parity costs `weight`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Lesser node.
    pub a: u32,
    /// Greater node; [`OUTSIDE`] is greater than all.
    pub b: u32,
    /// Cost of a change of parity, at least 0; integers, so that proofs are exact.
    pub weight: i64,
    /// What the edge stands for, for the caller.
    pub label: u32,
}

/// A neighbour of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Neighbour {
    /// The node on the other side, or [`OUTSIDE`].
    pub node: u32,
    /// Index into [`Graph::edges`].
    pub edge: u32,
    /// **Twice** the edge's weight: floods from both ends then meet at whole numbers.
    pub weight2: i64,
}

/// The dual graph with its odd nodes. 24 bytes an edge, 32 for its two adjacencies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    /// Sorted by (a, b); the cheapest of each bundle of parallel edges; no loops.
    pub edges: Vec<Edge>,
    /// Nodes whose parity must change.
    pub odd: Vec<bool>,
    start: Vec<u32>,
    neighbours: Vec<Neighbour>,
}

impl Graph {
    /// The graph on `odd.len()` nodes: drops loops and all but the cheapest of parallel edges.
    pub fn new(odd: Vec<bool>, mut edges: Vec<Edge>) -> Graph {
        for edge in &mut edges {
            (edge.a, edge.b) = (edge.a.min(edge.b), edge.a.max(edge.b));
        }
        edges.retain(|edge| edge.a != edge.b);
        edges.sort_unstable_by_key(|edge| (edge.a, edge.b, edge.weight, edge.label));
        edges.dedup_by_key(|edge| (edge.a, edge.b));
        let mut start = vec![0; odd.len() + 1];
        let ends = |edge: &Edge| [edge.a, edge.b].into_iter().filter(|&node| node != OUTSIDE);
        for node in edges.iter().flat_map(ends) {
            start[node as usize + 1] += 1;
        }
        for node in 0..odd.len() {
            start[node + 1] += start[node];
        }
        let nothing = Neighbour {
            node: OUTSIDE,
            edge: 0,
            weight2: 0,
        };
        let mut neighbours = vec![nothing; start[odd.len()] as usize];
        let mut next = start.clone();
        for (id, edge) in edges.iter().enumerate() {
            for (from, to) in [(edge.a, edge.b), (edge.b, edge.a)] {
                if from != OUTSIDE {
                    let slot = &mut next[from as usize];
                    neighbours[*slot as usize] = Neighbour {
                        node: to,
                        edge: id as u32,
                        weight2: 2 * edge.weight,
                    };
                    *slot += 1;
                }
            }
        }
        Graph {
            edges,
            odd,
            start,
            neighbours,
        }
    }

    /// The neighbours of `node`.
    pub fn neighbours(&self, node: u32) -> &[Neighbour] {
        let node = node as usize;
        &self.neighbours[self.start[node] as usize..self.start[node + 1] as usize]
    }

    /// A component without a way to the outside and with an odd number of odd nodes, which no
    /// choice of edges can make even: its nodes, sorted.
    pub fn hopeless(&self) -> Option<Vec<u32>> {
        let n = self.odd.len();
        let mut seen = vec![false; n];
        let mut reached = Vec::new();
        for seed in 0..n as u32 {
            if std::mem::replace(&mut seen[seed as usize], true) {
                continue;
            }
            let (mut odd, mut open, mut next) = (false, false, 0);
            reached.clear();
            reached.push(seed);
            while next < reached.len() {
                let node = reached[next];
                next += 1;
                odd ^= self.odd[node as usize];
                for near in self.neighbours(node) {
                    if near.node == OUTSIDE {
                        open = true;
                    } else if !std::mem::replace(&mut seen[near.node as usize], true) {
                        reached.push(near.node);
                    }
                }
            }
            if odd && !open {
                reached.sort_unstable();
                return Some(reached);
            }
        }
        None
    }
}
