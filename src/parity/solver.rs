//! The programme as HiGHS sees it: the only file that names HiGHS, with `solver_rules`.
//!
//! ```text
//! minimise  sum over edges e of w_e x_e        x_e >= 0
//! subject to  sum over edges e that leave S of x_e >= 1     for sets S with an odd number of odd nodes
//! ```
//!
//! Thinned by reduced cost (an edge whose slack exceeds the gap is in no better choice) and cut into `parts`.
//! It begins with the rows that the matching found. Where the solution leaves a group of nodes, joined by
//! what it takes, with an odd number of odd ones, the row of that group is added and HiGHS goes on from its
//! basis. If in the end something is in pieces, whole numbers are asked for, with `sum of x around v = 2 k_v`
//! or `2 k_v + 1`, and the matching's choice as the start of branch and bound.

use crate::parity::Options;
use crate::parity::balance::Solved;
use crate::parity::cuts::Cuts;
use crate::parity::graph::Edge;
use crate::parity::graph::Graph;
use crate::parity::graph::OUTSIDE;
use crate::parity::groups::Groups;
use crate::parity::parts::Part;
use crate::parity::parts::parts;
use highs::Col;
use highs::HighsModelStatus;
use highs::HighsSolutionStatus;
use highs::Model;
use highs::RowProblem;
use highs::Sense;
use highs::SolvedModel;

/// Rows of small parts that are solved together, so that HiGHS is not begun anew for every few.
const ROWS_TOGETHER: u32 = 2000;

/// Times that rows are added to a part, a limit of work; then it is branched on.
const ROUNDS_MAX: u32 = 50;

/// What HiGHS takes for nothing.
const NOTHING: f64 = 1e-6;

/// Solves part by part. Returns the edges that the solution takes, those of `start` in parts that are
/// left (too large, or not solved within the limits), and what HiGHS says. Not to be trusted.
pub fn solve(
    graph: &Graph,
    cuts: &Cuts,
    start: &[bool],
    slack2_max: i64,
    options: &Options,
) -> (Vec<bool>, Solved) {
    let mut taken = start.to_vec();
    let mut said = Solved {
        claimed: Some(0.0),
        ..Solved::default()
    };
    let together = ROWS_TOGETHER.min(options.rows_max) as usize;
    for part in parts(graph, cuts, slack2_max, together) {
        said.parts += 1;
        let found = match part.sets.len() <= options.rows_max as usize {
            true => Local::of(graph, cuts, start, &part).solve(options.nodes_max, &mut said),
            false => None,
        };
        let Some((values, claimed)) = found else {
            said.left += 1;
            said.claimed = None;
            continue;
        };
        said.rows += part.sets.len() as u32;
        said.columns += part.edges.len() as u32;
        said.claimed = said.claimed.map(|sum| sum + claimed);
        for (&id, &x) in part.edges.iter().zip(&values) {
            taken[id as usize] = x > 0.5;
        }
    }
    (taken, said)
}

/// A part with its nodes and rows numbered from 0.
struct Local {
    /// `OUTSIDE` is the last node.
    edges: Vec<Edge>,
    odd: Vec<bool>,
    /// Columns of each row.
    rows: Vec<Vec<u32>>,
    start: Vec<bool>,
}

impl Local {
    fn of(graph: &Graph, cuts: &Cuts, start: &[bool], part: &Part) -> Local {
        let edges: Vec<&Edge> = (part.edges.iter())
            .map(|&id| &graph.edges[id as usize])
            .collect();
        let mut nodes: Vec<u32> = edges.iter().flat_map(|edge| [edge.a, edge.b]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes.retain(|&node| node != OUTSIDE);
        // OUTSIDE is greater than all, so it comes after the last one.
        let name = |node: u32| nodes.partition_point(|&it| it < node) as u32;
        let mut rows = vec![Vec::new(); part.sets.len()];
        for (column, edge) in edges.iter().enumerate() {
            cuts.crossed(edge, |set| {
                rows[part.sets.partition_point(|&it| it < set)].push(column as u32)
            });
        }
        Local {
            odd: nodes.iter().map(|&node| graph.odd[node as usize]).collect(),
            start: part.edges.iter().map(|&id| start[id as usize]).collect(),
            rows,
            edges: (edges.into_iter())
                .map(|edge| Edge {
                    a: name(edge.a),
                    b: name(edge.b),
                    ..*edge
                })
                .collect(),
        }
    }

    /// A column for each edge, a row for each set.
    fn programme(
        &self,
        add_column: impl Fn(&mut RowProblem, f64) -> Col,
    ) -> (RowProblem, Vec<Col>) {
        let mut problem = RowProblem::default();
        let columns: Vec<Col> = (self.edges.iter())
            .map(|edge| add_column(&mut problem, edge.weight as f64))
            .collect();
        for row in &self.rows {
            problem.add_row(1.., terms(row, &columns));
        }
        (problem, columns)
    }

    /// The values of the columns and the optimum that HiGHS claims; `None` if it comes to no end.
    fn solve(&mut self, nodes_max: i32, said: &mut Solved) -> Option<(Vec<f64>, f64)> {
        let (problem, columns) = self.programme(|problem, weight| problem.add_column(weight, 0..));
        let mut model = model_of(problem, nodes_max)?;
        for _ in 0..ROUNDS_MAX {
            let (solved, values) = solution(model)?;
            let missing = self.missing_rows(&values);
            if missing.is_empty() {
                if values.iter().all(|x| (x - x.round()).abs() < NOTHING) {
                    return Some((values, solved.objective_value()));
                }
                break;
            }
            model = solved.into();
            for row in missing {
                model.try_add_row(1.., terms(&row, &columns)).ok()?;
                self.rows.push(row);
                said.added += 1;
            }
        }
        said.branched += 1;
        self.branch(nodes_max)
    }

    /// The rows of groups of nodes, joined by what `values` take, that hold an odd number of odd ones.
    fn missing_rows(&self, values: &[f64]) -> Vec<Vec<u32>> {
        let outside = self.odd.len();
        let mut groups = Groups::new(outside + 1);
        for (edge, _) in self.edges.iter().zip(values).filter(|it| *it.1 > NOTHING) {
            groups.join(edge.a, edge.b);
        }
        let mut odd = vec![false; outside + 1];
        for node in (0..outside).filter(|&node| self.odd[node]) {
            odd[groups.first(node as u32) as usize] ^= true;
        }
        odd[groups.first(outside as u32) as usize] = false;
        let mut row_of = vec![usize::MAX; outside + 1];
        let mut rows = Vec::new();
        for group in (0..outside).filter(|&group| odd[group]) {
            row_of[group] = rows.len();
            rows.push(Vec::new());
        }
        for (column, edge) in self.edges.iter().enumerate() {
            let [a, b] = [edge.a, edge.b].map(|node| groups.first(node) as usize);
            for group in [a, b] {
                if a != b && odd[group] {
                    rows[row_of[group]].push(column as u32);
                }
            }
        }
        rows
    }

    /// The same in whole numbers.
    fn branch(&self, nodes_max: i32) -> Option<(Vec<f64>, f64)> {
        let (mut problem, columns) =
            self.programme(|problem, weight| problem.add_integer_column(weight, 0..=1));
        let mut around = vec![Vec::new(); self.odd.len() + 1];
        let mut begun = vec![0.0; self.odd.len() + 1];
        let starts = self.start.iter().map(|&taken| f64::from(u8::from(taken)));
        let mut start: Vec<f64> = starts.collect();
        for (column, edge) in self.edges.iter().enumerate() {
            for node in [edge.a, edge.b] {
                around[node as usize].push((columns[column], 1.0));
                begun[node as usize] += start[column];
            }
        }
        for (node, &is_odd) in self.odd.iter().enumerate() {
            let mut row = std::mem::take(&mut around[node]);
            row.push((problem.add_integer_column(0.0, 0..), -2.0));
            let odd = f64::from(u8::from(is_odd));
            problem.add_row(odd..=odd, row);
            start.push((begun[node] - odd) / 2.0);
        }
        let mut model = model_of(problem, nodes_max)?;
        model
            .try_set_solution(Some(&start), None, None, None)
            .ok()?;
        let (solved, mut values) = solution(model)?;
        values.truncate(self.edges.len());
        Some((values, solved.objective_value()))
    }
}

/// The sum of some columns.
fn terms(row: &[u32], columns: &[Col]) -> impl Iterator<Item = (Col, f64)> {
    row.iter().map(|&column| (columns[column as usize], 1.0))
}

fn model_of(problem: RowProblem, nodes_max: i32) -> Option<Model> {
    let mut model = Model::try_new(problem).ok()?;
    model.set_sense(Sense::Minimise);
    set_options(&mut model, nodes_max);
    Some(model)
}

/// The optimum, if HiGHS comes to it.
fn solution(model: Model) -> Option<(SolvedModel, Vec<f64>)> {
    let solved = model.try_solve().ok()?;
    let is_best = solved.status() == HighsModelStatus::Optimal
        && solved.primal_solution_status() == HighsSolutionStatus::Feasible;
    let values = solved.get_solution().columns().to_vec();
    is_best.then_some((solved, values))
}

/// All that could make two runs differ, said explicitly. Limits count work, never seconds.
pub fn set_options(model: &mut Model, nodes_max: i32) {
    model.make_quiet();
    model.set_option("threads", 1);
    model.set_option("parallel", "off");
    model.set_option("random_seed", 1);
    model.set_option("presolve", "on");
    model.set_option("solver", "simplex");
    model.set_option("time_limit", f64::INFINITY);
    model.set_option("mip_max_nodes", nodes_max);
    model.set_option("mip_rel_gap", 0.0);
    model.set_option("mip_abs_gap", 0.5);
}
