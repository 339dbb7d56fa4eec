//! Hot pixels of all tiles -> edges and pieces.

use crate::domain::line::Domain;
use crate::geometry::crossing::along;
use crate::geometry::point::Point;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::Piece;
use crate::noding::hot::TileNodes;
use crate::noding::tile::Segment;

/// A node on a segment; sorted, the nodes of each segment follow each other along it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Stop {
    segment: Segment,
    /// As in [`along`], cells². Different pixels that one segment passes never tie: on the way both
    /// coordinates change in one direction only.
    along: i64,
    node: u32,
}

/// The arrangement of the nodes of all tiles, in whatever order they come.
pub fn stitch(domain: &Domain, tiles: Vec<TileNodes>) -> Arrangement {
    let mut points: Vec<Point> = Vec::with_capacity(tiles.iter().map(|t| t.points.len()).sum());
    let mut stops = Vec::with_capacity(tiles.iter().map(|t| t.incidences.len()).sum());
    for tile in tiles {
        let first = points.len() as u32;
        for (segment, node) in tile.incidences {
            let (a, b) = segment.ends(domain);
            stops.push(Stop {
                segment,
                along: along(a, b, tile.points[node as usize]),
                node: first + node,
            });
        }
        points.extend(tile.points);
    }
    stops.sort_unstable();
    Arrangement::from_stretches(&points, stretches(domain, &stops))
}

/// One stretch from each stop of a segment to the next.
fn stretches(domain: &Domain, stops: &[Stop]) -> Vec<([u32; 2], Option<Piece>)> {
    let mut made = Vec::with_capacity(stops.len());
    for of_line in stops.chunk_by(|s, t| s.segment.line == t.segment.line) {
        let line = of_line[0].segment.line;
        let stations = domain.stations_m(line);
        for of_segment in of_line.chunk_by(|s, t| s.segment == t.segment) {
            let mut from_m = station_m(domain, &stations, of_segment[0]);
            for pair in of_segment.windows(2) {
                let to_m = station_m(domain, &stations, pair[1]);
                let piece = Piece { line, from_m, to_m };
                made.push(([pair[0].node, pair[1].node], Some(piece)));
                from_m = to_m;
            }
        }
    }
    made
}

/// The station of the foot of a node on its segment; exactly a vertex's own at the ends, and
/// strictly growing from stop to stop.
fn station_m(domain: &Domain, stations: &[f64], stop: Stop) -> f64 {
    let (a, b) = stop.segment.ends(domain);
    let at = stop.segment.at as usize;
    let length2 = a.distance2(b);
    if stop.along >= length2 {
        return stations[at + 1];
    }
    let share = stop.along as f64 / length2 as f64;
    let station = stations[at] + share * (stations[at + 1] - stations[at]);
    station.clamp(stations[at], stations[at + 1])
}
