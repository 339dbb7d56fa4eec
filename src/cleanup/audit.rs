//! Measures the result against the input: what is covered, how far it moved, what was lost.

use crate::cleanup::changes::Dropped;
use crate::cleanup::changes::Reason;
use crate::cleanup::changes::Tally;
use crate::cleanup::graph::Graph;
use crate::cleanup::measure::Measure;
use crate::cleanup::measure::distance;
use crate::cleanup::measure::quarters;
use crate::cleanup::measure::to_segment;
use crate::cleanup::measure::to_segment_m2;
use crate::domain::line::LineId;
use crate::geometry::point::Xy;
use crate::noding::arrangement::Piece;
use crate::noding::arrangement::grouped;
use smallvec::SmallVec;

/// A stretch of a line: line, from, to.
pub(super) type Stretch = (LineId, f64, f64);

/// Stretches shorter than this are rounding, metres.
const ROUNDING_M: f64 = 1e-6;

/// What came in and is not in the result, with the reason. `given`: the [`stretches`] of the input.
pub(super) fn missing(graph: &Graph, given: &[Stretch]) -> Vec<Dropped> {
    let live = graph.live();
    let pieces = live.iter().flat_map(|&edge| &graph.pieces[edge as usize]);
    let there = stretches(graph.measure, pieces);
    let carriers = carriers(graph);
    let mut known: Vec<&Dropped> = graph.dropped.iter().collect();
    known.sort_by_key(|it| it.line);
    (subtract(given, &there).iter())
        .flat_map(|it| uncovered(graph, &carriers, it, 0.0))
        .map(|(line, from_m, to_m)| Dropped {
            line,
            reason: reason(graph, &known, (line, from_m, to_m)),
            from_m,
            to_m,
        })
        .collect()
}

/// The union of the pieces, sorted; of constraint lines only.
pub(super) fn stretches<'p>(
    measure: &Measure,
    pieces: impl Iterator<Item = &'p Piece>,
) -> Vec<Stretch> {
    let all: Vec<Stretch> = pieces
        .filter(|piece| !measure.is_rim(piece.line))
        .map(|it| (it.line, it.from_m.min(it.to_m), it.from_m.max(it.to_m)))
        .collect();
    let lines = measure.domain.lines.len();
    let order = grouped(&all, lines, |it| it.0 as usize);
    let mut here: Vec<Stretch> = Vec::new();
    let mut union: Vec<Stretch> = Vec::new();
    for of_line in order.chunk_by(|&s, &t| all[s as usize].0 == all[t as usize].0) {
        here.clear();
        here.extend(of_line.iter().map(|&it| all[it as usize]));
        here.sort_unstable_by(|a, b| a.1.total_cmp(&b.1).then(a.2.total_cmp(&b.2)));
        for &(line, from, to) in &here {
            match union.last_mut() {
                Some(last) if last.0 == line && from <= last.2 + ROUNDING_M => {
                    last.2 = last.2.max(to);
                }
                _ => union.push((line, from, to)),
            }
        }
    }
    union
}

/// What is in `wanted` and not in `there`; both sorted unions.
pub(super) fn subtract(wanted: &[Stretch], there: &[Stretch]) -> Vec<Stretch> {
    let mut missing = Vec::new();
    let mut k = 0;
    for &(line, from, to) in wanted {
        while k < there.len() && (there[k].0 < line || (there[k].0 == line && there[k].2 <= from)) {
            k += 1;
        }
        let (mut at, mut j) = (from, k);
        while j < there.len() && there[j].0 == line && there[j].1 < to {
            if there[j].1 > at + ROUNDING_M {
                missing.push((line, at, there[j].1));
            }
            at = at.max(there[j].2);
            j += 1;
        }
        if to > at + ROUNDING_M {
            missing.push((line, at, to));
        }
    }
    missing
}

/// All (line, edge) pairs, sorted.
pub(super) fn carriers(graph: &Graph) -> Vec<(LineId, u32)> {
    let mut carriers = Vec::new();
    for edge in graph.live() {
        let pieces = &graph.pieces[edge as usize];
        carriers.extend(pieces.iter().map(|piece| (piece.line, edge)));
    }
    carriers.sort_unstable();
    carriers.dedup();
    carriers
}

/// The parts of a stretch that are beyond tolerance of all edges that carry the line.
pub(super) fn uncovered(
    graph: &Graph,
    carriers: &[(LineId, u32)],
    &(line, from, to): &Stretch,
    slack_m: f64,
) -> Vec<Stretch> {
    let own = &carriers[carriers.partition_point(|it| it.0 < line)..];
    let own = &own[..own.partition_point(|it| it.0 == line)];
    let limit = graph.measure.tolerance_m(line) + slack_m;
    let away = |station: f64| {
        let p = graph.measure.point(line, station);
        (own.iter())
            .map(|&(_, edge)| {
                let (a, b) = graph.ends_m(edge);
                to_segment(p, a, b).0
            })
            .fold(f64::INFINITY, f64::min)
    };
    let finest_m = 1e-4 * graph.measure.size_m[line as usize];
    let mut parts: Vec<Stretch> = Vec::new();
    let mut open = vec![(from, to)];
    while let Some((low, high)) = open.pop() {
        // Distance to a set changes no faster than the way along the line.
        let (at_low, at_high) = (away(low), away(high));
        if 0.5 * (at_low + at_high + high - low) <= limit {
            continue;
        }
        let is_beyond = at_low > limit && at_high > limit;
        if high - low
            > if is_beyond {
                100.0 * finest_m
            } else {
                finest_m
            }
        {
            let middle = 0.5 * (low + high);
            open.push((middle, high));
            open.push((low, middle));
            continue;
        }
        match parts.last_mut() {
            Some(last) if last.2 == low => last.2 = high,
            _ => parts.push((line, low, high)),
        }
    }
    parts
}

/// Why a stretch is not there: what the operation said that dropped it, if one is known.
fn reason(graph: &Graph, known: &[&Dropped], (line, from_m, to_m): Stretch) -> Reason {
    if is_a_node(graph, line, from_m, to_m) {
        return Reason::Shrunk;
    }
    let own = &known[known.partition_point(|it| it.line < line)..];
    let own = &own[..own.partition_point(|it| it.line == line)];
    let middle = 0.5 * (from_m + to_m);
    (own.iter())
        .find(|it| it.from_m <= middle && middle <= it.to_m)
        .or(own.first())
        .map_or(Reason::BeyondTolerance, |it| it.reason)
}

/// True if a whole line, shorter than the mesh size, lies within tolerance of one node.
fn is_a_node(graph: &Graph, line: LineId, from_m: f64, to_m: f64) -> bool {
    let limit = graph.measure.tolerance_m(line);
    let is_whole = to_m - from_m >= graph.measure.length_m(line) - ROUNDING_M;
    if !is_whole || to_m - from_m > graph.measure.size_m[line as usize] {
        return false;
    }
    let way: Vec<Xy> = graph.measure.way(&Piece { line, from_m, to_m }).collect();
    let cell_m = graph.measure.grid().cell_m;
    let at = graph.measure.on_grid(way[0]);
    (graph.index).any(at, at, limit / cell_m, |held| {
        held.at().iter().any(|&node| {
            let node = graph.measure.metres(node);
            way.iter().all(|&p| distance(p, node) <= limit)
        })
    })
}

/// Largest and 99 % displacement by length, of every segment of every piece from the edges of its
/// line: its own one and those before and after. Where a line turns, the stretches that belong to
/// the one edge and to the other part at a place that is not always the nearest to both.
pub(super) fn displacements(graph: &Graph) -> Tally {
    let mut samples: Vec<Sample> = Vec::new();
    let live = graph.live();
    let pieces: usize = live.iter().map(|&it| graph.pieces[it as usize].len()).sum();
    // one for each segment of each piece, which hold the vertices between them
    samples.reserve(pieces + graph.measure.vertices_len());
    // at vertices, which have no length
    let mut worst = [0.0_f64; 2];
    let mut way: Vec<Xy> = Vec::new();
    for edge in live {
        for piece in &graph.pieces[edge as usize] {
            let sides = sides_of_line(graph, edge, piece.line);
            let away_m = |p: Xy| {
                // one root for all of them
                let all = sides.iter().map(|&(a, b)| to_segment_m2(p, a, b).0);
                all.fold(f64::INFINITY, f64::min).sqrt()
            };
            let size_m = graph.measure.size_m[piece.line as usize];
            way.clear();
            way.extend(graph.measure.way(piece));
            for pair in way.windows(2) {
                let [u, v] = [pair[0], pair[1]];
                let length = distance(u, v);
                samples.push(Sample {
                    away_m: quarters(u, v).map(away_m),
                    length_m: (length / 4.0) as f32,
                    line: piece.line,
                });
            }
            for &p in &way {
                let away = away_m(p);
                worst = [worst[0].max(away), worst[1].max(away / size_m)];
            }
        }
    }
    let size_m = &graph.measure.size_m;
    let [displacement_max_m, displacement_p99_m] = extremes(&samples, |it| it.away_m, worst[0]);
    let [displacement_max_over_size, displacement_p99_over_size] = extremes(
        &samples,
        |it| it.away_m.map(|away| away / size_m[it.line as usize]),
        worst[1],
    );
    Tally {
        displacement_max_m,
        displacement_p99_m,
        displacement_max_over_size,
        displacement_p99_over_size,
        ..Tally::default()
    }
}

/// An edge and the edges of the same line that it meets.
fn sides_of_line(graph: &Graph, edge: u32, line: LineId) -> SmallVec<[(Xy, Xy); 4]> {
    let ends = graph.edges[edge as usize].ends;
    let stars = ends.map(|node| &graph.star[node as usize]);
    let carries = |edge: u32| {
        let mut pieces = graph.pieces[edge as usize].iter();
        pieces.any(|piece| piece.line == line)
    };
    let near = stars.into_iter().flatten().filter(|&&it| carries(it));
    near.map(|&it| graph.ends_m(it)).collect()
}

/// A segment of a stretch.
struct Sample {
    /// Of the middle of each quarter, from the edges of its line.
    away_m: [f64; 4],
    /// Of a quarter.
    length_m: f32,
    line: LineId,
}

/// Bins that values are counted in, before those of one bin are sorted.
const BINS: usize = 4096;

/// Largest value, at least `worst`, and 99 % quantile by length. O(n): only the bin that the
/// quantile lies in is sorted.
fn extremes(samples: &[Sample], values: impl Fn(&Sample) -> [f64; 4], worst: f64) -> [f64; 2] {
    let all = || (samples.iter()).flat_map(|it| values(it).map(|value| (value, it.length_m)));
    let largest = all().map(|it| it.0).fold(worst, f64::max);
    let bin = |value: f64| ((value / largest * BINS as f64) as usize).min(BINS - 1);
    let mut length_m = vec![0.0; BINS];
    for (value, part_m) in all() {
        length_m[bin(value)] += f64::from(part_m);
    }
    let mut rest_m = 0.99 * length_m.iter().sum::<f64>();
    let mut is_before = |more_m: f64| {
        let is_before = more_m < rest_m;
        rest_m -= if is_before { more_m } else { 0.0 };
        is_before
    };
    let last = BINS - 1;
    let from = (0..last).find(|&k| !is_before(length_m[k]));
    let from = from.unwrap_or(last);
    let mut here: Vec<(f64, f32)> = all().filter(|it| bin(it.0) == from).collect();
    here.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let quantile = here.iter().find(|it| !is_before(f64::from(it.1)));
    [largest, quantile.or(here.last()).map_or(0.0, |it| it.0)]
}

/// How often each kind of change happened, and how far it moved things.
pub(super) fn rows(graph: &Graph) -> Vec<(&'static str, u64, f64)> {
    let mut rows: Vec<(&'static str, u64, f64)> = Vec::new();
    for change in &graph.changes {
        match rows.iter_mut().find(|row| row.0 == change.what) {
            Some(row) => {
                row.1 += 1;
                row.2 = row.2.max(change.moved_m);
            }
            None => rows.push((change.what, 1, change.moved_m)),
        }
    }
    rows.sort_by(|a, b| a.0.cmp(b.0));
    rows
}
