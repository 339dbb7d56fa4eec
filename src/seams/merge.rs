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

    /// The neighbour with the costliest borders among those that fit the budget or else the limit;
    /// of several (on a raster, many) the smallest, so that parts become round.
    fn best_neighbour(&self, part: u32, budget: f64, limit: f64) -> Option<u32> {
        let fitting = |most: f64| {
            (self.neighbours[part as usize].iter())
                .filter(|(other, _)| {
                    self.quads[part as usize] + self.quads[**other as usize] <= most
                })
                .max_by(|(a, p), (b, q)| {
                    let size = |part: u32| self.quads[part as usize];
                    (p.total_cmp(q))
                        .then(size(**b).total_cmp(&size(**a)))
                        .then(b.cmp(a))
                })
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

#[cfg(test)]
mod tests {
    use super::Border;
    use super::merge;
    use proptest::prelude::*;

    proptest! {
        /// No part is above the limit, all are connected, and no two neighbours fit one budget.
        #[test]
        fn parts_fit_and_are_maximal(
            quads in prop::collection::vec(1.0..300.0, 1..40),
            pairs in prop::collection::vec((0..40u32, 0..40u32, 0.0..3.0), 0..100),
        ) {
            let n = quads.len() as u32;
            let borders: Vec<Border> = (pairs.iter())
                .map(|&(a, b, price)| Border { cells: [a % n, b % n], price })
                .collect();
            let part = merge(&quads, &borders, 1000.0, 1.5);
            let mut size = vec![0.0; quads.len()];
            for cell in 0..quads.len() {
                size[part[cell] as usize] += quads[cell];
            }
            prop_assert!(size.iter().all(|&size| size <= 1500.0));
            // Flood inside the parts: as many floods as parts.
            let mut label: Vec<u32> = (0..n).collect();
            for _ in 0..n {
                for Border { cells: [a, b], .. } in &borders {
                    let (a, b) = (*a as usize, *b as usize);
                    if part[a] == part[b] {
                        let least = label[a].min(label[b]);
                        (label[a], label[b]) = (least, least);
                    } else {
                        let sum = size[part[a] as usize] + size[part[b] as usize];
                        prop_assert!(sum > 1000.0);
                    }
                }
            }
            let count = |mut ids: Vec<u32>| {
                ids.sort_unstable();
                ids.dedup();
                ids.len()
            };
            prop_assert_eq!(count(label), count(part));
        }
    }
}
