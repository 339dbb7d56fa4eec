//! One curve and its count -> its nodes, bit-identical from both sides.
//!
//! # Promises
//! 1. A curve's nodes depend on its points, the wishes of its edges and its count alone. They are
//!    computed in the curve's own direction and reversed by who needs them reversed: both
//!    neighbours, in any tile or shard, get the same bits.
//! 2. Every node of the arrangement is a mesh node, at exactly [`Grid::local_m`] of its point; the
//!    others divide straight edges into equal parts.
//! 3. Walks are planar, **for any counts**: a mesh edge is a part of a straight edge of the
//!    arrangement, which is planar already. No chord cuts a corner, because no mesh edge passes a
//!    node of the arrangement without stopping there. (A curve of two and more edges is a chain;
//!    its count is the sum over its edges, each at least one.)
//! 4. A seam on the lattice has its nodes exactly on lattice points.
//! 5. Nodes have global ids without a global table: a point of the arrangement its index, the
//!    k-th other node of curve c the number `first[c] + k` ([`numbering`]).
//!
//! # Needs
//! Counts within the bounds of `intervals` (`parity::check`), at least one an edge.
//!
//! # Method
//! 1. [`apportion`]: shares a curve's count among its edges so that the sum of their costs (the
//!    relative deviation that `intervals` uses for curves) is least. Convex and separable, so
//!    giving one interval at a time to the edge with the least marginal cost is optimal.
//! 2. `place`: equal spacing on each edge.
//! 3. `walks`: the walks of one sub-domain, from its curves; and, by [`widths_m`], how deep the quads across narrow
//!    sub-domains are likely to be.
//!
//! # Cost
//! O(count log edges) a curve; a curve is placed twice, once for each neighbour, and never stored.
//!
//! # Not here
//! Counts (`parity`). Interior nodes (`meshing`). Grading along an edge: sizes are constant on it.

use crate::domain::line::Domain;
use crate::geometry::grid::Grid;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::intervals::apportion;
use crate::intervals::wish::EdgeWish;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::Curve;
use crate::partition::subdomains::Partition;
use crate::partition::subdomains::Subdomain;

pub mod check;
pub mod walks;

/// The nodes of one curve through `points` with `count` intervals, both ends included.
pub fn place(grid: &Grid, points: &[Point], edges: &[EdgeWish], count: u32) -> Vec<Xy> {
    let shares = apportion::apportion(edges, count);
    let mut nodes = Vec::with_capacity(count as usize + 1);
    for (ends, &share) in points.windows(2).zip(&shares) {
        for k in 0..share {
            nodes.push(part_of(grid, ends[0], ends[1], k, share));
        }
    }
    nodes.push(grid.local_m(points[points.len() - 1]));
    nodes
}

/// How wide each sub-domain is, metres: twice its area over its circumference, which is the width of a long strip.
pub fn widths_m(domain: &Domain, arrangement: &Arrangement, partition: &Partition) -> Vec<f64> {
    let length_m = |curve: &Curve| -> f64 {
        let along = curve.nodes.windows(2);
        let at = |node: u32| domain.grid.local_m(arrangement.points[node as usize]);
        along.map(|ends| distance(at(ends[0]), at(ends[1]))).sum()
    };
    let lengths_m: Vec<f64> = partition.curves.iter().map(length_m).collect();
    let width_m = |it: &Subdomain| {
        let curves = it.walks.iter().flatten().map(|half| half >> 1);
        2.0 * it.area_m2 / curves.map(|curve| lengths_m[curve as usize]).sum::<f64>()
    };
    partition.subdomains.iter().map(width_m).collect()
}

/// The point at `k / parts` of the edge from `a` to `b`; the grid's own point if it is one.
fn part_of(grid: &Grid, a: Point, b: Point, k: u32, parts: u32) -> Xy {
    let (dx, dy) = (
        i64::from(b.x) - i64::from(a.x),
        i64::from(b.y) - i64::from(a.y),
    );
    let (k, parts) = (i64::from(k), i64::from(parts));
    if dx * k % parts == 0 && dy * k % parts == 0 {
        let (x, y) = (
            i64::from(a.x) + dx * k / parts,
            i64::from(a.y) + dy * k / parts,
        );
        return grid.local_m(Point::new(x as i32, y as i32));
    }
    let along = k as f64 / parts as f64;
    [
        (f64::from(a.x) + dx as f64 * along) * grid.cell_m,
        (f64::from(a.y) + dy as f64 * along) * grid.cell_m,
    ]
}

/// The first global id of each curve's own nodes; one longer than the curves, the last entry is
/// the number of all boundary nodes. Ids below `points` are points of the arrangement.
pub fn numbering(partition: &Partition, counts: &[u32], points: usize) -> Vec<u64> {
    let mut first = Vec::with_capacity(counts.len() + 1);
    let mut next = points as u64;
    for (curve, &count) in partition.curves.iter().zip(counts) {
        first.push(next);
        next += u64::from(count) - curve.edges.len() as u64;
    }
    first.push(next);
    first
}
