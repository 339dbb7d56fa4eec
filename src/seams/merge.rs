//! Cells between candidates -> parts.

use std::collections::BTreeMap;
use std::collections::BTreeSet;

/// A candidate between two cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Border {
    pub cells: [u32; 2],
    /// What it costs to keep.
    pub price: f64,
}

/// A part below this share of the budget may make its neighbour larger than the budget.
const SMALL: f64 = 0.25;

/// For each cell, the part that it belongs to: a cell of it.
///
/// The smallest part joins the neighbour with which it shares the costliest borders, if both fit
/// the budget; and so on until nothing fits. Parts only grow, so what does not fit never will.
pub(super) fn merge(quads: &[f64], borders: &[Border], budget: f64, slack: f64) -> Vec<u32> {
    let mut parts = Parts::of(quads, borders);
    // Positive floats sort like their bits.
    let mut by_size: BTreeSet<(u64, u32)> = (0..quads.len() as u32)
        .map(|cell| (quads[cell as usize].to_bits(), cell))
        .collect();
    while let Some((_, part)) = by_size.pop_first() {
        let size = parts.quads[part as usize];
        let limit = if size < SMALL * budget { slack } else { 1.0 } * budget;
        let Some(other) = parts.best_neighbour(part, budget, limit) else {
            continue;
        };
        by_size.remove(&(parts.quads[other as usize].to_bits(), other));
        let joined = parts.join(part, other);
        by_size.insert((parts.quads[joined as usize].to_bits(), joined));
    }
    (0..quads.len() as u32)
        .map(|cell| parts.root(cell))
        .collect()
}

struct Parts {
    parent: Vec<u32>,
    quads: Vec<f64>,
    /// Price of all borders with each neighbour.
    neighbours: Vec<BTreeMap<u32, f64>>,
}

impl Parts {
    fn of(quads: &[f64], borders: &[Border]) -> Parts {
        let mut neighbours = vec![BTreeMap::new(); quads.len()];
        for Border {
            cells: [a, b],
            price,
        } in borders
        {
            if a != b {
                *neighbours[*a as usize].entry(*b).or_insert(0.0) += price;
                *neighbours[*b as usize].entry(*a).or_insert(0.0) += price;
            }
        }
        Parts {
            parent: (0..quads.len() as u32).collect(),
            quads: quads.to_vec(),
            neighbours,
        }
    }

    fn root(&self, mut cell: u32) -> u32 {
        while self.parent[cell as usize] != cell {
            cell = self.parent[cell as usize];
        }
        cell
    }

    /// The neighbour with the costliest borders among those that fit the budget or else the limit.
    fn best_neighbour(&self, part: u32, budget: f64, limit: f64) -> Option<u32> {
        let fitting = |most: f64| {
            (self.neighbours[part as usize].iter())
                .filter(|(other, _)| {
                    self.quads[part as usize] + self.quads[**other as usize] <= most
                })
                .max_by(|(a, p), (b, q)| p.total_cmp(q).then(b.cmp(a)))
                .map(|(&other, _)| other)
        };
        fitting(budget).or_else(|| fitting(limit))
    }

    /// Joins two neighbours, the one with fewer neighbours into the other.
    fn join(&mut self, a: u32, b: u32) -> u32 {
        let count = |part: u32| self.neighbours[part as usize].len();
        let (kept, gone) = if count(a) < count(b) { (b, a) } else { (a, b) };
        self.parent[gone as usize] = kept;
        self.quads[kept as usize] += self.quads[gone as usize];
        for (other, price) in std::mem::take(&mut self.neighbours[gone as usize]) {
            self.neighbours[other as usize].remove(&gone);
            if other != kept {
                *self.neighbours[kept as usize].entry(other).or_insert(0.0) += price;
                *self.neighbours[other as usize].entry(kept).or_insert(0.0) += price;
            }
        }
        kept
    }
}
