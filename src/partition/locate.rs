//! Points -> the sub-domains that they lie in.

use crate::geometry::point::Point;
use crate::noding::arrangement::Arrangement;
use crate::partition::nest::halves_below;
use crate::partition::subdomains::OUTSIDE;
use crate::partition::subdomains::Partition;
use crate::partition::subdomains::SubdomainId;

/// The sub-domain of each point; that on either side, if it lies on an edge. O((n + m) log (n + m))
/// for n edges and m points.
pub fn subdomains_at(
    arrangement: &Arrangement,
    partition: &Partition,
    points: &[Point],
) -> Vec<SubdomainId> {
    let side = sides(arrangement, partition);
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_unstable_by_key(|&k| points[k as usize]);
    let sorted: Vec<Point> = order.iter().map(|&k| points[k as usize]).collect();
    let mut found = vec![OUTSIDE; points.len()];
    for (k, below) in order.iter().zip(halves_below(arrangement, &sorted)) {
        found[*k as usize] = below.map_or(OUTSIDE, |half| side[half as usize]);
    }
    found
}

/// The sub-domain on the left of each half-edge.
pub fn sides(arrangement: &Arrangement, partition: &Partition) -> Vec<SubdomainId> {
    let mut side = vec![OUTSIDE; 2 * arrangement.edges.len()];
    for curve in &partition.curves {
        for (&edge, &from) in curve.edges.iter().zip(&curve.nodes) {
            let against = u32::from(arrangement.edges[edge as usize][0] != from);
            side[(edge << 1 | against) as usize] = curve.left;
            side[(edge << 1 | (against ^ 1)) as usize] = curve.right;
        }
    }
    side
}
