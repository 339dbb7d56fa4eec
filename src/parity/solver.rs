//! The programme as HiGHS sees it: the only file that names HiGHS, with `solver_rules`.

use crate::parity::cuts::Cuts;
use crate::parity::graph::Graph;
use highs::HighsModelStatus;
use highs::HighsSolutionStatus;
use highs::Model;
use highs::RowProblem;
use highs::Sense;

/// What HiGHS says.
pub struct Solved {
    /// Edges of the graph that it chose, if its solution is whole; not to be trusted.
    pub chosen: Option<Vec<bool>>,
    /// Optimum that it claims, in units of weight.
    pub claimed: f64,
    /// Rows of the programme.
    pub rows: u32,
    /// Columns of the programme.
    pub columns: u32,
    /// True if the linear programme had no whole solution and branch and bound ran.
    pub branched: bool,
}

/// Solves: a variable for each edge whose slack is at most `slack2_max` (the others are not in any
/// solution that much better), a row `x(cut) >= 1` for each set of the family. `None` if HiGHS
/// does not come to an end within the limits.
pub fn solve(graph: &Graph, cuts: &Cuts, slack2_max: i64, nodes_max: i32) -> Option<Solved> {
    let columns: Vec<u32> = (0..graph.edges.len() as u32)
        .filter(|&id| cuts.slack2(&graph.edges[id as usize]) <= slack2_max)
        .collect();
    let mut solved = Solved {
        chosen: None,
        claimed: 0.0,
        rows: cuts.value2.len() as u32,
        columns: columns.len() as u32,
        branched: false,
    };
    if cuts.value2.is_empty() {
        return Some(solved);
    }
    // With no gap left a linear optimum in pieces is one of several: it confirms what is known,
    // and there is nothing to branch for.
    let attempts: &[bool] = if slack2_max == 0 {
        &[false]
    } else {
        &[false, true]
    };
    for &integral in attempts {
        let (values, claimed) = run(graph, cuts, &columns, integral, nodes_max)?;
        solved.claimed = claimed;
        solved.branched = integral;
        if values.iter().all(|&x| (x - x.round()).abs() < 1e-6) {
            let mut chosen = vec![false; graph.edges.len()];
            for (&id, &x) in columns.iter().zip(&values) {
                chosen[id as usize] = x.round() as i64 % 2 == 1;
            }
            solved.chosen = Some(chosen);
            break;
        }
    }
    Some(solved)
}

fn run(
    graph: &Graph,
    cuts: &Cuts,
    columns: &[u32],
    integral: bool,
    nodes_max: i32,
) -> Option<(Vec<f64>, f64)> {
    let mut problem = RowProblem::default();
    let mut rows: Vec<Vec<(highs::Col, f64)>> = vec![Vec::new(); cuts.value2.len()];
    for &id in columns {
        let edge = &graph.edges[id as usize];
        let column = match integral {
            true => problem.add_integer_column(edge.weight as f64, 0..=1),
            false => problem.add_column(edge.weight as f64, 0..),
        };
        cuts.crossed(edge, |set| rows[set as usize].push((column, 1.0)));
    }
    for row in &rows {
        problem.add_row(1.., row);
    }
    let mut model = Model::try_new(problem).ok()?;
    model.set_sense(Sense::Minimise);
    set_options(&mut model, nodes_max);
    let solved = model.try_solve().ok()?;
    if solved.status() != HighsModelStatus::Optimal
        || solved.primal_solution_status() != HighsSolutionStatus::Feasible
    {
        return None;
    }
    Some((
        solved.get_solution().columns().to_vec(),
        solved.objective_value(),
    ))
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
