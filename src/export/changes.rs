//! GeoJSON of what clean-up gave up and changed.

use crate::chunk::reader::Mesh;
use crate::chunk::views::LinesView;
use crate::export::Stats;
use crate::export::destination::Destination;
use crate::export::error::Error;
use crate::export::lines::coordinates;
use crate::export::lines::open_collection;
use crate::export::lines::quoted;
use crate::export::lines::separate;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use std::io;
use std::io::Write;

/// Words for the reasons, by their stored number; what was clipped lies outside the domain and is
/// no change.
const REASONS: [&str; 5] = [
    "clipped",
    "short-end",
    "small-loop",
    "beyond-tolerance",
    "shrunk",
];
const CLIPPED: u8 = 0;

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
    for row in 0..lines.change_at.len() {
        to.write(|file| {
            separate(file, &mut features)?;
            change(file, &lines, row)
        })?;
    }
    to.write(|file| writeln!(file, "\n]}}"))?;
    Ok(Stats {
        features,
        ..Stats::default()
    })
}

/// A dropped stretch along the line as read.
fn dropped(file: &mut dyn Write, lines: &LinesView, row: usize) -> io::Result<()> {
    let line = lines.dropped_line[row] as usize;
    let (from_m, to_m) = (lines.dropped_from_m[row], lines.dropped_to_m[row]);
    let reason = REASONS
        .get(usize::from(lines.dropped_reason[row]))
        .unwrap_or(&"unknown");
    write!(
        file,
        "{{\"type\":\"Feature\",\"properties\":{{\"source\":{},\"reason\":\"{reason}\",\"kind\":{},\
         \"name\":{},\"from_m\":{from_m:.3},\"to_m\":{to_m:.3},\"length_m\":{:.3}}},\
         \"geometry\":{{\"type\":\"LineString\",\"coordinates\":",
        lines.source[line],
        quoted(lines.kind(line)),
        quoted(lines.name(line)),
        to_m - from_m
    )?;
    coordinates(
        file,
        &stretch(lines, line, from_m, to_m),
        lines.grid.origin_m,
    )?;
    write!(file, "}}}}")
}

/// The part of `line` between two stations, local metres; at least two points.
fn stretch(lines: &LinesView, line: usize, from_m: f64, to_m: f64) -> Vec<Xy> {
    let places: Vec<Xy> = lines.local_m(line).collect();
    let stations = lines.stations_m(line);
    let at = |m: f64| {
        let k = stations
            .partition_point(|&s| s <= m)
            .clamp(1, places.len() - 1);
        let (a, b) = (places[k - 1], places[k]);
        let t = ((m - stations[k - 1]) / (stations[k] - stations[k - 1])).clamp(0.0, 1.0);
        [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
    };
    let mut part = vec![at(from_m)];
    let inner = (0..places.len()).filter(|&k| from_m < stations[k] && stations[k] < to_m);
    part.extend(inner.map(|k| places[k]));
    part.push(at(to_m));
    part
}

/// A place of change. It belongs to no single line, so its source is -1.
fn change(file: &mut dyn Write, lines: &LinesView, row: usize) -> io::Result<()> {
    let [x, y] = lines.change_at[row];
    let [x, y] = lines.grid.projected_m(Point::new(x, y));
    write!(
        file,
        "{{\"type\":\"Feature\",\"properties\":{{\"source\":-1,\"what\":{},\"moved_m\":{:.3}}},\
         \"geometry\":{{\"type\":\"Point\",\"coordinates\":[{x},{y}]}}}}",
        quoted(lines.change_what(row)),
        lines.change_moved_m[row]
    )
}
