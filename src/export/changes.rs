//! GeoJSON of what clean-up gave up and changed.

use crate::chunk::moves;
use crate::chunk::moves::Move;
use crate::chunk::moves::stretch;
use crate::chunk::reader::Mesh;
use crate::chunk::views::FrameView;
use crate::chunk::views::LinesView;
use crate::cleanup::changes::Reason;
use crate::export::Stats;
use crate::export::destination::Destination;
use crate::export::error::Error;
use crate::export::lines::coordinates;
use crate::export::lines::open_collection;
use crate::export::lines::quoted;
use crate::export::lines::separate;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use std::io;
use std::io::Write;

/// What was clipped lies outside the domain and is no change.
const CLIPPED: u8 = 0;

/// Lines that moved less than this share of the size are not drawn, unless they were merged: the
/// layer is for what one may argue about.
pub const MOVED_LEAST: f64 = 0.1;

pub(crate) fn write(mesh: &Mesh, to: &mut Destination) -> Result<Stats, Error> {
    let lines = mesh.lines();
    let mut features = 0;
    to.write(|file| open_collection(file, mesh.index().epsg))?;
    for row in 0..lines.dropped_line.len() {
        let line = lines.dropped_line[row] as usize;
        if lines.dropped_reason[row] == CLIPPED || lines.role[line] != 0 {
            continue;
        }
        to.write(|file| {
            separate(file, &mut features)?;
            dropped(file, &lines, row)
        })?;
    }
    let moves = moves::moves(mesh, MOVED_LEAST * mesh.index().size_m);
    for (id, it) in moves.iter().enumerate() {
        for (state, way) in [("before", &it.before[..]), ("after", &it.after)] {
            to.write(|file| {
                separate(file, &mut features)?;
                moved(file, &lines, (id, it), state, way)
            })?;
        }
    }
    let nearby = Nearby::of(mesh);
    for row in 0..lines.change_at.len() {
        to.write(|file| {
            separate(file, &mut features)?;
            change(file, &lines, &nearby, row)
        })?;
    }
    to.write(|file| writeln!(file, "\n]}}"))?;
    Ok(Stats {
        features,
        ..Stats::default()
    })
}

/// One state of a stretch that was moved or merged. Both states have the same `id`.
fn moved(
    file: &mut dyn Write,
    lines: &LinesView,
    (id, it): (usize, &Move),
    state: &str,
    way: &[Xy],
) -> io::Result<()> {
    let line = it.line as usize;
    let what = match it.merged_with.is_empty() {
        true => "moved",
        false => "merged",
    };
    write!(
        file,
        "{{\"type\":\"Feature\",\"properties\":{{\"source\":{},\"what\":\"{what}\",\"state\":\"{state}\",\
         \"id\":{id},\"kind\":{},\"name\":{},\"with\":{},\"from_m\":{:.3},\"to_m\":{:.3},\
         \"length_m\":{:.3},\"moved_m\":{:.3}}},\"geometry\":{{\"type\":\"LineString\",\"coordinates\":",
        lines.source[line],
        quoted(lines.kind(line)),
        quoted(lines.name(line)),
        quoted(&named(lines, &it.merged_with)),
        it.from_m,
        it.to_m,
        it.to_m - it.from_m,
        it.moved_m
    )?;
    coordinates(file, way, lines.grid.origin_m)?;
    write!(file, "}}}}")
}

/// Lines in words, each once.
fn named(lines: &LinesView, which: &[u32]) -> String {
    let words = which.iter().map(|&line| lines.words_for(line as usize));
    words.collect::<Vec<_>>().join(", ")
}

/// The lines at the nodes of the cleaned line work, by place.
struct Nearby<'a> {
    frame: FrameView<'a>,
    cell_m: f64,
    /// (cell, node, edge), sorted.
    rows: Vec<([i32; 2], u32, u32)>,
}

impl<'a> Nearby<'a> {
    fn of(mesh: &'a Mesh) -> Nearby<'a> {
        let (frame, cell_m) = (mesh.frame(), mesh.index().size_m);
        let mut rows = Vec::new();
        for curve in (0..frame.curves()).filter(|&it| !frame.is_seam(it)) {
            for (edge, pair) in frame.edges_of(curve).zip(frame.nodes_of(curve).windows(2)) {
                for &node in pair.iter().filter(|&&node| node < frame.fixed_nodes) {
                    let cell = frame.nodes[node as usize].map(|v| (v / cell_m).floor() as i32);
                    rows.push((cell, node, edge as u32));
                }
            }
        }
        rows.sort_unstable();
        Nearby {
            frame,
            cell_m,
            rows,
        }
    }

    /// The lines at the node that is nearest to `p`, if one is within a mesh size.
    fn lines_at(&self, p: Xy) -> Vec<u32> {
        let [x, y] = p.map(|v| (v / self.cell_m).floor() as i32);
        let mut best = (self.cell_m, &self.rows[..0]);
        for cell in (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x + i, y + j])) {
            let from = self.rows.partition_point(|it| it.0 < cell);
            let to = self.rows.partition_point(|it| it.0 <= cell);
            for star in self.rows[from..to].chunk_by(|a, b| a.1 == b.1) {
                let away_m = distance(self.frame.nodes[star[0].1 as usize], p);
                if away_m < best.0 {
                    best = (away_m, star);
                }
            }
        }
        let pieces = (best.1.iter()).flat_map(|it| self.frame.pieces_of(it.2 as usize));
        let mut lines: Vec<u32> = pieces.map(|row| self.frame.piece_line[row]).collect();
        lines.sort_unstable();
        lines.dedup();
        lines
    }
}

/// A dropped stretch along the line as read.
fn dropped(file: &mut dyn Write, lines: &LinesView, row: usize) -> io::Result<()> {
    let line = lines.dropped_line[row] as usize;
    let (from_m, to_m) = (lines.dropped_from_m[row], lines.dropped_to_m[row]);
    let reason = (Reason::WORDS)
        .get(usize::from(lines.dropped_reason[row]))
        .unwrap_or(&"unknown");
    write!(
        file,
        "{{\"type\":\"Feature\",\"properties\":{{\"source\":{},\"what\":\"dropped\",\"state\":\"before\",\"reason\":\"{reason}\",\"kind\":{},\
         \"name\":{},\"from_m\":{from_m:.3},\"to_m\":{to_m:.3},\"length_m\":{:.3}}},\
         \"geometry\":{{\"type\":\"LineString\",\"coordinates\":",
        lines.source[line],
        quoted(lines.kind(line)),
        quoted(lines.name(line)),
        to_m - from_m
    )?;
    coordinates(
        file,
        &stretch(lines, &lines.stations_m(line), line, from_m, to_m),
        lines.grid.origin_m,
    )?;
    write!(file, "}}}}")
}

/// A place of change. It belongs to no single line, so its source is -1; `with` names the lines that
/// are there now.
fn change(file: &mut dyn Write, lines: &LinesView, nearby: &Nearby, row: usize) -> io::Result<()> {
    let [x, y] = lines.change_at[row];
    let at = Point::new(x, y);
    let there = nearby.lines_at(lines.grid.local_m(at));
    let [x, y] = lines.grid.projected_m(at);
    write!(
        file,
        "{{\"type\":\"Feature\",\"properties\":{{\"source\":-1,\"what\":{},\"with\":{},\"moved_m\":{:.3}}},\
         \"geometry\":{{\"type\":\"Point\",\"coordinates\":[{x},{y}]}}}}",
        quoted(lines.change_what(row)),
        quoted(&named(lines, &there)),
        lines.change_moved_m[row]
    )
}
