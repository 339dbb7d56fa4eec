//! Where each stretch of a line went: what clean-up moved and merged, told from the mesh alone.

use crate::chunk::reader::Mesh;
use crate::chunk::views::FrameView;
use crate::chunk::views::LinesView;
use crate::geometry::point::Xy;
use crate::geometry::quad::distance;

/// A stretch of a line, and the straight way between two nodes of the cleaned line work that
/// represents it.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// The line.
    pub line: u32,
    /// Stations of the stretch, metres, `from_m <= to_m`.
    pub from_m: f64,
    /// Its end.
    pub to_m: f64,
    /// The stretch as read, local metres.
    pub before: Vec<Xy>,
    /// The way that represents it, in the direction of the line.
    pub after: [Xy; 2],
    /// Largest distance of the stretch from it, metres.
    pub moved_m: f64,
    /// The other lines that it represents too, if they were apart.
    pub merged_with: Vec<u32>,
}

/// Stretches that lie nearer than this to each other were one line before, metres.
const APART_M: f64 = 0.005;

/// All stretches that were merged with another line, or moved by more than `least_m`.
pub fn moves(mesh: &Mesh, least_m: f64) -> Vec<Move> {
    let (frame, lines) = (mesh.frame(), mesh.lines());
    let stations: Vec<Vec<f64>> = (0..lines.lines()).map(|it| lines.stations_m(it)).collect();
    let mut moves = Vec::new();
    for curve in (0..frame.curves()).filter(|&it| !frame.is_seam(it)) {
        let (nodes, edges) = (frame.nodes_of(curve), frame.edges_of(curve));
        let mut from = 0;
        for to in 1..nodes.len() {
            if nodes[to] >= frame.fixed_nodes && to + 1 < nodes.len() {
                continue;
            }
            let ends = [nodes[from], nodes[to]].map(|node| frame.nodes[node as usize]);
            let rows = [edges.start + from, edges.start + to - 1];
            let made = moves_on(&frame, &lines, &stations, ends, rows);
            moves.extend(made.into_iter().filter(|it| {
                it.moved_m > least_m || (it.moved_m > APART_M && !it.merged_with.is_empty())
            }));
            from = to;
        }
    }
    moves.sort_by(|a, b| a.line.cmp(&b.line).then(a.from_m.total_cmp(&b.from_m)));
    moves
}

/// The stretches on the way from one fixed node to the next, whose first and last mesh edges are
/// these: the pieces of both are in the same order.
fn moves_on(
    frame: &FrameView,
    lines: &LinesView,
    stations: &[Vec<f64>],
    ends: [Xy; 2],
    [first, last]: [usize; 2],
) -> Vec<Move> {
    let pairs = frame.pieces_of(first).zip(frame.pieces_of(last));
    let mut made: Vec<Move> = Vec::new();
    for (first, last) in pairs {
        let line = frame.piece_line[first];
        let span = [frame.piece_from_m[first], frame.piece_to_m[last]];
        let (from_m, to_m) = (span[0].min(span[1]), span[0].max(span[1]));
        let before = stretch(lines, &stations[line as usize], line as usize, from_m, to_m);
        let after = if span[0] <= span[1] {
            ends
        } else {
            [ends[1], ends[0]]
        };
        let away = before.iter().map(|&p| to_segment_m(p, after));
        let moved_m = away.fold(0.0, f64::max);
        made.push(Move {
            line,
            from_m,
            to_m,
            before,
            after,
            moved_m,
            merged_with: Vec::new(),
        });
    }
    let apart: Vec<(u32, bool)> = made
        .iter()
        .map(|it| (it.line, it.moved_m > APART_M))
        .collect();
    for it in &mut made {
        let is_apart = it.moved_m > APART_M;
        let others =
            (apart.iter()).filter(|(line, is_other)| *line != it.line && (*is_other || is_apart));
        it.merged_with = others.map(|(line, _)| *line).collect();
        it.merged_with.dedup();
    }
    made
}

/// The part of `line` between two stations, local metres; at least two points.
pub fn stretch(
    lines: &LinesView,
    stations_m: &[f64],
    line: usize,
    from_m: f64,
    to_m: f64,
) -> Vec<Xy> {
    let place = |k: usize| {
        let [x, y] = lines.points_of(line)[k];
        lines.grid.local_m(crate::geometry::point::Point::new(x, y))
    };
    let at = |m: f64| {
        let k = stations_m.partition_point(|&s| s <= m);
        let k = k.clamp(1, stations_m.len() - 1);
        let (a, b) = (place(k - 1), place(k));
        let t = ((m - stations_m[k - 1]) / (stations_m[k] - stations_m[k - 1])).clamp(0.0, 1.0);
        [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
    };
    let inner =
        stations_m.partition_point(|&s| s <= from_m)..stations_m.partition_point(|&s| s < to_m);
    let mut part = vec![at(from_m)];
    part.extend(inner.map(place));
    part.push(at(to_m));
    part
}

fn to_segment_m(p: Xy, [a, b]: [Xy; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let along = (p[0] - a[0]) * dx + (p[1] - a[1]) * dy;
    let t = (along / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    distance(p, [a[0] + t * dx, a[1] + t * dy])
}
