//! Hot pixels of all tiles -> edges and pieces.

use crate::domain::line::Domain;
use crate::geometry::point::Point;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::Piece;
use crate::noding::arrangement::SortedPoints;
use crate::noding::arrangement::Stretch;
use crate::noding::arrangement::grouped;
use crate::noding::hot::Stop;
use crate::noding::hot::TileNodes;

/// What was found in all tiles, beside each other.
pub struct Gathered {
    points: Vec<Point>,
    /// Nodes are indices into `points`.
    stops: Vec<Stop>,
}

/// The arrangement of the nodes of all tiles, in whatever order they come.
pub fn stitch(domain: &Domain, tiles: Vec<TileNodes>) -> Arrangement {
    let gathered = gather(tiles);
    let (nodes, stretches) = (gathered.nodes(), gathered.stretches(domain));
    drop(gathered);
    Arrangement::from_sorted(nodes, stretches)
}

/// Puts the nodes of all tiles beside each other.
pub fn gather(tiles: Vec<TileNodes>) -> Gathered {
    let mut points: Vec<Point> = Vec::with_capacity(tiles.iter().map(|t| t.points.len()).sum());
    let mut stops = Vec::with_capacity(tiles.iter().map(|t| t.stops.len()).sum());
    for tile in tiles {
        let first = points.len() as u32;
        stops.extend(tile.stops.into_iter().map(|stop| Stop {
            node: first + stop.node,
            ..stop
        }));
        points.extend(tile.points);
    }
    Gathered { points, stops }
}

impl Gathered {
    /// The nodes in order.
    pub fn nodes(&self) -> SortedPoints {
        SortedPoints::of(&self.points)
    }

    /// One stretch from each stop of a segment to the next; it needs no order of the nodes.
    pub fn stretches(&self, domain: &Domain) -> Vec<Stretch> {
        let mut first = vec![0];
        for line in &domain.lines {
            first.push(first[first.len() - 1] + line.points.len());
        }
        let segment = |it: &Stop| first[it.segment.line as usize] + it.segment.at as usize;
        let order = grouped(&self.stops, first[first.len() - 1], segment);
        stretches(domain, &self.stops, &order)
    }
}

/// `order`: of the stops, by segment.
fn stretches(domain: &Domain, stops: &[Stop], order: &[u32]) -> Vec<Stretch> {
    let mut made = Vec::with_capacity(stops.len());
    let (mut here, mut at_m) = (Vec::new(), Vec::new());
    let segment = |it: u32| stops[it as usize].segment;
    for of_line in order.chunk_by(|&s, &t| segment(s).line == segment(t).line) {
        let line = segment(of_line[0]).line;
        let stations = domain.stations_m(line);
        for of_segment in of_line.chunk_by(|&s, &t| segment(s) == segment(t)) {
            here.clear();
            here.extend(of_segment.iter().map(|&it| stops[it as usize]));
            here.sort_unstable();
            stations_of(domain, &stations, &here, &mut at_m);
            for (pair, at_m) in here.windows(2).zip(at_m.windows(2)) {
                let (from_m, to_m) = (at_m[0], at_m[1]);
                let piece = Piece { line, from_m, to_m };
                made.push(([pair[0].node, pair[1].node], Some(piece)));
            }
        }
    }
    made
}

/// Stations of the feet of all stops of one segment: exactly a vertex's own at the ends, and
/// strictly growing, since they tell the direction of a piece. Feet of neighbouring pixels on a
/// steep segment of 100 km may be closer than two floats are; those move apart by the last bit.
fn stations_of(domain: &Domain, stations: &[f64], stops: &[Stop], at_m: &mut Vec<f64>) {
    let (a, b) = stops[0].segment.ends(domain);
    let at = stops[0].segment.at as usize;
    let (start_m, end_m) = (stations[at], stations[at + 1]);
    let length2 = a.distance2(b) as f64;
    at_m.clear();
    for stop in stops {
        let foot_m = start_m + stop.along as f64 / length2 * (end_m - start_m);
        at_m.push(match at_m.last() {
            Some(before_m) => foot_m.max(before_m.next_up()),
            None => start_m,
        });
    }
    *at_m.last_mut().expect("a segment passes its own ends") = end_m;
    for i in (1..at_m.len() - 1).rev() {
        at_m[i] = at_m[i].min(at_m[i + 1].next_down());
    }
}
