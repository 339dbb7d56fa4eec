//! Every way to mesh a small loop with few inner nodes, and the ones that suit its angles.
//!
//! A loop of six to twelve nodes has so few quadrangulations that all are listed, once a program:
//!
//! | nodes | inner nodes up to | quadrangulations |
//! |---|---|---|
//! | 6 | 4 | 34 |
//! | 8 | 4 | 402 |
//! | 10 | 3 | 1397 |
//! | 12 | 2 | 3913 |
//!
//! Each counts the quads at every node. What a count is worth at a node depends on its angle alone,
//! so all are compared by a sum of a dozen numbers, and the best few are made. Splitting lines and
//! local operations find most of these too; but a third to two thirds of the worst hundredth of a
//! city's cells lie in loops of six nodes, and there the best is worth a search.
//!
//! Source: the list grows face by face at the first edge of an open polygon, as maps are counted
//! since Tutte (1963). Cost: 30 to 60 us a loop of twelve nodes to compare, less than 1 us one of
//! six; the list is made in a few milliseconds when it is first needed.

use crate::geometry::point::Xy;
use crate::meshing::draft::Draft;
use crate::meshing::patch::Method;
use crate::meshing::sheet::Sheet;
use crate::meshing::visits::Visits;
use smallvec::SmallVec;
use std::f64::consts::FRAC_PI_2;
use std::f64::consts::PI;
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Most nodes of a loop that is listed.
const LONGEST: usize = 12;

/// Most inner nodes for loops of 6, 8, 10 and 12 nodes: more of them would be too many to list, and
/// too small.
const MOST_INNER: [usize; 4] = [4, 4, 3, 2];

/// Most quads at a node of the loop, and at an inner node: four on the loop are a reflex corner.
const MOST_QUADS: usize = 6;

type Polygon = SmallVec<[u8; 16]>;

/// One quadrangulation of a loop. The nodes of the loop are numbered from 0, inner nodes on from
/// there.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plan {
    pub quads: Vec<[u8; 4]>,
    /// Quads at each node of the loop, less one.
    around: [u8; LONGEST],
    /// What the inner nodes cost.
    inner_cost: f64,
    inner: usize,
}

static PLANS: LazyLock<[Vec<Plan>; 4]> =
    LazyLock::new(|| std::array::from_fn(|k| list(2 * k + 6, MOST_INNER[k])));

/// True if there is one walk, and it is listed.
pub(crate) fn holds(visits: &Visits) -> bool {
    visits.walk_start.len() == 2 && lists(visits.len())
}

/// True if loops of so many nodes are listed.
pub(crate) fn lists(nodes: usize) -> bool {
    nodes.is_multiple_of(2) && (6..=LONGEST).contains(&nodes)
}

/// The `most` plans that suit the only walk best, best first.
pub(crate) fn drafts(visits: &Visits, most: usize) -> impl Iterator<Item = Draft> {
    let costs: Vec<Costs> = (0..visits.len() as u32)
        .map(|visit| corner_costs(visits.angle(visit)))
        .collect();
    let draft = |plan: &Plan| {
        let mut nodes = visits.nodes.clone();
        nodes.extend(plan.inner_nodes(&visits.nodes));
        Draft {
            nodes,
            visits: visits.len(),
            quads: plan.quads.iter().map(|quad| quad.map(u32::from)).collect(),
            settled: 0,
            method: Method::Mapping,
        }
    };
    best(&costs, most).into_iter().map(draft)
}

/// What 1, 2, ... quads cost at a node.
pub(crate) type Costs = [f64; MOST_QUADS];

/// The `most` plans of least cost for a loop with these costs at its nodes, cheapest first.
pub(crate) fn best(costs: &[Costs], most: usize) -> Vec<&'static Plan> {
    let total = |plan: &Plan| {
        let corners = costs.iter().zip(&plan.around);
        plan.inner_cost + corners.map(|(costs, &k)| costs[k as usize]).sum::<f64>()
    };
    let plans = &PLANS[costs.len() / 2 - 3];
    let mut ranked: Vec<(f64, usize)> = (plans.iter().enumerate())
        .map(|(k, plan)| (total(plan), k))
        .collect();
    let most = most.min(ranked.len());
    ranked.select_nth_unstable_by(most - 1, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    ranked.truncate(most);
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    ranked.iter().map(|&(_, k)| &plans[k]).collect()
}

/// What it costs that 1, 2, ... quads share the angle at a node: the squares of how far their
/// corners are from right angles; a corner that must be flat or more is no corner.
pub(crate) fn corner_costs(angle: f64) -> Costs {
    std::array::from_fn(|k| {
        let quads = (k + 1) as f64;
        let each = angle / quads;
        let flat = if each > 0.96 * PI { 20.0 } else { 0.0 };
        quads * (each - FRAC_PI_2).powi(2) + flat
    })
}

/// The same at an inner node.
fn inner_cost(quads: usize) -> f64 {
    quads as f64 * (TAU / quads as f64 - FRAC_PI_2).powi(2)
}

impl Plan {
    /// Places of the inner nodes, each about at the mean of its neighbours.
    pub fn inner_nodes(&self, outline: &[Xy]) -> Vec<Xy> {
        let mut sheet = Sheet {
            nodes: outline.to_vec(),
            quads: Vec::new(),
        };
        let mark = sheet.mark();
        let share = 1.0 / outline.len() as f64;
        let sum = |axis: usize| outline.iter().map(|at| at[axis]).sum::<f64>();
        let centre = [share * sum(0), share * sum(1)];
        for _ in 0..self.inner {
            sheet.node(centre);
        }
        (sheet.quads).extend(self.quads.iter().map(|quad| quad.map(u32::from)));
        sheet.relax(mark, 12);
        sheet.nodes.split_off(outline.len())
    }
}

/// All quadrangulations of a loop of `n` nodes with up to `most_inner` inner nodes, each with three
/// to six quads, and no two edges between the same nodes.
fn list(n: usize, most_inner: usize) -> Vec<Plan> {
    let mut plans = Vec::new();
    for inner in 0..=most_inner {
        let mut growth = Growth {
            n,
            total: n + inner,
            quads: Vec::new(),
            plans: &mut plans,
        };
        growth.fill(vec![(0..n as u8).collect()], n);
    }
    plans
}

/// A quadrangulation in the making.
struct Growth<'a> {
    n: usize,
    /// Nodes of the loop and inner ones, all of which must be used.
    total: usize,
    quads: Vec<[u8; 4]>,
    plans: &'a mut Vec<Plan>,
}

impl Growth<'_> {
    /// Fills the open polygons in all ways. The quad at the first edge of the last one decides:
    /// its two other corners are nodes of the polygon or new ones, and up to three polygons
    /// remain. So each quadrangulation comes once.
    fn fill(&mut self, mut open: Vec<Polygon>, used: usize) {
        let Some(polygon) = open.pop() else {
            if used == self.total {
                self.keep();
            }
            return;
        };
        let len = polygon.len();
        let (new, newer) = (used as u8, used as u8 + 1);
        let even = |count: usize| count.is_multiple_of(2);
        for j in (2..len).filter(|&j| even(j)) {
            for k in (j + 1..len).filter(|&k| even(k - j + 1)) {
                let quad = [polygon[0], polygon[1], polygon[j], polygon[k]];
                let rest = [&polygon[1..=j], &polygon[j..=k], &back(&polygon, k, &[])];
                self.step(&open, quad, &rest, used);
            }
            if used < self.total {
                let quad = [polygon[0], polygon[1], polygon[j], new];
                let rest = [&polygon[1..=j], &back(&polygon, j, &[new])[..], &[]];
                self.step(&open, quad, &rest, used + 1);
            }
        }
        if used < self.total {
            for k in (3..len).filter(|&k| !even(k)) {
                let quad = [polygon[0], polygon[1], new, polygon[k]];
                let mut first: Polygon = polygon[1..=k].into();
                first.push(new);
                self.step(
                    &open,
                    quad,
                    &[&first, &back(&polygon, k, &[]), &[]],
                    used + 1,
                );
            }
        }
        if used + 2 <= self.total {
            let quad = [polygon[0], polygon[1], new, newer];
            let rest = back(&polygon, 1, &[newer, new]);
            self.step(&open, quad, &[&rest, &[], &[]], used + 2);
        }
    }

    fn step(&mut self, open: &[Polygon], quad: [u8; 4], rest: &[&[u8]; 3], used: usize) {
        let mut open = open.to_vec();
        open.extend(
            rest.iter()
                .filter(|it| it.len() > 2)
                .map(|&it| Polygon::from(it)),
        );
        self.quads.push(quad);
        self.fill(open, used);
        self.quads.pop();
    }

    fn keep(&mut self) {
        let mut count = [0_usize; LONGEST + 4];
        let mut edges = Vec::with_capacity(4 * self.quads.len());
        for quad in &self.quads {
            for k in 0..4 {
                count[quad[k] as usize] += 1;
                edges.push((quad[k], quad[(k + 1) % 4]));
            }
        }
        edges.sort_unstable();
        let simple = edges.windows(2).all(|pair| pair[0] != pair[1]);
        let (outer, inner) = count[..self.total].split_at(self.n);
        if !simple
            || inner.iter().any(|count| !(3..=MOST_QUADS).contains(count))
            || outer.iter().any(|&count| count > MOST_QUADS)
        {
            return;
        }
        let mut around = [0; LONGEST];
        for (around, &count) in around.iter_mut().zip(outer) {
            *around = count as u8 - 1;
        }
        self.plans.push(Plan {
            quads: self.quads.clone(),
            around,
            inner_cost: inner.iter().map(|&count| inner_cost(count)).sum(),
            inner: inner.len(),
        });
    }
}

/// The polygon from entry `from` on to its first node, and then `more`.
fn back(polygon: &[u8], from: usize, more: &[u8]) -> Polygon {
    let mut rest: Polygon = polygon[from..].into();
    rest.push(polygon[0]);
    rest.extend_from_slice(more);
    rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Quads from their least corner on, in order, with the inner nodes numbered in the way that
    /// gives the least list: equal for equal quadrangulations, however they were found.
    fn canonical(quads: &[[u8; 4]], n: u8, inner: usize) -> Vec<[u8; 4]> {
        let mut numbers: Vec<u8> = (0..inner as u8).map(|k| n + k).collect();
        let mut least: Option<Vec<[u8; 4]>> = None;
        permute(&mut numbers, 0, &mut |numbers| {
            let renamed = |node: u8| {
                if node < n {
                    node
                } else {
                    numbers[(node - n) as usize]
                }
            };
            let mut list: Vec<[u8; 4]> = (quads.iter())
                .map(|quad| {
                    let mut quad = quad.map(renamed);
                    let first = (0..4).min_by_key(|&k| quad[k]).unwrap();
                    quad.rotate_left(first);
                    quad
                })
                .collect();
            list.sort_unstable();
            if least.as_ref().is_none_or(|least| list < *least) {
                least = Some(list);
            }
        });
        least.unwrap()
    }

    fn permute(items: &mut [u8], from: usize, visit: &mut impl FnMut(&[u8])) {
        if from == items.len() {
            visit(items);
        }
        for k in from..items.len() {
            items.swap(from, k);
            permute(items, from + 1, visit);
            items.swap(from, k);
        }
    }

    /// The search starts at one edge of the loop; a list that looks the same from every other edge,
    /// and in a mirror, has missed nothing that it could have found from there.
    #[test]
    fn the_list_is_the_same_from_every_edge_and_in_a_mirror() {
        for (plans, n) in PLANS[..3].iter().zip([6, 8, 10_u8]) {
            let all = |change: &dyn Fn([u8; 4]) -> [u8; 4]| -> BTreeSet<Vec<[u8; 4]>> {
                let changed = |plan: &Plan| {
                    let quads: Vec<[u8; 4]> = plan.quads.iter().map(|&quad| change(quad)).collect();
                    canonical(&quads, n, plan.inner)
                };
                plans.iter().map(changed).collect()
            };
            let listed = all(&|quad| quad);
            assert_eq!(listed.len(), plans.len(), "none comes twice");
            let turn = |node: u8| if node < n { (node + 1) % n } else { node };
            assert_eq!(all(&|quad| quad.map(turn)), listed);
            let mirror = |node: u8| if node < n { n - 1 - node } else { node };
            let flip = |[a, b, c, d]: [u8; 4]| [d, c, b, a].map(mirror);
            assert_eq!(all(&flip), listed);
        }
    }

    /// Without inner nodes they are counted by Fuss and Catalan: C(3m, m) / (2m + 1).
    #[test]
    fn counts_are_those_of_the_page() {
        let counts: Vec<usize> = PLANS.iter().map(Vec::len).collect();
        assert_eq!(counts, [34, 402, 1397, 3913]);
        let bare = |plans: &Vec<Plan>| plans.iter().filter(|plan| plan.inner == 0).count();
        let bare: Vec<usize> = PLANS.iter().map(bare).collect();
        assert_eq!(bare, [3, 12, 55, 273]);
    }
}
