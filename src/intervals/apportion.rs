//! The count of a curve -> the counts of its edges.

use crate::intervals::wish::EdgeWish;
use std::cmp::Ordering;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The cheapest counts of `edges` that sum to `count`; ties go to the earlier edge.
///
/// Panics if the bounds of the edges do not allow `count`.
pub fn apportion(edges: &[EdgeWish], count: u32) -> Vec<u32> {
    let mut shares: Vec<u32> = edges.iter().map(|edge| edge.lower).collect();
    let given: u32 = shares.iter().sum();
    assert!(
        given <= count,
        "{count} intervals on edges that need {given}"
    );
    let mut left = count - given;
    let open = |k: usize, share: u32| share < edges[k].upper;
    if let [only] = (0..edges.len())
        .filter(|&k| open(k, shares[k]))
        .collect::<Vec<_>>()[..]
    {
        shares[only] += left;
        left = 0;
    }
    let mut next: BinaryHeap<Reverse<Step>> = (0..edges.len())
        .filter(|&k| left > 0 && open(k, shares[k]))
        .map(|k| Reverse(Step::new(edges, k, shares[k])))
        .collect();
    while left > 0 {
        let Reverse(step) = next.pop().expect("an edge that may have more intervals");
        let k = step.edge;
        shares[k] += 1;
        left -= 1;
        if open(k, shares[k]) {
            next.push(Reverse(Step::new(edges, k, shares[k])));
        }
    }
    shares
}

/// Intervals more than this many times shorter than wished rule a solver's time step. (Measured on
/// five cities: 1.3 does no better, and the fourth power for all makes more irregular nodes.)
const TINY: f64 = 1.8;

/// What `share` intervals cost on an edge: the square of how many times too short or too long they
/// are, and the fourth power where they are tiny. To halve an edge that is short already costs far
/// more than to halve a long one; parity rather takes a longer way around.
fn cost(edge: &EdgeWish, share: u32) -> f64 {
    let share = f64::from(share);
    let (short, long) = (share / edge.goal, edge.goal / share);
    short.max(long).powi(2) * (short / TINY).max(1.0).powi(2)
}

/// What the cheapest edge asks for one more interval when the curve has `count`; `None` if no edge
/// may have one more.
pub fn next_cost(edges: &[EdgeWish], count: u32) -> Option<f64> {
    let shares = apportion(edges, count);
    (edges.iter().zip(shares))
        .filter(|&(edge, share)| share < edge.upper)
        .map(|(edge, share)| cost(edge, share + 1) - cost(edge, share))
        .min_by(f64::total_cmp)
}

/// One more interval on an edge, ordered by what it costs, then by the edge.
struct Step {
    cost: f64,
    edge: usize,
}

impl Step {
    fn new(edges: &[EdgeWish], edge: usize, share: u32) -> Step {
        Step {
            cost: cost(&edges[edge], share + 1) - cost(&edges[edge], share),
            edge,
        }
    }
}

impl Ord for Step {
    fn cmp(&self, other: &Step) -> Ordering {
        (self.cost.total_cmp(&other.cost)).then(self.edge.cmp(&other.edge))
    }
}

impl PartialOrd for Step {
    fn partial_cmp(&self, other: &Step) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Step {
    fn eq(&self, other: &Step) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Step {}
