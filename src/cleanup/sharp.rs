//! Counts sharp angles, before and after.

use crate::cleanup::measure::may_be_below;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::grouped;

/// How many pairs of neighbouring edges around a node leave it at less than `below_deg` degrees.
///
/// O(n) for n edges, and the sorting of each node's own.
pub(super) fn sharp_angles(arrangement: &Arrangement, below_deg: f64) -> u64 {
    let points = &arrangement.points;
    let both = arrangement
        .edges
        .iter()
        .flat_map(|&[a, b]| [[a, b], [b, a]]);
    let halves: Vec<[u32; 2]> = both.collect();
    let order = grouped(&halves, points.len(), |half| half[0] as usize);
    let half = |it: u32| halves[it as usize];
    // most nodes are on the way of a line, and need no arc tangent
    let tangent = below_deg.to_radians().tan();
    let is_surely_blunt = |star: &[u32]| {
        let &[s, t] = star else {
            return false;
        };
        let [hub, a] = half(s).map(|node| position(points[node as usize]));
        let b = position(points[half(t)[1] as usize]);
        !may_be_below(hub, a, b, tangent)
    };
    let mut bearings_deg: Vec<f64> = Vec::new();
    let mut sharp = 0;
    for star in order.chunk_by(|&s, &t| half(s)[0] == half(t)[0]) {
        if star.len() == 1 || is_surely_blunt(star) {
            continue;
        }
        bearings_deg.clear();
        let ends = star
            .iter()
            .map(|&it| half(it).map(|node| points[node as usize]));
        bearings_deg.extend(ends.map(|[from, to]| bearing_deg(from, to)));
        let is_sharp = |&gap: &f64| gap < below_deg;
        sharp += gaps_deg(&mut bearings_deg).filter(is_sharp).count() as u64;
    }
    sharp
}

/// The angles between neighbouring bearings, all around; 360 if there is one. Sorts them.
pub(super) fn gaps_deg(bearings_deg: &mut [f64]) -> impl Iterator<Item = f64> {
    bearings_deg.sort_unstable_by(f64::total_cmp);
    let around = bearings_deg[0] + 360.0 - bearings_deg[bearings_deg.len() - 1];
    let gaps = bearings_deg.windows(2).map(|pair| pair[1] - pair[0]);
    gaps.chain([around])
}

fn bearing_deg(from: Point, to: Point) -> f64 {
    let (from, to) = (position(from), position(to));
    (to[1] - from[1]).atan2(to[0] - from[0]).to_degrees()
}

/// In cells.
fn position(p: Point) -> Xy {
    [f64::from(p.x), f64::from(p.y)]
}
