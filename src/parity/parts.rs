//! A programme thinned by reduced cost -> parts that share no node, edge or row.
//!
//! Of a city with half of all sub-domains odd what is left after thinning is an archipelago: at 100 000
//! sub-domains some ten thousand parts, most of them of a few rows. Parts are independent programmes.

use crate::parity::cuts::Cuts;
use crate::parity::graph::Graph;
use crate::parity::graph::OUTSIDE;
use crate::parity::groups::Groups;

/// One part.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Edges of the graph, ascending: the columns.
    pub edges: Vec<u32>,
    /// Sets of the family, ascending: the rows.
    pub sets: Vec<u32>,
}

/// The parts with an odd node that edges of a slack of at most `slack2_max` make, small ones together
/// up to `rows` rows, in order of their first edges. Where no node is odd no edge is needed.
pub fn parts(graph: &Graph, cuts: &Cuts, slack2_max: i64, rows: usize) -> Vec<Part> {
    let nodes = graph.odd.len();
    let edges: Vec<u32> = (0..graph.edges.len() as u32)
        .filter(|&id| cuts.slack2(&graph.edges[id as usize]) <= slack2_max)
        .collect();
    let mut groups = Groups::new(nodes + cuts.parent.len());
    for &id in &edges {
        let edge = &graph.edges[id as usize];
        if edge.b != OUTSIDE {
            groups.join(edge.a, edge.b);
        }
        cuts.crossed(edge, |set| {
            groups.join(edge.a, nodes as u32 + set);
        });
    }
    let mut is_odd = vec![false; nodes + cuts.parent.len()];
    for node in (0..nodes as u32).filter(|&node| graph.odd[node as usize]) {
        is_odd[groups.first(node) as usize] = true;
    }
    // By group: the part it became, from 1 on.
    let mut part_of = vec![0_u32; nodes + cuts.parent.len()];
    let mut parts: Vec<Part> = Vec::new();
    for &id in &edges {
        let group = groups.first(graph.edges[id as usize].a) as usize;
        if is_odd[group] {
            if part_of[group] == 0 {
                parts.push(Part::default());
                part_of[group] = parts.len() as u32;
            }
            parts[part_of[group] as usize - 1].edges.push(id);
        }
    }
    for set in 0..cuts.parent.len() as u32 {
        let part = part_of[groups.first(nodes as u32 + set) as usize];
        if part > 0 {
            parts[part as usize - 1].sets.push(set);
        }
    }
    packed(parts, rows)
}

/// Neighbours in the list in one, as long as they have no more than `rows` rows together.
fn packed(parts: Vec<Part>, rows: usize) -> Vec<Part> {
    let mut all: Vec<Part> = Vec::new();
    for part in parts {
        match all.last_mut() {
            Some(last) if last.sets.len() + part.sets.len() <= rows => {
                last.edges.extend(part.edges);
                last.sets.extend(part.sets);
            }
            _ => all.push(part),
        }
    }
    for part in &mut all {
        part.edges.sort_unstable();
        part.sets.sort_unstable();
    }
    all
}
