//! Counts sharp angles, before and after.

use crate::geometry::point::Point;
use crate::noding::arrangement::Arrangement;

/// How many pairs of neighbouring edges around a node leave it at less than `below_deg` degrees.
///
/// O(n log n) for n edges.
pub(super) fn sharp_angles(arrangement: &Arrangement, below_deg: f64) -> u64 {
    let points = &arrangement.points;
    let mut away: Vec<(u32, f64)> = (arrangement.edges.iter())
        .flat_map(|&[a, b]| [(a, b), (b, a)])
        .map(|(from, to)| {
            (
                from,
                bearing_deg(points[from as usize], points[to as usize]),
            )
        })
        .collect();
    away.sort_by(|u, v| u.0.cmp(&v.0).then(u.1.total_cmp(&v.1)));
    away.chunk_by(|u, v| u.0 == v.0)
        .filter(|star| star.len() > 1)
        .map(|star| {
            let around = star[0].1 + 360.0 - star[star.len() - 1].1;
            let gaps = star.windows(2).map(|pair| pair[1].1 - pair[0].1);
            let is_sharp = |&gap: &f64| gap < below_deg;
            gaps.chain([around]).filter(is_sharp).count() as u64
        })
        .sum()
}

fn bearing_deg(from: Point, to: Point) -> f64 {
    let (dx, dy) = (
        f64::from(to.x) - f64::from(from.x),
        f64::from(to.y) - f64::from(from.y),
    );
    dy.atan2(dx).to_degrees()
}
