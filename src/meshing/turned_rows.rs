//! Submapping where the outer walk does not close: rows of quads that turn.
//!
//! A walk that lacks nothing but a few edges in two directions needs no more than two irregular nodes
//! for each pair of them. So:
//!
//! 1. Edges are taken out of the outer walk until it closes: one in each of two directions for a row
//!    that turns, or two neighbours in one direction for a row that turns back. Which: those without which
//!    the walk lies nearest to its lattice.
//! 2. The shorter walks are covered by `submap`.
//! 3. `turned_row` opens the lattice between the edges that were taken out, for a row of quads.
//!
//! Such rows are dislocations of a lattice. The pairs of three and five quads at their ends are those of Peng, Zhang,
//! Kobayashi and Wonka (2011), who move them about in a mesh, where here they are laid where the walk asks for them.
//!
//! Cost: a few times that of `submap`, and the square of the visits for the choice.

use crate::geometry::point::Xy;
use crate::meshing::course::Course;
use crate::meshing::course::STEP;
use crate::meshing::course::minus;
use crate::meshing::draft::Draft;
use crate::meshing::patch::Method;
use crate::meshing::sheet::Sheet;
use crate::meshing::submap::SWEEPS;
use crate::meshing::submap::cover;
use crate::meshing::submap::onto_lattice;
use crate::meshing::turned_row::Rim;
use crate::meshing::turned_row::Row;
use crate::meshing::turned_row::insert;
use crate::meshing::visits::Visits;

/// No more rows than this turn in one sub-domain. (Measured on synthetic cities: with 5 or 8 as many irregular
/// nodes are left, and shapes are poorer: what lacks so much is no lattice.)
const MOST_ROWS: u32 = 3;

/// So many choices of edges are laid, of so many that are tried: rows may run into an inner walk.
const LAID: usize = 4;
const TRIED: usize = 16;

/// The lattice with its turned rows; `None` if the outer walk closes, if it needs more rows, if an inner one does not
/// close, or if there is no place for the rows.
pub(crate) fn mesh(visits: &Visits, walks: &[Course], size_m: f64) -> Option<Draft> {
    let outer = &walks[0];
    if outer.is_closed() || !walks[1..].iter().all(Course::is_closed) {
        return None;
    }
    // A row that turns takes an edge of either direction, one that turns back two of the same.
    let [x, y] = outer.end.map(i32::unsigned_abs);
    if (x + y) % 2 != 0 || x + y > 2 * MOST_ROWS {
        return None;
    }
    let choices = choices(visits, outer);
    let laid = (choices.iter()).filter_map(|rows| lay(visits, walks, rows, size_m));
    let mean = |sheet: &Sheet| sheet.shape(Sheet::over(visits).mark()).mean();
    let best = (laid.take(LAID))
        .map(|sheet| (mean(&sheet), sheet))
        .reduce(|best, other| if other.0 > best.0 { other } else { best });
    best.map(|(_, sheet)| sheet.into_draft(visits.len(), Method::Mapping))
}

/// Sets of rows that make the outer walk close, the most promising first: the best first rows that are not next to
/// each other, each with what is best then.
fn choices(visits: &Visits, outer: &Course) -> Vec<Vec<Row>> {
    let fit = Fit::of(visits, outer);
    let mut firsts = fit.rows(&[]);
    firsts.sort_by(|one, other| one.1.total_cmp(&other.1));
    let mut tried: Vec<Row> = Vec::new();
    for (first, _) in firsts {
        if !tried.iter().any(|row| row.is_beside(&first)) {
            tried.push(first);
        }
        if tried.len() == TRIED {
            break;
        }
    }
    tried
        .into_iter()
        .filter_map(|first| fit.with(first))
        .collect()
}

/// How the outer walk lies on its lattice.
struct Fit<'a> {
    outer: &'a Course,
    /// How far each visit lies from its place, lattice edges.
    off: Vec<Xy>,
}

impl Fit<'_> {
    fn of<'a>(visits: &Visits, outer: &'a Course) -> Fit<'a> {
        let onto = onto_lattice(visits, outer);
        let off = |(&node, at): (&Xy, &[i32; 2])| {
            let [x, y] = onto(node);
            [x - f64::from(at[0]), y - f64::from(at[1])]
        };
        Fit {
            outer,
            off: visits.nodes.iter().zip(&outer.at).map(off).collect(),
        }
    }

    /// `first` and the rows that are best then, one by one, until the walk closes.
    fn with(&self, first: Row) -> Option<Vec<Row>> {
        let mut rows = vec![first];
        while self.gap(&rows) != [0, 0] {
            let next = self.rows(&rows).into_iter();
            let (next, _) = next.min_by(|one, other| one.1.total_cmp(&other.1))?;
            rows.push(next);
        }
        Some(rows)
    }

    /// What the walk still lacks when these rows are taken out.
    fn gap(&self, rows: &[Row]) -> [i32; 2] {
        let edges = rows.iter().flat_map(|row| row.edges);
        edges.fold(self.outer.end, |gap, edge| minus(gap, self.step(edge)))
    }

    fn step(&self, edge: usize) -> [i32; 2] {
        STEP[self.outer.direction[edge]]
    }

    /// The rows that may come next, each with how badly the walk lies then.
    fn rows(&self, before: &[Row]) -> Vec<(Row, f64)> {
        let taken: Vec<usize> = before.iter().flat_map(|row| row.edges).collect();
        let [x, y] = self.gap(before);
        let along_x = if x > 0 { 0 } else { 2 };
        let along_y = if y > 0 { 1 } else { 3 };
        let rows = match [x, y] {
            [0, _] => self.turning_back(along_y, &taken),
            [_, 0] => self.turning_back(along_x, &taken),
            _ => self.turning([along_x, along_y], &taken),
        };
        let sums = Sums::of(self, &taken);
        let with_worth = |row: Row| (row, sums.without(row.edges.map(|it| (it, self.step(it)))));
        rows.into_iter().map(with_worth).collect()
    }

    /// The rows from an edge in the one direction to one in the other.
    fn turning(&self, directions: [usize; 2], taken: &[usize]) -> Vec<Row> {
        let [first, second] = directions.map(|direction| self.starts(direction, 1, taken));
        let mut rows = Vec::new();
        for &p in &first {
            for &q in &second {
                if p.abs_diff(q) > 1 && self.meet(p, q, taken) {
                    rows.push(Row {
                        edges: [p, q],
                        turns_back: false,
                    });
                }
            }
        }
        rows
    }

    /// The rows from an edge in this direction back to the next one.
    fn turning_back(&self, direction: usize, taken: &[usize]) -> Vec<Row> {
        let row = |edge: usize| Row {
            edges: [edge, edge + 1],
            turns_back: true,
        };
        self.starts(direction, 2, taken)
            .into_iter()
            .map(row)
            .collect()
    }

    /// The first edges of `count` in this direction whose row would go inside. (The walk's last edge is none, which
    /// spares going round its end.)
    fn starts(&self, direction: usize, count: usize, taken: &[usize]) -> Vec<usize> {
        let is_free = |edge: usize| {
            self.outer.direction[edge] == direction && taken.iter().all(|&it| edge.abs_diff(it) > 1)
        };
        let last = self.off.len().saturating_sub(count);
        (0..last)
            .filter(|&edge| (edge..edge + count).all(is_free) && self.looks_in(edge, count))
            .collect()
    }

    /// True if a row that starts with `count` edges from `edge` on goes inside.
    fn looks_in(&self, edge: usize, count: usize) -> bool {
        let n = self.off.len();
        let direction = &self.outer.direction;
        let (before, after) = (direction[(edge + n - 1) % n], direction[(edge + count) % n]);
        // Quarters between the edges that then meet here, and those up to the row.
        let quarters = (before + 5 - after) % 4 + 1;
        (1..quarters).contains(&((direction[edge] + 5 - after) % 4))
    }

    /// True if the rows from edges `p` and `q` run into each other.
    fn meet(&self, p: usize, q: usize, taken: &[usize]) -> bool {
        let out = [taken, &[p, q]].concat();
        let [from, to] = [p, q].map(|visit| {
            let before = out.iter().filter(|&&edge| edge < visit);
            before.fold(self.outer.at[visit], |at, &edge| minus(at, self.step(edge)))
        });
        let by = minus(to, from);
        let along = |direction: usize| {
            let step = STEP[direction % 4];
            by[0] * step[0] + by[1] * step[1]
        };
        let [ahead, across] = [p, q].map(|edge| self.outer.direction[edge] + 1);
        along(ahead) >= 1 && along(across + 2) >= 1
    }
}

/// Sums that tell at once how a walk lies when two of its edges are taken out.
struct Sums {
    /// Sum of what is off up to each visit, that visit too.
    upto: Vec<Xy>,
    squares: f64,
}

impl Sums {
    /// Of the walk without the edges that are taken.
    fn of(fit: &Fit, taken: &[usize]) -> Sums {
        let mut upto = Vec::with_capacity(fit.off.len());
        let (mut sum, mut squares) = ([0.0, 0.0], 0.0);
        for (visit, off) in fit.off.iter().enumerate() {
            let before = taken.iter().filter(|&&edge| edge < visit);
            let back = before.fold([0, 0], |back, &edge| minus(back, fit.step(edge)));
            let off = [off[0] - f64::from(back[0]), off[1] - f64::from(back[1])];
            sum = [sum[0] + off[0], sum[1] + off[1]];
            squares += off[0] * off[0] + off[1] * off[1];
            upto.push(sum);
        }
        Sums { upto, squares }
    }

    /// Sum of the squares of what is off, about its mean, when these edges are taken out too: all visits after one
    /// lie a step farther back.
    fn without(&self, edges: [(usize, [i32; 2]); 2]) -> f64 {
        let n = self.upto.len();
        let all = self.upto[n - 1];
        let (mut sum, mut squares) = (all, self.squares);
        for (edge, step) in edges {
            let step = step.map(f64::from);
            let after = (n - 1 - edge) as f64;
            let rest = [all[0] - self.upto[edge][0], all[1] - self.upto[edge][1]];
            sum = [sum[0] + after * step[0], sum[1] + after * step[1]];
            squares += 2.0 * (rest[0] * step[0] + rest[1] * step[1]) + after;
        }
        let [(p, s), (q, t)] = edges;
        squares += 2.0 * f64::from(s[0] * t[0] + s[1] * t[1]) * (n - 1 - p.max(q)) as f64;
        squares - (sum[0] * sum[0] + sum[1] * sum[1]) / n as f64
    }
}

/// The lattice with these rows.
fn lay(visits: &Visits, walks: &[Course], rows: &[Row], size_m: f64) -> Option<Sheet> {
    let mut short = Short::of(visits, walks, rows);
    let laid = cover(&short.visits, &mut short.walks, size_m)?;
    let mut sheet = Sheet::over(visits);
    let mark = sheet.mark();
    let kept = short.visits.len();
    sheet.nodes.extend(&laid.nodes[kept..]);
    let number = |node: u32| match (node as usize).checked_sub(kept) {
        None => short.first[node as usize],
        Some(inner) => (visits.len() + inner) as u32,
    };
    sheet.quads = laid.quads.iter().map(|quad| quad.map(number)).collect();
    let rim = Rim {
        outer: &walks[0],
        visits: visits.len(),
        first: &short.first,
    };
    for row in rows {
        insert(&mut sheet, &rim, row)?;
    }
    sheet.relax(mark, SWEEPS);
    Some(sheet)
}

/// The walks without the edges that rows start from: their ends become one visit, halfway.
struct Short {
    visits: Visits,
    walks: Vec<Course>,
    /// Visit -> the first of those that it stands for.
    first: Vec<u32>,
}

impl Short {
    fn of(visits: &Visits, walks: &[Course], rows: &[Row]) -> Short {
        let outer = walks[0].direction.len();
        let mut is_out = vec![false; visits.len()];
        for edge in rows.iter().flat_map(|row| row.edges) {
            is_out[edge] = true;
        }
        let kept: Vec<usize> = (0..visits.len())
            .filter(|&visit| visit == 0 || !is_out[visit - 1])
            .collect();
        let halfway = |&first: &usize| {
            let last = (first..)
                .find(|&visit| !is_out[visit])
                .expect("the last edge stays");
            let [a, b] = [first, last].map(|visit| visits.nodes[visit]);
            [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
        };
        let gone = visits.len() - kept.len();
        let directions = (0..outer).filter(|&edge| !is_out[edge]);
        let directions = directions.map(|edge| walks[0].direction[edge]).collect();
        let mut shorter = vec![Course::along(0, directions)];
        let inner = walks[1..].iter();
        shorter.extend(inner.map(|it| Course::along(it.visits.start - gone, it.direction.clone())));
        let starts = visits.walk_start[1..]
            .iter()
            .map(|start| start - gone as u32);
        Short {
            visits: Visits {
                nodes: kept.iter().map(halfway).collect(),
                walk_start: std::iter::once(0).chain(starts).collect(),
                unique: (0..kept.len() as u32).collect(),
                on_seam: vec![false; kept.len()],
                across_m: Vec::new(),
            },
            walks: shorter,
            first: kept.iter().map(|&visit| visit as u32).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The sum of squares about the mean, each visit moved by the steps of all edges before it.
    fn slow(fit: &Fit, out: &[usize]) -> f64 {
        let off: Vec<Xy> = (0..fit.off.len())
            .map(|visit| {
                let before = out.iter().filter(|&&edge| edge < visit);
                before.fold(fit.off[visit], |off, &edge| {
                    let step = fit.step(edge).map(f64::from);
                    [off[0] + step[0], off[1] + step[1]]
                })
            })
            .collect();
        let n = off.len() as f64;
        let mean = [0, 1].map(|k| off.iter().map(|it| it[k]).sum::<f64>() / n);
        let square = |it: &Xy| (it[0] - mean[0]).powi(2) + (it[1] - mean[1]).powi(2);
        off.iter().map(square).sum()
    }

    proptest! {
        #[test]
        fn sums_tell_what_moving_each_visit_would(
            walk in prop::collection::vec((0_usize..4, -2.0..2.0, -2.0..2.0), 8..60),
            out in prop::array::uniform4(0_usize..1000),
        ) {
            let n = walk.len();
            let outer = Course::along(0, walk.iter().map(|it| it.0).collect());
            let fit = Fit {
                outer: &outer,
                off: walk.iter().map(|it| [it.1, it.2]).collect(),
            };
            let [p, q, r, s] = out.map(|it| it % n);
            prop_assume!(p != q);
            let told = Sums::of(&fit, &[r, s]).without([p, q].map(|it| (it, fit.step(it))));
            let slow = slow(&fit, &[r, s, p, q]);
            prop_assert!((told - slow).abs() < 1e-9 * (1.0 + slow), "{} and {}", told, slow);
        }
    }
}
