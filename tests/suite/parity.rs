//! Tests of `parity`.

use polder::intervals::goals::Block;
use polder::intervals::goals::Goals;
use polder::parity;
use polder::parity::Options;
use polder::parity::balance::Balance;
use polder::parity::check::check;
use polder::parity::error::Error;
use polder::parity::graph::Edge;
use polder::parity::graph::Graph;
use polder::parity::programme::COST_UNIT;
use polder::parity::programme::cost_units;
use polder::partition::subdomains::Curve;
use polder::partition::subdomains::OUTSIDE;
use polder::partition::subdomains::Partition;
use polder::partition::subdomains::Subdomain;
use polder::partition::subdomains::SubdomainId;
use proptest::prelude::*;

const OPTIONS: Options = Options {
    events_max: u64::MAX,
    nodes_max: 100,
    rows_max: 60_000,
    worth: 0.0,
    rounds_max: 20,
    climb_max: 60,
    gap_enough: 5e-4,
    neighbourhoods_max: 20,
};

/// A partition as parity sees it: only the sides of curves.
fn partition(subdomains: usize, sides: &[(SubdomainId, SubdomainId)]) -> Partition {
    let curve = |(k, &(left, right)): (usize, &(SubdomainId, SubdomainId))| Curve {
        nodes: vec![0, 1],
        edges: vec![k as u32],
        left,
        right,
        is_seam: false,
    };
    Partition {
        curves: sides.iter().enumerate().map(curve).collect(),
        subdomains: vec![Subdomain::default(); subdomains],
    }
}

fn goals(goal: &[f64], spread: u32) -> Goals {
    Goals {
        goal: goal.to_vec(),
        lower: vec![1; goal.len()],
        upper: goal.iter().map(|g| g.ceil() as u32 + spread).collect(),
        weight: vec![1.0; goal.len()],
        blocks: Vec::new(),
    }
}

fn balanced(partition: &Partition, goals: &Goals) -> Balance {
    let made = parity::balance(partition, goals, &OPTIONS).unwrap();
    check(partition, goals, &made).unwrap();
    made
}

/// A deterministic stream of numbers in [0, 1).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.roll() * n as f64) as usize
    }
}

/// A street grid of `side` x `side` blocks, some merged with their eastern neighbour.
fn city(side: usize, seed: u64) -> (Partition, Goals) {
    let mut dice = Dice(seed);
    let mut block: Vec<SubdomainId> = Vec::new();
    for k in 0..side * side {
        let merged = k % side > 0 && dice.roll() < 0.15;
        let last = block.last().copied();
        block.push(match last {
            Some(last) if merged => last,
            Some(last) => last + 1,
            None => 0,
        });
    }
    let (mut sides, mut goal) = (Vec::new(), Vec::new());
    let at = |x: usize, y: usize| match x < side && y < side {
        true => block[y * side + x],
        false => OUTSIDE,
    };
    for y in 0..side {
        for x in 0..side {
            let mut street = |a, b| {
                if a != b {
                    sides.push((a, b));
                    goal.push(1.0 + 9.0 * dice.roll());
                }
            };
            street(at(x, y), at(x + 1, y));
            street(at(x, y), at(x, y + 1));
            if x == 0 {
                street(at(x, y), OUTSIDE);
            }
            if y == 0 {
                street(at(x, y), OUTSIDE);
            }
        }
    }
    let subdomains = block[side * side - 1] as usize + 1;
    (partition(subdomains, &sides), goals(&goal, 3))
}

/// `side` x `side` blocks, all of them four-sided with one curve a side.
fn blocks(side: usize, seed: u64) -> (Partition, Goals) {
    let mut dice = Dice(seed);
    let across = side * (side + 1);
    let at = |x: usize, y: usize| match x < side && y < side {
        true => (y * side + x) as SubdomainId,
        false => OUTSIDE,
    };
    // Streets from west to east, then from south to north.
    let (mut sides, mut goal) = (Vec::new(), Vec::new());
    for k in 0..2 * across {
        let (x, y) = (k % across % side, k % across / side);
        sides.push(match k < across {
            true => (at(x, y), if y == 0 { OUTSIDE } else { at(x, y - 1) }),
            false => (at(y, x), if y == 0 { OUTSIDE } else { at(y - 1, x) }),
        });
        goal.push(3.0 + dice.roll());
    }
    let mut g = goals(&goal, 3);
    for id in 0..side * side {
        let (x, y) = (id % side, id / side);
        let street = |x: usize, y: usize| vec![(y * side + x) as u32];
        let avenue = |x: usize, y: usize| vec![(across + x * side + y) as u32];
        g.blocks.push(Block {
            subdomain: id as u32,
            sides: vec![
                street(x, y),
                avenue(x + 1, y),
                street(x, y + 1),
                avenue(x, y),
            ],
        });
    }
    (partition(side * side, &sides), g)
}

/// Price of unequal opposite sides at a worth of 1.
fn price(goals: &Goals, counts: &[u32]) -> f64 {
    let larger = |block: &Block| {
        let [a, b, c, d, ..] = block.totals(|curve| f64::from(counts[curve]));
        (a - c).abs().max((b - d).abs())
    };
    goals.blocks.iter().map(larger).sum()
}

/// The slow twin: all counts within bounds.
fn brute_force(partition: &Partition, goals: &Goals) -> Option<i64> {
    fn dive(
        partition: &Partition,
        goals: &Goals,
        curve: usize,
        odd: u32,
        cost: i64,
        best: &mut Option<i64>,
    ) {
        if curve == partition.curves.len() {
            if odd == 0 && best.is_none_or(|least| cost < least) {
                *best = Some(cost);
            }
            return;
        }
        for n in goals.lower[curve]..=goals.upper[curve] {
            let mut odd = odd;
            for side in [partition.curves[curve].left, partition.curves[curve].right] {
                if side != OUTSIDE && n % 2 == 1 {
                    odd ^= 1 << side;
                }
            }
            let cost = cost + cost_units(goals, curve, n);
            dive(partition, goals, curve + 1, odd, cost, best);
        }
    }
    let mut best = None;
    dive(partition, goals, 0, 0, 0, &mut best);
    best
}

/// The repair that everyone would write: round, then flip along a minimum spanning tree.
fn spanning_tree(graph: &Graph) -> i64 {
    let n = graph.odd.len();
    let node = |id: u32| (id as usize).min(n);
    let mut order: Vec<&Edge> = graph.edges.iter().collect();
    order.sort_by_key(|edge| edge.weight);
    let mut group: Vec<usize> = (0..=n).collect();
    let mut tree: Vec<(usize, usize, i64)> = Vec::new();
    for edge in order {
        let (a, b) = (group[node(edge.a)], group[node(edge.b)]);
        if a != b {
            group
                .iter_mut()
                .filter(|it| **it == a)
                .for_each(|it| *it = b);
            tree.push((node(edge.a), node(edge.b), edge.weight));
        }
    }
    let mut odd: Vec<bool> = graph.odd.iter().copied().chain([false]).collect();
    let mut total = 0;
    // Leaves off, one after the other; the outside stays.
    while !tree.is_empty() {
        let mut degree = vec![0; n + 1];
        for &(a, b, _) in &tree {
            degree[a] += 1;
            degree[b] += 1;
        }
        tree.retain(|&(a, b, weight)| {
            let leaf = [a, b].into_iter().find(|&v| degree[v] == 1 && v != n);
            let Some(leaf) = leaf else { return true };
            let other = a + b - leaf;
            if odd[leaf] {
                odd[leaf] = false;
                odd[other] ^= true;
                total += weight;
            }
            degree[other] -= 1;
            false
        });
    }
    total
}

/// Checks a join of any graph: even, and proven optimal by its own certificate.
fn join_weight(graph: &Graph) -> i64 {
    let join = parity::minimum_join(graph, u64::MAX);
    let least = graph.edges.iter().map(|edge| join.cuts.slack2(edge)).min();
    assert!(
        least.is_none_or(|least| least >= 0),
        "an edge pays {least:?} too much"
    );
    assert_eq!(2 * join.weight(graph), join.cuts.bound2());
    join.weight(graph)
}

fn random_graph(dice: &mut Dice, nodes: usize, edges: usize, weights: usize) -> Graph {
    let odd = (0..nodes).map(|_| dice.roll() < 0.5).collect();
    let edges = (0..edges)
        .map(|label| {
            let end = |dice: &mut Dice| match dice.below(nodes + 1) {
                node if node < nodes => node as u32,
                _ => parity::graph::OUTSIDE,
            };
            let (a, b) = (end(dice), end(dice));
            let weight = dice.below(weights) as i64;
            Edge {
                a,
                b,
                weight,
                label: label as u32,
            }
        })
        .collect();
    Graph::new(odd, edges)
}

/// All choices of edges.
fn least_choice(graph: &Graph) -> Option<i64> {
    let n = graph.odd.len();
    let bit = |node: u32| {
        if (node as usize) < n {
            1_u64 << node
        } else {
            0
        }
    };
    let start: u64 = (0..n).filter(|&v| graph.odd[v]).map(|v| 1 << v).sum();
    (0_u32..1 << graph.edges.len())
        .filter_map(|choice| {
            let (mut odd, mut weight) = (start, 0);
            for (k, edge) in graph.edges.iter().enumerate() {
                if choice >> k & 1 == 1 {
                    odd ^= bit(edge.a) ^ bit(edge.b);
                    weight += edge.weight;
                }
            }
            (odd == 0).then_some(weight)
        })
        .min()
}

#[test]
fn one_triangle_between_two_others() {
    let p = partition(1, &[(0, OUTSIDE), (0, OUTSIDE), (0, OUTSIDE)]);
    let made = balanced(&p, &goals(&[3.1, 4.4, 2.0], 3));
    assert_eq!(made.counts, [3, 5, 2]);
    assert!(made.proven);
}

#[test]
fn free_lines_never_matter() {
    let p = partition(1, &[(0, OUTSIDE), (0, OUTSIDE), (0, 0)]);
    let made = balanced(&p, &goals(&[3.0, 5.0, 7.0], 3));
    assert_eq!(made.counts, [3, 5, 7]);
    assert_eq!(made.gap(), 0.0);
}

#[test]
fn infeasible_names_the_sub_domains() {
    let p = partition(3, &[(0, OUTSIDE), (1, 2), (1, OUTSIDE), (2, OUTSIDE)]);
    let mut g = goals(&[2.0, 3.0, 2.0, 3.0], 2);
    for fixed in [2, 3] {
        (g.lower[fixed], g.upper[fixed]) = (fixed as u32, fixed as u32);
    }
    let made = parity::balance(&p, &g, &OPTIONS);
    assert_eq!(
        made.unwrap_err(),
        Error::Infeasible {
            subdomains: vec![1, 2],
            fixed: vec![2, 3]
        }
    );
}

#[test]
fn bounds_in_conflict_are_named() {
    let p = partition(1, &[(0, OUTSIDE)]);
    let mut g = goals(&[4.0], 1);
    (g.lower[0], g.upper[0]) = (5, 4);
    let made = parity::balance(&p, &g, &OPTIONS);
    assert_eq!(
        made.unwrap_err(),
        Error::Bounds {
            curve: 0,
            lower: 5,
            upper: 4
        }
    );
}

#[test]
fn small_joins_are_optimal() {
    let mut dice = Dice(1);
    for round in 0..3000 {
        let nodes = 2 + dice.below(7);
        let edges = 1 + dice.below(14);
        let graph = random_graph(&mut dice, nodes, edges, [3, 10, 1000][round % 3]);
        match least_choice(&graph) {
            Some(least) => assert_eq!(join_weight(&graph), least, "round {round}: {graph:?}"),
            None => assert!(graph.hopeless().is_some()),
        }
    }
}

/// Ties, zero weights, dense and sparse: the certificate is its own twin at any size.
#[test]
fn middle_sized_joins_prove_themselves() {
    let mut dice = Dice(2);
    for round in 0..300 {
        let nodes = 20 + dice.below(200);
        let edges = nodes + dice.below(3 * nodes);
        let graph = random_graph(&mut dice, nodes, edges, [2, 5, 100, 100_000][round % 4]);
        if graph.hopeless().is_none() {
            assert!(join_weight(&graph) <= spanning_tree(&graph));
        }
    }
}

/// An independent twin for middle sizes: shortest paths between all pairs, then the best pairing by
/// a table over subsets of the odd nodes.
fn least_pairing(graph: &Graph) -> Option<i64> {
    const FAR: i64 = i64::MAX / 4;
    let n = graph.odd.len();
    let node = |id: u32| (id as usize).min(n);
    let mut far = vec![vec![FAR; n + 1]; n + 1];
    for edge in &graph.edges {
        let (a, b) = (node(edge.a), node(edge.b));
        far[a][b] = far[a][b].min(edge.weight);
        far[b][a] = far[a][b];
    }
    // The outside is an end, never a way through: it absorbs.
    for via in 0..n {
        for a in 0..=n {
            for b in 0..=n {
                far[a][b] = far[a][b].min(far[a][via] + far[via][b]);
            }
        }
    }
    let odd: Vec<usize> = (0..n).filter(|&v| graph.odd[v]).collect();
    let mut best = vec![FAR; 1 << odd.len()];
    best[0] = 0;
    for set in 1..best.len() {
        let first = set.trailing_zeros() as usize;
        let without = set & !(1 << first);
        best[set] = best[without] + far[odd[first]][n];
        for other in (first + 1..odd.len()).filter(|other| set >> other & 1 == 1) {
            let pair = best[without & !(1 << other)] + far[odd[first]][odd[other]];
            best[set] = best[set].min(pair);
        }
        best[set] = best[set].min(FAR);
    }
    best.last().copied().filter(|least| *least < FAR)
}

#[test]
fn joins_of_middle_size_are_those_of_a_table_of_pairs() {
    let mut dice = Dice(21);
    for round in 0..60 {
        let nodes = 40 + dice.below(40);
        let edges = 2 * nodes + dice.below(nodes);
        let mut graph = random_graph(&mut dice, nodes, edges, [4, 50, 100_000][round % 3]);
        let odd: Vec<usize> = (0..nodes).filter(|&v| graph.odd[v]).collect();
        odd.iter().skip(12).for_each(|&v| graph.odd[v] = false);
        match least_pairing(&graph) {
            Some(least) => assert_eq!(join_weight(&graph), least, "round {round}"),
            None => assert!(graph.hopeless().is_some()),
        }
    }
}

/// The matching stopped before it began: HiGHS gets no row and a bad start, finds the rows by itself and
/// branches where those that it finds are not enough.
#[test]
fn highs_finds_the_same_without_the_matching() {
    let options = Options {
        events_max: 0,
        nodes_max: 10_000,
        ..OPTIONS
    };
    let mut dice = Dice(31);
    let (mut added, mut branched) = (0, 0);
    for round in 0..400 {
        let nodes = 4 + dice.below(40);
        let edges = nodes + dice.below(nodes);
        let mut graph = random_graph(&mut dice, nodes, edges, [4, 50, 100_000][round % 3]);
        let odd: Vec<usize> = (0..nodes).filter(|&v| graph.odd[v]).collect();
        odd.iter().skip(12).for_each(|&v| graph.odd[v] = false);
        let Some(least) = least_pairing(&graph) else {
            continue;
        };
        let begun = parity::minimum_join(&graph, options.events_max);
        let (join, solved) = parity::solve(&graph, 0, begun, &options);
        assert_eq!(join.weight(&graph), least, "round {round}: {solved:?}");
        let claimed = solved.claimed.expect("no part is left") / COST_UNIT;
        assert!(claimed <= least as f64 + 0.5, "round {round}: {claimed}");
        added += solved.added;
        branched += solved.branched;
    }
    assert!(
        added > 1000 && branched > 0,
        "{added} rows, {branched} branched"
    );
}

/// With the matching's rows there is next to nothing left to add.
#[test]
fn highs_confirms_what_the_matching_proves() {
    for seed in 0..20 {
        let (p, g) = city(20, seed);
        let options = Options {
            worth: 0.3,
            ..OPTIONS
        };
        let made = parity::balance(&p, &g, &options).unwrap();
        check(&p, &g, &made).unwrap();
        assert!(made.proven);
        let said = &made.solved;
        let claimed = said.claimed.expect("no part is left");
        assert!((claimed - made.bound).abs() < 1e-6, "{said:?}");
        assert!(said.rows > 100 && said.added * 20 <= said.rows, "{said:?}");
    }
}

/// How many sub-domains each one is away from `from`, over curves.
fn steps_from(partition: &Partition, from: u32) -> Vec<u32> {
    let mut steps = vec![u32::MAX; partition.subdomains.len()];
    steps[from as usize] = 0;
    let mut changed = true;
    while changed {
        changed = false;
        for curve in
            (partition.curves.iter()).filter(|it| it.right != OUTSIDE && it.left != OUTSIDE)
        {
            let (a, b) = (curve.left as usize, curve.right as usize);
            for (near, next) in [(a, b), (b, a)] {
                if steps[near] != u32::MAX && steps[next] > steps[near] + 1 {
                    steps[next] = steps[near] + 1;
                    changed = true;
                }
            }
        }
    }
    steps
}

/// One block's lines move by a size: counts far away stay. Not all: the optimum is one of the whole
/// city, and where half of all sub-domains are odd a chain of exchanges of nearly no cost may go far.
/// (Measured here: 95 of 4956 far curves, the farthest 32 blocks away; 224 of 20 056 in a city of
/// 10 000 blocks.)
#[test]
fn one_moved_line_changes_few_counts_far_away() {
    let (p, g) = blocks(50, 6);
    let moved = 25 * 50 + 25;
    let mut h = g.clone();
    for &curve in g.blocks[moved].sides.iter().flatten() {
        h.goal[curve as usize] += 1.0;
    }
    let [before, after] = [&g, &h].map(|goals| parity::balance(&p, goals, &OPTIONS).unwrap());
    let both = [&before.counts[..], &after.counts];
    let (changed, far) = changed_far(&p, moved as u32, 5, both);
    assert!(
        changed * 100 <= 3 * far,
        "{changed} of {far} curves more than five sub-domains away changed"
    );
}

/// Counts more than `near` sub-domains away from `moved` that differ, and how many there are.
fn changed_far(p: &Partition, moved: u32, near: u32, counts: [&[u32]; 2]) -> (usize, usize) {
    let steps = steps_from(p, moved);
    let is_far = |side: u32| side == OUTSIDE || steps[side as usize] > near;
    let far: Vec<usize> = (0..p.curves.len())
        .filter(|&id| is_far(p.curves[id].left) && is_far(p.curves[id].right))
        .collect();
    let changed = far.iter().filter(|&&id| counts[0][id] != counts[1][id]);
    (changed.count(), far.len())
}

#[test]
fn with_earlier_counts_one_moved_line_changes_none_far_away() {
    let (p, g) = blocks(50, 6);
    for worth in [0.0, 1.2] {
        let options = Options {
            worth,
            climb_max: 8,
            gap_enough: 0.01,
            ..OPTIONS
        };
        let before = parity::balance(&p, &g, &options).unwrap();
        let earlier: Vec<Option<u32>> = before.counts.iter().copied().map(Some).collect();
        let again = parity::balance_near(&p, &g, &earlier, &options).unwrap();
        assert_eq!(again.counts, before.counts, "nothing moved");
        for moved in [25 * 50 + 25, 7 * 50 + 40] {
            let mut h = g.clone();
            for &curve in g.blocks[moved].sides.iter().flatten() {
                h.goal[curve as usize] += 1.0;
            }
            let after = parity::balance_near(&p, &h, &earlier, &options).unwrap();
            check(&p, &h, &after).unwrap();
            let both = [&before.counts[..], &after.counts];
            let (changed, far) = changed_far(&p, moved as u32, 5, both);
            assert!(changed * 1000 <= far, "{worth}: {changed} of {far} changed");
            // What it costs to stay is little: within a hundredth of what parity and patterns cost.
            let free = parity::balance(&p, &h, &options).unwrap();
            let total = |it: &Balance| it.objective + it.structure.price;
            assert!(total(&after) - total(&free) < 0.01 * (total(&free) - free.base));
        }
    }
}

#[test]
fn earlier_counts_that_are_odd_or_out_of_bounds_do_no_harm() {
    let mut dice = Dice(5);
    for seed in 0..10 {
        let (p, g) = city(8, seed);
        let earlier: Vec<Option<u32>> = (0..p.curves.len())
            .map(|_| (dice.roll() < 0.8).then(|| dice.below(9) as u32))
            .collect();
        let made = parity::balance_near(&p, &g, &earlier, &OPTIONS).unwrap();
        check(&p, &g, &made).unwrap();
        assert!(made.proven, "the bound is that of parity alone");
    }
}

#[test]
fn a_limit_of_work_leaves_a_valid_bound() {
    let (p, g) = city(12, 5);
    let best = balanced(&p, &g);
    for events_max in [0, 50, 500, 1000] {
        let made = parity::balance(
            &p,
            &g,
            &Options {
                events_max,
                ..OPTIONS
            },
        )
        .unwrap();
        check(&p, &g, &made).unwrap();
        assert!(made.bound <= best.objective + COST_UNIT / 2.0);
        assert!(made.objective >= best.objective - COST_UNIT / 2.0);
    }
}

#[test]
fn a_certificate_that_claims_too_much_is_refused() {
    let (p, g) = city(6, 3);
    let mut made = balanced(&p, &g);
    made.cuts.value2[0] += 2;
    assert!(check(&p, &g, &made).is_err());
}

#[test]
fn equal_sides_are_worth_their_price() {
    let (p, g) = blocks(12, 4);
    let plain = balanced(&p, &g);
    assert_eq!(plain.objective, plain.optimum);
    for worth in [0.05, 0.2, 1.0] {
        let made = parity::balance(&p, &g, &Options { worth, ..OPTIONS }).unwrap();
        check(&p, &g, &made).unwrap();
        let (before, after) = (price(&g, &plain.counts), price(&g, &made.counts));
        assert!((made.structure.price - worth * after).abs() < 1e-3);
        let total = made.objective + made.structure.price;
        assert!(total <= plain.objective + worth * before + 1e-9);
        assert!(total >= made.structure.bound - 1e-9);
        assert!(made.structure.mapped >= plain.structure.mapped);
        assert_eq!(made.optimum, plain.optimum);
    }
}

/// All counts within two of the wish, patterns priced: the slow twin of cost and price together.
fn brute_force_with_price(partition: &Partition, goals: &Goals, worth: i64) -> Option<i64> {
    let n = partition.curves.len();
    let mut counts: Vec<u32> = goals.lower.clone();
    let mut best = None;
    loop {
        let mut total = vec![0; partition.subdomains.len()];
        for (curve, count) in partition.curves.iter().zip(&counts) {
            for side in [curve.left, curve.right] {
                if side != OUTSIDE {
                    total[side as usize] += count;
                }
            }
        }
        if total.iter().all(|total| total % 2 == 0) {
            let cost: i64 = (0..n).map(|id| cost_units(goals, id, counts[id])).sum();
            let price = |it: &Block| {
                let each = (worth as f64 * goals.block_weight(it)).round() as i64;
                each * excess(it, &counts)
            };
            let all = cost + goals.blocks.iter().map(price).sum::<i64>();
            best = Some(best.map_or(all, |least: i64| least.min(all)));
        }
        let Some(next) = (0..n).find(|&id| counts[id] < goals.upper[id]) else {
            return best;
        };
        counts[next] += 1;
        counts[..next].copy_from_slice(&goals.lower[..next]);
    }
}

/// Largest excess of the rules of a block, written from the table of patterns and not from them.
fn excess(block: &Block, counts: &[u32]) -> i64 {
    let totals = block.totals(|curve| f64::from(counts[curve]));
    let n = totals.map(|total| total as i64);
    let star = |at: &[usize]| -> i64 {
        let all: i64 = at.iter().map(|&side| n[side]).sum();
        at.iter().map(|&side| 2 + 2 * n[side] - all).max().unwrap()
    };
    let odd = (n[0] + n[2] + n[4]) % 2;
    match block.sides.len() {
        3 => star(&[0, 1, 2]).max(0),
        4 => (n[0] - n[2]).abs().max((n[1] - n[3]).abs()),
        6 => star(&[0, 2, 4]).max(star(&[1, 3, 5])).max(odd).max(0),
        // Spoke i of five: half of n[i+1] - n[i+3] + n[i] - n[i+2] + n[i+4], at least 1.
        _ => (0..5)
            .map(|i| {
                let at = |k: usize| n[(i + k) % 5];
                2 - (at(1) - at(3) + at(0) - at(2) + at(4))
            })
            .max()
            .unwrap()
            .max(0),
    }
}

/// A block of `sides` sides with others around it, which are no blocks; curves of any weight.
fn flower(sides: usize, dice: &mut Dice) -> (Partition, Goals) {
    let rim: Vec<(u32, u32)> = (0..sides)
        .map(|k| (0, if k % 2 == 0 { 1 } else { OUTSIDE }))
        .chain([(1, OUTSIDE)])
        .collect();
    let goal: Vec<f64> = rim.iter().map(|_| 1.0 + 3.0 * dice.roll()).collect();
    let mut g = goals(&goal, 1);
    g.weight.fill_with(|| 1.0 + 8.0 * dice.roll());
    g.blocks.push(Block {
        subdomain: 0,
        sides: (0..sides as u32).map(|curve| vec![curve]).collect(),
    });
    (partition(2, &rim), g)
}

#[test]
fn patterns_of_all_sides_are_best_together_with_cost() {
    let mut dice = Dice(11);
    let (mut optimal, rounds) = (0, 60);
    for round in 0..rounds {
        let (p, g) = flower(3 + round % 4, &mut dice);
        let worth = [0.1, 0.4, 2.0][round % 3];
        let made = parity::balance(&p, &g, &Options { worth, ..OPTIONS }).unwrap();
        check(&p, &g, &made).unwrap();
        let least = brute_force_with_price(&p, &g, (worth / COST_UNIT).round() as i64);
        let least = least.expect("one more or less is always possible") as f64 * COST_UNIT;
        let total = made.objective + made.structure.price;
        assert!(
            made.structure.bound <= least + COST_UNIT / 2.0,
            "round {round}"
        );
        assert!(total >= least - COST_UNIT / 2.0, "round {round}");
        optimal += u32::from(total < least + COST_UNIT / 2.0);
    }
    assert_eq!(optimal, rounds as u32, "HiGHS solves one neighbourhood");
}

#[test]
fn multipliers_that_claim_too_much_are_refused() {
    let (p, g) = blocks(6, 3);
    let options = Options {
        worth: 0.3,
        ..OPTIONS
    };
    let made = parity::balance(&p, &g, &options).unwrap();
    let mut raised = made.clone();
    raised.structure.bound += COST_UNIT;
    assert!(check(&p, &g, &raised).is_err());
    let mut dear = made.clone();
    dear.structure.multipliers[0] = (0.31 / COST_UNIT) as i64;
    assert!(check(&p, &g, &dear).is_err());
}

/// The aim of the issue is 1 %.
#[test]
fn cost_and_price_are_near_their_bound() {
    let (p, g) = blocks(40, 8);
    for worth in [0.1, 0.3, 1.0] {
        let made = parity::balance(&p, &g, &Options { worth, ..OPTIONS }).unwrap();
        check(&p, &g, &made).unwrap();
        let gap = made.structure_gap();
        assert!((0.0..0.01).contains(&gap), "{worth}: {gap}");
    }
}

#[test]
fn blocks_that_are_dear_are_all_mapped() {
    let (p, g) = blocks(8, 9);
    let made = parity::balance(
        &p,
        &g,
        &Options {
            worth: 5.0,
            ..OPTIONS
        },
    )
    .unwrap();
    check(&p, &g, &made).unwrap();
    assert_eq!(made.structure.mapped, 64, "price {}", made.structure.price);
}

#[test]
fn ten_thousand_blocks_are_proven() {
    let (p, g) = city(105, 7);
    let made = balanced(&p, &g);
    assert!(made.proven, "gap {}", made.gap());
    assert!((0.3..0.7).contains(&made.odd_share), "{}", made.odd_share);
    let claimed = made.solved.claimed.expect("HiGHS solves it");
    assert!(
        (claimed - made.objective).abs() < 1e-6 * made.objective,
        "{claimed}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn counts_are_those_of_brute_force(
        sides in prop::collection::vec((0_u32..5, 0_u32..6, 1.0_f64..4.0, 0_u32..3), 1..9),
    ) {
        let named = |side: u32| if side == 5 { OUTSIDE } else { side };
        let p = partition(5, &sides.iter().map(|s| (s.0, named(s.1))).collect::<Vec<_>>());
        let mut g = goals(&sides.iter().map(|s| s.2).collect::<Vec<_>>(), 1);
        for (k, side) in sides.iter().enumerate().filter(|(_, side)| side.3 == 0) {
            (g.lower[k], g.upper[k]) = (side.2 as u32, side.2 as u32);
        }
        match brute_force(&p, &g) {
            Some(least) => {
                let made = balanced(&p, &g);
                prop_assert_eq!((made.objective / COST_UNIT).round() as i64, least);
                prop_assert!(made.proven);
            }
            None => prop_assert!(parity::balance(&p, &g, &OPTIONS).is_err()),
        }
    }

    #[test]
    fn the_objective_does_not_depend_on_numbers(seed in 0_u64..1000) {
        let (p, g) = city(7, seed);
        let mut dice = Dice(seed);
        let mut order: Vec<usize> = (0..p.curves.len()).collect();
        let mut name: Vec<u32> = (0..p.subdomains.len() as u32).collect();
        for k in (1..order.len()).rev() {
            order.swap(k, dice.below(k + 1));
        }
        for k in (1..name.len()).rev() {
            name.swap(k, dice.below(k + 1));
        }
        let renamed = |side: u32| if side == OUTSIDE { side } else { name[side as usize] };
        let sides: Vec<(u32, u32)> = (order.iter())
            .map(|&k| (renamed(p.curves[k].right), renamed(p.curves[k].left)))
            .collect();
        let goal: Vec<f64> = order.iter().map(|&k| g.goal[k]).collect();
        let (q, h) = (partition(p.subdomains.len(), &sides), goals(&goal, 3));
        prop_assert_eq!(balanced(&p, &g).objective, balanced(&q, &h).objective);
    }
}
