//! Seams -> edges of the arrangement.

use crate::geometry::point::Point;
use crate::noding::arrangement::Arrangement;
use crate::seams::propose::Candidate;
use crate::seams::propose::Stop;
use crate::seams::raster::LatticeLine;

/// The arrangement with these seams, which run along these straight stretches of the lattice.
pub(super) fn splice(
    arrangement: &Arrangement,
    seams: &[Candidate],
    straights: &[[Point; 2]],
) -> Arrangement {
    let mut points = arrangement.points.clone();
    let mut edges = Vec::with_capacity(arrangement.edges.len() + 3 * seams.len());
    let splits = splits(arrangement, seams);
    let mut split = splits.iter().peekable();
    for edge in 0..arrangement.edges.len() as u32 {
        let [a, b] = arrangement.edges[edge as usize];
        let mut from = (a, 0.0);
        while let Some(&&(_, at, share)) = split.peek().filter(|it| it.0 == edge) {
            split.next();
            let to = (points.len() as u32, share);
            points.push(at);
            edges.push(arrangement.part_of(edge, from, to));
            from = to;
        }
        edges.push(arrangement.part_of(edge, from, (b, 1.0)));
    }
    let mut add = |[a, b]: [Point; 2]| {
        let first = points.len() as u32;
        points.extend([a, b]);
        edges.push(([first, first + 1], Vec::new()));
    };
    straights.iter().for_each(|&it| add(it));
    end_pieces(seams).for_each(add);
    Arrangement::from_parts(&points, edges)
}

fn end_pieces(seams: &[Candidate]) -> impl Iterator<Item = [Point; 2]> {
    (seams.iter()).flat_map(|seam| seam.stops.iter().filter_map(Stop::piece))
}

/// Where walls are split: edge, place and share of the edge's length, sorted.
fn splits(arrangement: &Arrangement, seams: &[Candidate]) -> Vec<(u32, Point, f64)> {
    let ends = seams
        .iter()
        .flat_map(|seam| seam.stops.iter().filter_map(|stop| stop.end));
    let mut splits: Vec<(u32, Point, f64)> = ends
        .filter_map(|end| {
            let edge = end.split?;
            let [a, b] = arrangement.edges[edge as usize].map(|it| arrangement.points[it as usize]);
            let (before, after) = (a.distance(end.wall), b.distance(end.wall));
            Some((edge, end.wall, before / (before + after)))
        })
        .collect();
    splits.sort_by(|p, q| p.0.cmp(&q.0).then(p.2.total_cmp(&q.2)));
    splits
}

/// The straight stretch of a seam, if it has one.
pub(super) fn straight(seam: &Candidate) -> Option<[Point; 2]> {
    let ends = seam.stops.map(|stop| stop.lattice);
    (ends[0] != ends[1]).then_some(ends)
}

/// The straight stretches, joined where nothing else of the seams meets them.
pub(super) fn joined_straights(seams: &[Candidate]) -> Vec<[Point; 2]> {
    let mut stretches: Vec<(LatticeLine, [Point; 2])> = (seams.iter())
        .filter_map(|seam| Some((seam.on, straight(seam)?)))
        .collect();
    stretches.sort_unstable();
    let mut ends: Vec<Point> = (stretches.iter()).flat_map(|(_, ends)| *ends).collect();
    ends.extend(end_pieces(seams).map(|[lattice, _]| lattice));
    ends.sort_unstable();
    let is_passed =
        |p: Point| ends.partition_point(|&it| it <= p) - ends.partition_point(|&it| it < p) == 2;
    let mut joined: Vec<(LatticeLine, [Point; 2])> = Vec::new();
    for (on, [a, b]) in stretches {
        match joined.last_mut() {
            Some((last_on, [_, last])) if *last_on == on && *last == a && is_passed(a) => *last = b,
            _ => joined.push((on, [a, b])),
        }
    }
    joined.into_iter().map(|(_, ends)| ends).collect()
}
