//! The rules of patterns as HiGHS sees them: small integer programmes for neighbourhoods.

use crate::intervals::goals::Goals;
use crate::parity::draft::Draft;
use crate::parity::programme::cost_units;
use crate::parity::solver::set_options;
use crate::parity::tilts::Rules;
use crate::partition::subdomains::OUTSIDE;
use crate::partition::subdomains::Partition;
use highs::Col;
use highs::HighsSolutionStatus;
use highs::Model;
use highs::RowProblem;
use highs::Sense;

/// How far a count may move in one neighbourhood.
const REACH: u32 = 3;

/// Units of cost in HiGHS' objective: it works best with numbers near one.
const SCALE: f64 = 1e-6;

/// A column for the count of `curve`, at most [`REACH`] from `near`, with its convex cost in steps.
fn count_column(problem: &mut RowProblem, goals: &Goals, curve: usize, near: u32) -> Col {
    let least = near.saturating_sub(REACH).max(goals.lower[curve]);
    let most = (near + REACH).min(goals.upper[curve]);
    let count = problem.add_integer_column(0.0, f64::from(least)..=f64::from(most));
    let cost = |n: u32| cost_units(goals, curve, n) as f64 * SCALE;
    let mut row = vec![(count, 1.0)];
    for step in 0..REACH {
        if near + step < most {
            let up = cost(near + step + 1) - cost(near + step);
            row.push((problem.add_column(up, 0.0..=1.0), -1.0));
        }
        if near > least + step {
            let down = cost(near - step - 1) - cost(near - step);
            row.push((problem.add_column(down, 0.0..=1.0), 1.0));
        }
    }
    problem.add_row(f64::from(near)..=f64::from(near), &row);
    count
}

/// A part of the city whose curves may change while all others stay.
pub struct Neighbourhood {
    /// Curves between its sub-domains, or to the outside.
    pub curves: Vec<u32>,
    /// Its sub-domains.
    pub subdomains: Vec<u32>,
    /// Blocks among them.
    pub blocks: Vec<u32>,
}

/// Better counts for the curves of a neighbourhood than those of `draft`, if HiGHS finds them
/// within `nodes_max` branches; not to be trusted.
pub fn counts(
    partition: &Partition,
    goals: &Goals,
    rules: &Rules,
    draft: &Draft,
    place: &Neighbourhood,
    nodes_max: i32,
) -> Option<Vec<u32>> {
    let mut problem = RowProblem::default();
    let columns: Vec<Col> = (place.curves.iter())
        .map(|&curve| {
            let near = draft.counts[curve as usize];
            count_column(&mut problem, goals, curve as usize, near)
        })
        .collect();
    let column_of = |curve: u32| place.curves.binary_search(&curve).ok().map(|k| columns[k]);
    even_rows(&mut problem, partition, draft, place, &columns);
    for &block in &place.blocks {
        let sides = &goals.blocks[block as usize].sides;
        let price = problem.add_column(rules.worth[block as usize] as f64 * SCALE, 0..);
        for rule in rules.with_sides(sides.len()) {
            let mut row = vec![(price, 1.0)];
            let mut constant = i64::from(rule.constant);
            for (side, &sign) in sides.iter().zip(&rule.sign).filter(|(_, sign)| **sign != 0) {
                for &curve in side {
                    match column_of(curve) {
                        Some(column) => row.push((column, -f64::from(sign))),
                        None => {
                            constant += i64::from(sign) * i64::from(draft.counts[curve as usize])
                        }
                    }
                }
            }
            problem.add_row(constant as f64.., &row);
        }
        if sides.len() == 6 {
            half_row(&mut problem, draft, sides, price, &column_of);
        }
    }
    let mut model = Model::try_new(problem).ok()?;
    model.set_sense(Sense::Minimise);
    set_options(&mut model, nodes_max);
    let solved = model.try_solve().ok()?;
    if solved.primal_solution_status() != HighsSolutionStatus::Feasible {
        return None;
    }
    let values = solved.get_solution();
    let found = columns
        .iter()
        .map(|column| values.columns()[column.index()]);
    Some(found.map(|n| n.round() as u32).collect())
}

/// Changes around each sub-domain sum to an even number.
fn even_rows(
    problem: &mut RowProblem,
    partition: &Partition,
    draft: &Draft,
    place: &Neighbourhood,
    columns: &[Col],
) {
    let mut around: Vec<(u32, usize)> = Vec::new();
    for (k, &curve) in place.curves.iter().enumerate() {
        let curve = &partition.curves[curve as usize];
        let sides = [curve.left, curve.right].into_iter();
        around.extend(sides.filter(|&side| side != OUTSIDE).map(|side| (side, k)));
    }
    around.sort_unstable();
    for group in around.chunk_by(|a, b| a.0 == b.0) {
        let now: u32 = group
            .iter()
            .map(|&(_, k)| draft.counts[place.curves[k] as usize])
            .sum();
        let most = (group.len() as u32 * REACH / 2) as i32;
        let twos = problem.add_integer_column(0.0, -most..=most);
        let mut row: Vec<(Col, f64)> = group.iter().map(|&(_, k)| (columns[k], 1.0)).collect();
        row.push((twos, -2.0));
        problem.add_row(f64::from(now)..=f64::from(now), &row);
    }
}

/// Sides 0, 2, 4 have an even total, or the price is paid once.
fn half_row(
    problem: &mut RowProblem,
    draft: &Draft,
    sides: &[Vec<u32>],
    price: Col,
    column_of: &impl Fn(u32) -> Option<Col>,
) {
    let twos = problem.add_integer_column(0.0, 0..);
    let odd = problem.add_integer_column(0.0, 0..=1);
    let mut row = vec![(twos, -2.0), (odd, -1.0)];
    let mut fixed = 0;
    for &curve in sides.iter().step_by(2).flatten() {
        match column_of(curve) {
            Some(column) => row.push((column, 1.0)),
            None => fixed += draft.counts[curve as usize],
        }
    }
    problem.add_row(-f64::from(fixed)..=-f64::from(fixed), &row);
    problem.add_row(0.., [(price, 1.0), (odd, -1.0)]);
}
