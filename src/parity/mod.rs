//! Goals -> Counts: the one global integer linear programme that makes every sub-domain even.
//!
//! An all-quad mesh of a sub-domain exists only if the intervals on all its walks together are
//! even. Every curve is shared, so evenness couples the whole city:
//!
//! ```text
//! minimise  sum over curves c of cost_c(n_c)           cost_c convex, least near the goal
//! subject to  lower_c <= n_c <= upper_c,  n_c whole
//!             sum over curves c around f of n_c  is even       for every sub-domain f
//! ```
//!
//! # Promises
//! 1. Every sub-domain is even, every count is within its bounds.
//! 2. The optimum is proven: `bound` is recomputed by [`check`](check::check) from the stored
//!    certificate alone, in whole numbers; `proven` means that the two are equal. What `counts`
//!    cost beyond it is spent on equal opposite sides, and said (`objective - optimum`).
//! 3. Same goals, same counts: HiGHS runs with one thread and a fixed seed, limits count work.
//! 4. No solution is an [`Error`](error::Error) that names the sub-domains.
//!
//! # Needs
//! Goals of `intervals`; a partition (only which sub-domains lie left and right of each curve is
//! read: parity never sees a point). Less than 2^32 - 2 sub-domains.
//!
//! # Method
//! 1. `programme`, exact: each curve starts at its cheapest count n0. Only parity matters beyond
//!    that, and by convexity the best count of other parity is n0 - 1 or n0 + 1. With w_c >= 0 what
//!    that costs more and T the sub-domains that n0 leaves odd, what remains is to choose curves
//!    that change parity: a **minimum-weight T-join** of the dual graph (sub-domains are nodes,
//!    curves edges, the outside absorbs any parity). Free lines count twice and drop out, fixed
//!    counts have no edge, of parallel edges the cheapest stays.
//! 2. `matching` on `flood`: exact primal and dual at once. All odd sub-domains flood the graph at
//!    the same time; floods that meet are matched, re-matched along alternating trees, wrapped into
//!    blossoms. This is the sparse blossom algorithm (Higgott and Gidney 2023, after Edmonds
//!    1965), written for what it was not meant for, costs of city networks with half of all nodes
//!    odd: work stays local because a flood rarely goes farther than a few sub-domains.
//! 3. `cuts`: the radii of the floods are the duals of the odd-cut rows `x(cut(S)) >= 1` for sets S
//!    with an odd number of odd sub-domains, which describe the T-join polyhedron exactly (Edmonds
//!    and Johnson 1973). They are the certificate.
//! 4. `join`: the matched pairs' shortest paths are the T-join.
//! 5. `solver`: HiGHS solves the linear programme of those rows, thinned by reduced cost (what costs more
//!    than the gap is in no better solution) and cut into `parts` that share nothing. Where its solution
//!    leaves a group of sub-domains odd, that row is added and it goes on from its basis; what is in
//!    pieces then goes to branch and bound, which starts from the matching's choice. Its optimum is the
//!    bound, its choice the counts; the certificate says the same in whole numbers, and has the last
//!    word. Parts of more than `rows_max` rows stay as the matching left them (none below 100 thousand
//!    sub-domains, a fifth of all rows at a million). Without the matching's rows HiGHS has no chance:
//!    the plain form does not see parity (at 10 000 sub-domains it finds nothing in two minutes).
//! 6. `structure`: cost and the patterns' price together; see below.
//! 7. `keep`, if there are earlier counts: they stay where others are hardly better; see below.
//!
//! If the limit of work ends step 2 early, its radii are still feasible duals: the bound stays
//! valid, a spanning forest over the edges of least slack gives the choice, the gap is reported.
//!
//! Costs are rounded to whole millionths first ([`programme::COST_UNIT`]); the programme is solved
//! exactly in those.
//!
//! # Patterns
//! A *block* is a sub-domain with three to six sides, each of one curve or several. One pattern can
//! mesh it (a grid, or a star with one irregular node) if the totals N of its sides satisfy rules
//! `a_r N + b_r <= 0` ([`rules`](crate::intervals::goals::rules)), and, with four or six sides, if
//! every other side has an even total. (A sub-domain of any shape whose walks should close on a lattice
//! is a block of four sides, too: the directions there.) With a price `p` for each unit of the largest
//! excess (`Options::worth`, in tiny blocks [more](crate::intervals::goals::Goals::block_weight)), the
//! programme becomes
//!
//! ```text
//! minimise  sum of cost_c(n_c) + sum over blocks f of
//!                 p_f x max(0, a_r N_f + b_r over rules r of f, [every other side of f odd])
//! ```
//!
//! which is no T-join any more, but nearly:
//! - `tilts`, exact: for any multipliers u_r >= 0 that sum to at most p_f in each block, the price of
//!   f is at least `sum u_r (a_r N_f + b_r) + (p_f - sum u_r) [odd]`. The first part only tilts
//!   the costs of curves, which stay convex; the second is an edge between the two halves that f is
//!   split into. So a T-join on the split graph bounds cost *and* price of all counts, and
//!   certifies it in whole numbers: multipliers and cuts are stored, `check` recomputes the bound.
//! - `relaxation`: the first multipliers are nearly the best ones without parity. The Lagrangian then
//!   falls apart into curves, and its dual function, made smooth, is climbed by projected gradients
//!   with momentum: 180 passes over the blocks take as long as two T-joins. The bound that it begins
//!   with is that of the linear programme, which took HiGHS' interior point twenty times as long.
//! - `structure`, heuristic in how fast, exact in what it claims: from there the multipliers climb along
//!   averaged subgradients of the T-join bound, with the stride of Polyak in a metric of the blocks'
//!   own: an excess of one moves a block as far as its curves give way. The maximum is the linear
//!   programme with all odd-cut rows of all roundings, which nobody could write down.
//! - `draft`, heuristic: each T-join's counts, mended by moves of two along rows of curves, are
//!   candidates. Near the top the T-join obeys nearly all rules by itself, so little is to mend.
//! - `solver` again, at the best multipliers: what HiGHS finds is the bound, and one more candidate.
//! - `neighbourhoods` with `solver_rules`, where the gap is still too wide: where the best counts exceed what
//!   the bound accounts for, HiGHS solves some forty sub-domains exactly, all others held.
//!
//! What is proven of `counts` is [`Balance::structure_gap`].
//!
//! # Cost
//! Near-linear in curves; about 240 bytes a curve at the peak. Parity alone is one matching and HiGHS'
//! turn: proven optimal in 0.1 s of CPU for 10 thousand sub-domains, 1 to 22 s for 100 thousand (20 of
//! them HiGHS on one part of 52 thousand rows), 13 to 24 s for a million. Patterns are some four to
//! eight more on the same graph and the relaxation, which is worth two of them. `benches/README.md` has
//! the measurements, HiGHS on the plain form beside them.
//!
//! # Stability
//! One moved line changes few counts far away, but not none: the optimum is one of the whole city, and
//! where half of all sub-domains are odd a chain of exchanges that cost next to nothing may go far.
//! Of real curves more than five sub-domains away from a moved line two in a thousand change, five
//! at worst (bench `stability`), with patterns or without, which no small price undoes, as clean-up bends lines
//! that far. Goals and costs are local (`intervals`).
//!
//! With earlier counts ([`balance_near`]) each curve keeps its own or takes the best one, and a change
//! has a price of 0.02: one more T-join, on the curves whose parity differs (`keep`). So no chain goes
//! far for nothing; what is chosen costs at most 0.02 a kept curve more than the best, and `bound` says
//! how near it is.
//!
//! # Sources
//! Edmonds and Johnson (1973) for T-joins; Higgott and Gidney (2023) for sparse blossom; Held and Karp
//! (1971) and Polyak (1969) for multipliers that climb; Nesterov (1983, 2005) for the smooth start; Tarini (2021) and Takayama and others
//! (2014) for the patterns. Interval assignment as bi-directed flow (Mitchell 2013; Heistermann,
//! Warnett, Bommes 2023) has the same rules as equations of chords; the price here is their excess,
//! so that what is left after the relaxation stays a T-join.
//!
//! # Not here
//! Minima by shape are bounds already (`intervals`).

use crate::intervals::goals::Goals;
use crate::parity::balance::Balance;
use crate::parity::balance::Solved;
use crate::parity::cuts::Cuts;
use crate::parity::error::Error;
use crate::parity::graph::Graph;
use crate::parity::matching::Matching;
use crate::parity::programme::COST_UNIT;
use crate::parity::programme::Programme;
use crate::parity::programme::total_units;
use crate::parity::programme::units;
use crate::partition::subdomains::Partition;

mod around;
pub mod balance;
pub mod check;
pub mod cuts;
mod draft;
pub mod error;
mod flood;
pub mod graph;
mod groups;
mod join;
mod keep;
mod matching;
mod neighbourhoods;
mod parts;
pub mod programme;
mod relaxation;
mod solver;
mod solver_rules;
mod structure;
mod tilts;

/// Limits of work: never seconds, so that two runs are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Queue entries that the matching may handle; it needs 10 to 30 a curve.
    pub events_max: u64,
    /// Branch-and-bound nodes of HiGHS in each part.
    pub nodes_max: i32,
    /// Rows of a part up to which HiGHS is asked; above, its certified matching stands alone.
    pub rows_max: u32,
    /// Price of a pattern's excess of one between full-size edges, in the unit of costs, the relative
    /// deviation of one curve. 0: parity alone.
    pub worth: f64,
    /// Rounds of moves for the sake of patterns; most pay in the first three.
    pub rounds_max: u32,
    /// T-joins that the bound of cost and price may take until the gap is enough; five times as many
    /// until it is twice that.
    pub climb_max: u32,
    /// Gap of cost and price together at which the search for patterns ends.
    pub gap_enough: f64,
    /// Neighbourhoods that HiGHS may improve.
    pub neighbourhoods_max: u32,
}

/// Chooses the number of intervals of every curve.
pub fn balance(partition: &Partition, goals: &Goals, options: &Options) -> Result<Balance, Error> {
    balance_near(partition, goals, &[], options)
}

/// The same near earlier counts: those of `previous` stay where others are hardly better. Empty, or
/// one a curve.
pub fn balance_near(
    partition: &Partition,
    goals: &Goals,
    previous: &[Option<u32>],
    options: &Options,
) -> Result<Balance, Error> {
    let programme = Programme::new(partition, goals, None)?;
    let base = programme.base;
    let graph = &programme.graph;
    let (join, solved) = solve(
        graph,
        base,
        minimum_join(graph, options.events_max),
        options,
    );
    let mut balance = Balance {
        events: join.events,
        solved,
        ..Balance::default()
    };
    let even = programme.counts(&join.chosen);
    let optimum = total_units(goals, &even);
    let bound = base + (join.cuts.bound2() + 1) / 2;
    balance.base = base as f64 * COST_UNIT;
    balance.optimum = optimum as f64 * COST_UNIT;
    balance.bound = bound as f64 * COST_UNIT;
    balance.proven = optimum == bound;
    balance.odd_subdomains = graph.odd.iter().filter(|odd| **odd).count() as u32;
    balance.cuts = join.cuts;
    let (mut structure, mut counts) =
        structure::fit_patterns(partition, goals, base, even, options)?;
    if !previous.is_empty() {
        counts = keep::keep(partition, goals, units(options.worth), &counts, previous);
        structure.appraise(partition, goals, &counts);
    }
    balance.structure = structure;
    Ok(balance.with_counts(goals, counts))
}

/// A choice of edges after which every node is even, and how far from the least it can be.
pub struct Join {
    /// By edge of the graph.
    pub chosen: Vec<bool>,
    /// The proof: half of the values' sum is a lower bound on any choice's weight.
    pub cuts: Cuts,
    /// Work done.
    pub events: u64,
}

impl Join {
    /// Weight of the choice.
    pub fn weight(&self, graph: &Graph) -> i64 {
        weight(graph, &self.chosen)
    }
}

/// A minimum-weight T-join of any graph that is not [`hopeless`](Graph::hopeless), T its odd nodes.
pub fn minimum_join(graph: &Graph, events_max: u64) -> Join {
    let matching = Matching::solve(graph, events_max);
    let cuts = Cuts::of(&matching.flood, graph.odd.len());
    let chosen = match matching.open {
        0 => join::along_pairs(graph, &cuts, &matching.pairs()),
        _ => join::along_forest(graph, &cuts),
    };
    let events = matching.flood.events;
    assert!(makes_even(graph, &chosen), "a T-join leaves no odd node");
    Join {
        chosen,
        cuts,
        events,
    }
}

/// The same as HiGHS solves it from `join`: its choice, if that is even and no dearer. `base` is what
/// is decided outside, for what it claims.
pub fn solve(graph: &Graph, base: i64, mut join: Join, options: &Options) -> (Join, Solved) {
    let gap2 = 2 * join.weight(graph) - join.cuts.bound2();
    let (taken, mut solved) = solver::solve(graph, &join.cuts, &join.chosen, gap2, options);
    solved.claimed = (solved.claimed).map(|claimed| (base as f64 + claimed) * COST_UNIT);
    if let Some(chosen) = join::within(graph, &join.cuts, &taken)
        && weight(graph, &chosen) <= join.weight(graph)
    {
        join.chosen = chosen;
    }
    assert!(
        makes_even(graph, &join.chosen),
        "a T-join leaves no odd node"
    );
    (join, solved)
}

fn weight(graph: &Graph, chosen: &[bool]) -> i64 {
    let edges = graph.edges.iter().zip(chosen);
    edges
        .filter(|(_, chosen)| **chosen)
        .map(|(edge, _)| edge.weight)
        .sum()
}

fn makes_even(graph: &Graph, chosen: &[bool]) -> bool {
    let mut odd = graph.odd.clone();
    for (edge, _) in graph
        .edges
        .iter()
        .zip(chosen)
        .filter(|(_, chosen)| **chosen)
    {
        for node in [edge.a, edge.b] {
            if node != graph::OUTSIDE {
                odd[node as usize] ^= true;
            }
        }
    }
    !odd.contains(&true)
}
