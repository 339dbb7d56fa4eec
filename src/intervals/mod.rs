//! Partition + SizeWish -> Goals: wished real counts, bounds and costs, a curve each.
//!
//! # Promises
//! 1. `1 <= lower <= upper` on every curve, and `lower` is at least the number of its edges: each
//!    node of the arrangement is a mesh node, so each edge carries at least one interval.
//! 2. `lower == upper` only where every edge of the curve is a seam on the lattice: parity can
//!    change any other curve by one, up or down from some count within its bounds.
//! 3. Every sub-domain's lower bounds sum to at least 4, a free line counted twice; a sub-domain
//!    with one walk of two or three corners has at least 2 on each side, so that no corner's
//!    element is flat (where a side is a part of one curve: on the curve as a whole). The wide end of a
//!    long tip may have 1 (`rungs::ONE_ROW`, `rungs::LONG`).
//! 4. Goals and bounds depend on a curve, its two sub-domains, the lines at its ends and the sizes, on
//!    nothing else.
//! 5. A rung beside a line whose kind wishes several rows has that many intervals at least, as far
//!    as each is [`Options::least_edge`] long.
//!
//! # Needs
//! A cleaned arrangement and its partition (`partition::check`); positive sizes.
//!
//! # Method
//! 1. `wish`: an edge's goal is its length over its size, the smallest among the kinds of its
//!    pieces (the default along seams). A straight seam between lattice nodes is fixed.
//! 2. `minima` over `sides`: the least counts that a shape needs, folded into the bounds of its longest curves,
//!    so that parity stays a minimum-weight T-join and needs no rows of another kind. A fold is
//!    sufficient, not necessary: it may forbid a split that another share of the side would allow.
//! 3. `rows`: what kinds of lines wish in narrow places becomes a lower bound of rungs.
//! 4. `blocks`: the sub-domains with three to six sides, whose counts `parity` wishes to fit one
//!    pattern, because mapped patches are the best ones. Corners as mapping chooses them. `submaps`: those
//!    with re-entrant corners, houses and free lines, whose walks nearly close on a lattice.
//! 5. Costs are those of [`Goals::cost`]: convex, relative, zero at the goal. `apportion` says what
//!    one more interval costs on the edge of a curve that can best take it: the curve's weight.
//!    So the odd interval that parity asks for goes to long edges, never to one below the size if
//!    there is a way around it; nor, by `narrow`, to one along a narrow sub-domain.
//!
//! # Cost
//! O(edges + half-curves), 24 bytes a curve.
//!
//! # Not here
//! Which counts are chosen (`parity`); where the nodes lie (`boundary`).

use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::intervals::goals::Goals;
use crate::intervals::wish::EdgeWish;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::Curve;
use crate::partition::subdomains::Partition;

pub mod apportion;
mod blocks;
pub mod check;
pub mod goals;
mod minima;
mod narrow;
mod rows;
mod sides;
mod submaps;
pub mod wish;

/// How goals and bounds are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// A walk turns at a corner if its direction changes by more than this, degrees.
    pub corner_deg: f64,
    /// Largest count over goal, above 1; three more are always allowed, so that short curves are
    /// free to change parity.
    pub upper_ratio: f64,
    /// A sub-domain may be a block if its wishes miss a pattern at most by this ratio of its least
    /// side (or by one interval). Measured from 1.25 to 2.2: irregular nodes of jittered blocks fall from
    /// 1.5 to .2 %, those of twelve cities by up to .2 points; the programme takes a fifth longer.
    pub block_ratio: f64,
    /// Places with several rows by wish keep each row at least this wide, sizes.
    pub least_edge: f64,
}

/// The goals of all curves.
pub fn plan(
    domain: &Domain,
    sizes: &SizeWish,
    arrangement: &Arrangement,
    partition: &Partition,
    options: &Options,
) -> Goals {
    let mut goals = Goals::default();
    let wishes = |curve: &Curve| -> Vec<EdgeWish> {
        (curve.edges.iter())
            .map(|&edge| wish::edge_wish(domain, sizes, arrangement, edge))
            .collect()
    };
    for curve in &partition.curves {
        push_curve(&mut goals, &wishes(curve), options);
    }
    minima::raise(&mut goals, arrangement, partition, options);
    rows::raise(&mut goals, domain, sizes, arrangement, partition, options);
    for (id, curve) in partition.curves.iter().enumerate() {
        goals.weight[id] = weight(&goals, id, &wishes(curve));
    }
    narrow::raise(&mut goals, sizes, partition);
    goals.blocks = blocks::blocks(&goals, arrangement, partition, options);
    goals
}

fn push_curve(goals: &mut Goals, edges: &[EdgeWish], options: &Options) {
    let lower: u32 = edges.iter().map(|edge| edge.lower).sum();
    let fixed: u32 = edges.iter().filter_map(EdgeWish::fixed).sum();
    let all_fixed = edges.iter().all(|edge| edge.fixed().is_some());
    let free_goal: f64 = (edges.iter())
        .filter(|edge| edge.fixed().is_none())
        .map(|edge| edge.goal)
        .sum();
    let wide = fixed + (options.upper_ratio * free_goal).ceil() as u32 + 3;
    goals.goal.push(f64::from(fixed) + free_goal);
    goals.lower.push(lower);
    (goals.upper).push(if all_fixed {
        lower
    } else {
        wide.max(lower + 3)
    });
    goals.weight.push(1.0);
}

/// How much dearer one more interval is than the curve's goal tells: the sum of the goals of short
/// edges knows nothing of how short each is.
fn weight(goals: &Goals, curve: usize, edges: &[EdgeWish]) -> f64 {
    let lower = goals.lower[curve];
    let near = (goals.goal[curve].round() as u32).clamp(lower, goals.upper[curve]);
    let told = goals.deviation(curve, near + 1) - goals.deviation(curve, near);
    apportion::next_cost(edges, near).map_or(1.0, |asked| (asked / told).clamp(1.0, WEIGHT_MAX))
}

/// Keeps sums of costs in whole units within 64 bits, whatever the input.
const WEIGHT_MAX: f64 = 1e3;
