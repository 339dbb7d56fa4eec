//! Every line threaded: its edges, in the order of their stations, form one way from end to end.
//!
//! Merging can leave a line with two stretches on one edge, or with a step from one node to the next
//! that no edge of it covers (the edge between was contracted into a neighbour). The first is made
//! one stretch; over the second the line is led along the shortest way of edges that stay within its
//! tolerance of the place. Where there is no such way, the tear is reported as a dropped stretch of
//! no length.

use crate::cleanup::audit::Stretch;
use crate::cleanup::audit::subtract;
use crate::cleanup::changes::Dropped;
use crate::cleanup::changes::Reason;
use crate::domain::line::Domain;
use crate::domain::line::LineId;
use crate::domain::line::Role;
use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::Piece;
use crate::noding::arrangement::grouped;
use std::collections::BTreeMap;

/// Stations nearer than this are the same, metres: rounding of sums.
const SAME_M: f64 = 1e-6;

/// Longest way over a tear, edges: within the tolerance there are few.
const WAY_EDGES_MAX: usize = 6;

/// The stretch that a way gets of the one behind it, metres, at most: it must have some length to
/// have a direction.
const LED_M: f64 = 5e-4;

/// One stretch of a line on an edge, in the digitised direction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Step {
    edge: u32,
    low_m: f64,
    high_m: f64,
    start: u32,
    end: u32,
}

/// Threads all constraint lines of `arrangement`. `given`: the stretches of lines that came into
/// clean-up, a sorted union; `dropped`: those of them that it gave up, sorted by line;
/// `tolerance_m` is a line's own. Returns the arrangement and the tears that are left.
pub(super) fn thread(
    domain: &Domain,
    arrangement: Arrangement,
    given: &[Stretch],
    dropped: &[Dropped],
    tolerance_m: impl Fn(LineId) -> f64,
) -> (Arrangement, Vec<Dropped>) {
    let mut by_line: Vec<(LineId, Step)> = Vec::with_capacity(arrangement.pieces.len());
    let mut others: Vec<(u32, Piece)> = Vec::new();
    for edge in 0..arrangement.edges.len() as u32 {
        for piece in arrangement.pieces_of(edge) {
            match domain.lines[piece.line as usize].role {
                Role::Constraint => by_line.push((piece.line, step(&arrangement, edge, piece))),
                _ => others.push((edge, *piece)),
            }
        }
    }
    let order = grouped(&by_line, domain.lines.len(), |it| it.0 as usize);
    let line_of = |it: u32| by_line[it as usize].0;
    let stars = Stars::of(&arrangement);
    let mut torn = Vec::new();
    let mut threaded: Vec<(u32, Piece)> = others;
    for run in order.chunk_by(|&s, &t| line_of(s) == line_of(t)) {
        let line = line_of(run[0]);
        let mut steps: Vec<Step> = run.iter().map(|&it| by_line[it as usize].1).collect();
        steps.sort_by(|a, b| {
            (a.low_m.total_cmp(&b.low_m))
                .then(a.high_m.total_cmp(&b.high_m))
                .then(a.edge.cmp(&b.edge))
        });
        let limit_m = tolerance_m(line);
        // What should be there: beyond it, the line had left the domain, or was given up.
        let given = of_line(given, line, |it| it.0);
        let gone = of_line(dropped, line, |it| it.line);
        let gone: Vec<Stretch> = gone.iter().map(|it| (line, it.from_m, it.to_m)).collect();
        let kept = subtract(given, &gone);
        let (steps, tears) = thread_one(domain, &arrangement, &stars, line, steps, &kept, limit_m);
        threaded.extend(
            steps
                .iter()
                .map(|it| (it.edge, piece(&arrangement, line, it))),
        );
        torn.extend(tears.iter().map(|&(from_m, to_m)| Dropped {
            line,
            reason: Reason::BeyondTolerance,
            from_m,
            to_m,
        }));
    }
    (with_pieces(arrangement, threaded), torn)
}

fn thread_one(
    domain: &Domain,
    arrangement: &Arrangement,
    stars: &Stars,
    line: LineId,
    steps: Vec<Step>,
    kept: &[Stretch],
    limit_m: f64,
) -> (Vec<Step>, Vec<(f64, f64)>) {
    let mut made: Vec<Step> = Vec::with_capacity(steps.len());
    let mut tears = Vec::new();
    for mut next in steps {
        let Some(last) = made.last_mut() else {
            made.push(next);
            continue;
        };
        let gap_m = (last.high_m, next.low_m.max(last.high_m));
        let missing = || within(kept, gap_m);
        if last.end == next.start {
            made.push(next);
        } else if last.edge == next.edge && last.start == next.start && gap_m.1 <= gap_m.0 + SAME_M
        {
            last.high_m = last.high_m.max(next.high_m);
        } else if gap_m.1 > gap_m.0 + SAME_M && missing().is_empty() {
            made.push(next);
        } else {
            // All of the way represents one place: the end of the stretch before or the begin of
            // the next one.
            let led = [gap_m.0, gap_m.1].into_iter().find_map(|at_m| {
                let place = place(domain, line, at_m);
                let near = |node: u32| {
                    let p = domain.grid.local_m(arrangement.points[node as usize]);
                    distance(p, place) <= limit_m
                };
                let way = stars.way(last.end, next.start, near)?;
                near(last.end).then_some((way, at_m))
            });
            match led {
                Some((way, at_m)) => lead(&mut made, &mut next, arrangement, &way, at_m),
                None if gap_m.1 > gap_m.0 + SAME_M => tears.extend(missing()),
                None => tears.push(gap_m),
            }
            made.push(next);
        }
    }
    (made, tears)
}

/// The rows of one line, of rows that are sorted by line.
fn of_line<R>(rows: &[R], line: LineId, line_of: impl Fn(&R) -> LineId) -> &[R] {
    let from = rows.partition_point(|it| line_of(it) < line);
    let rows = &rows[from..];
    &rows[..rows.partition_point(|it| line_of(it) == line)]
}

/// The parts of a gap that should be there.
fn within(kept: &[Stretch], (from_m, to_m): (f64, f64)) -> Vec<(f64, f64)> {
    let parts = kept.iter().map(|it| (it.1.max(from_m), it.2.min(to_m)));
    parts.filter(|it| it.1 > it.0 + SAME_M).collect()
}

/// Adds the edges of `way` before `next`, each with a little of the stretch around `at_m`.
fn lead(made: &mut Vec<Step>, next: &mut Step, arrangement: &Arrangement, way: &[u32], at_m: f64) {
    let last = made[made.len() - 1];
    let free_m = LED_M.min(0.5 * (next.high_m - at_m));
    let share_m = free_m / way.len() as f64;
    // In front of the next stretch if there is room, else at its expense.
    let mut at_m = (next.low_m - free_m).clamp(last.high_m, at_m.max(last.high_m));
    let mut node = last.end;
    for &edge in way {
        let [a, b] = arrangement.edges[edge as usize];
        let end = if a == node { b } else { a };
        made.push(Step {
            edge,
            low_m: at_m,
            high_m: at_m + share_m,
            start: node,
            end,
        });
        (node, at_m) = (end, at_m + share_m);
    }
    next.low_m = next.low_m.max(at_m);
}

fn step(arrangement: &Arrangement, edge: u32, piece: &Piece) -> Step {
    let [a, b] = arrangement.edges[edge as usize];
    let forward = piece.from_m <= piece.to_m;
    Step {
        edge,
        low_m: piece.from_m.min(piece.to_m),
        high_m: piece.from_m.max(piece.to_m),
        start: if forward { a } else { b },
        end: if forward { b } else { a },
    }
}

fn piece(arrangement: &Arrangement, line: LineId, step: &Step) -> Piece {
    let forward = arrangement.edges[step.edge as usize][0] == step.start;
    Piece {
        line,
        from_m: if forward { step.low_m } else { step.high_m },
        to_m: if forward { step.high_m } else { step.low_m },
    }
}

fn with_pieces(arrangement: Arrangement, pieces: Vec<(u32, Piece)>) -> Arrangement {
    let edges = arrangement.edges.len();
    let mut made = Arrangement {
        piece_start: Vec::with_capacity(edges + 1),
        pieces: Vec::with_capacity(pieces.len()),
        ..arrangement
    };
    let order = grouped(&pieces, edges, |it| it.0 as usize);
    let mut order = order.iter().map(|&it| pieces[it as usize]).peekable();
    let mut here: Vec<Piece> = Vec::new();
    made.piece_start.push(0);
    for edge in 0..edges as u32 {
        here.clear();
        while let Some((_, piece)) = order.next_if(|it| it.0 == edge) {
            here.push(piece);
        }
        here.sort_by(Piece::order);
        here.dedup();
        made.pieces.extend_from_slice(&here);
        made.piece_start.push(made.pieces.len() as u32);
    }
    made
}

/// The point of `line` at `station_m`, local metres. O(points of the line); tears are few.
fn place(domain: &Domain, line: LineId, station_m: f64) -> Xy {
    let stations = domain.stations_m(line);
    let points = &domain.lines[line as usize].points;
    let k = (stations.partition_point(|&it| it <= station_m)).clamp(1, points.len() - 1);
    let [a, b] = [points[k - 1], points[k]].map(|p| domain.grid.local_m(p));
    let t = ((station_m - stations[k - 1]) / (stations[k] - stations[k - 1])).clamp(0.0, 1.0);
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
}

/// Edges around each node.
struct Stars {
    start: Vec<u32>,
    /// (other end, edge), by node, then sorted.
    out: Vec<(u32, u32)>,
}

impl Stars {
    fn of(arrangement: &Arrangement) -> Stars {
        let nodes = arrangement.points.len();
        let mut start = vec![0_u32; nodes + 1];
        for &node in arrangement.edges.iter().flatten() {
            start[node as usize + 1] += 1;
        }
        for node in 0..nodes {
            start[node + 1] += start[node];
        }
        // edges are sorted: first those from lesser nodes come to a star, then those to greater ones
        let mut next = start.clone();
        let mut out = vec![(0, 0); 2 * arrangement.edges.len()];
        for (&[a, b], edge) in arrangement.edges.iter().zip(0..) {
            for (node, other) in [(a, b), (b, a)] {
                out[next[node as usize] as usize] = (other, edge);
                next[node as usize] += 1;
            }
        }
        Stars { start, out }
    }

    /// Fewest edges from `from` to `to` over nodes that are `near`, or nothing.
    fn way(&self, from: u32, to: u32, near: impl Fn(u32) -> bool) -> Option<Vec<u32>> {
        let mut came: BTreeMap<u32, (u32, u32)> = BTreeMap::new();
        let mut front = vec![from];
        for _ in 0..WAY_EDGES_MAX {
            let mut next = Vec::new();
            for &node in &front {
                let star =
                    self.start[node as usize] as usize..self.start[node as usize + 1] as usize;
                for &(other, edge) in &self.out[star] {
                    if other != from && !came.contains_key(&other) && near(other) {
                        came.insert(other, (node, edge));
                        next.push(other);
                    }
                }
            }
            if came.contains_key(&to) {
                return Some(back(&came, from, to));
            }
            front = next;
        }
        None
    }
}

/// The edges of the way from `from` to `to`.
fn back(came: &BTreeMap<u32, (u32, u32)>, from: u32, to: u32) -> Vec<u32> {
    let mut way = Vec::new();
    let mut node = to;
    while node != from {
        let (before, edge) = came[&node];
        way.push(edge);
        node = before;
    }
    way.reverse();
    way
}
