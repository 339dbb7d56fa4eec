//! The counts of an earlier mesh, handed on to the curves that lie where its curves lay.

use crate::chunk::reader::Mesh;
use crate::domain::line::Domain;
use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::Partition;

/// How far the ends of a curve, and its length, may be off, sizes.
const NEAR: f64 = 0.25;

/// A curve as far as it is compared.
struct Course {
    ends_m: [Xy; 2],
    length_m: f64,
}

impl Course {
    fn along(points_m: &[Xy]) -> Course {
        Course {
            ends_m: [points_m[0], points_m[points_m.len() - 1]],
            length_m: points_m.windows(2).map(|it| distance(it[0], it[1])).sum(),
        }
    }

    /// How far apart two curves are, the other one seen in this direction.
    fn apart_m(&self, other: &Course, reversed: bool) -> f64 {
        let [from, to] = [
            other.ends_m[usize::from(reversed)],
            other.ends_m[usize::from(!reversed)],
        ];
        distance(self.ends_m[0], from)
            .max(distance(self.ends_m[1], to))
            .max((self.length_m - other.length_m).abs())
    }
}

/// The count of each curve in `mesh`; `None` for what has no curve there.
pub fn counts(
    mesh: &Mesh,
    domain: &Domain,
    arrangement: &Arrangement,
    partition: &Partition,
) -> Vec<Option<u32>> {
    let frame = mesh.frame();
    let origin_m = mesh.index().grid.origin_m;
    let near_m = NEAR * mesh.index().size_m;
    let old: Vec<Course> = (0..frame.curves())
        .map(|curve| {
            let nodes = frame
                .nodes_of(curve)
                .iter()
                .map(|&node| frame.nodes[node as usize]);
            let points_m: Vec<Xy> = nodes
                .map(|at| [at[0] + origin_m[0], at[1] + origin_m[1]])
                .collect();
            Course::along(&points_m)
        })
        .collect();
    let square = |at_m: Xy| at_m.map(|v| (v / near_m).floor() as i64);
    let mut ends: Vec<([i64; 2], u32, bool)> = Vec::with_capacity(2 * old.len());
    for (id, course) in (0..).zip(&old) {
        ends.push((square(course.ends_m[0]), id, false));
        ends.push((square(course.ends_m[1]), id, true));
    }
    ends.sort_unstable();
    let nearest = |course: &Course| {
        let [x, y] = square(course.ends_m[0]);
        let mut best: Option<(f64, u32)> = None;
        for column in x - 1..=x + 1 {
            let from = ends.partition_point(|it| it.0 < [column, y - 1]);
            let in_column = ends[from..].iter().take_while(|it| it.0 <= [column, y + 1]);
            for &(_, id, reversed) in in_column {
                let apart_m = course.apart_m(&old[id as usize], reversed);
                if apart_m <= near_m && best.is_none_or(|least| (apart_m, id) < least) {
                    best = Some((apart_m, id));
                }
            }
        }
        best.map(|(_, id)| frame.count(id as usize))
    };
    (partition.curves.iter())
        .map(|curve| {
            let nodes = curve
                .nodes
                .iter()
                .map(|&node| arrangement.points[node as usize]);
            let points_m: Vec<Xy> = nodes.map(|it| domain.grid.projected_m(it)).collect();
            nearest(&Course::along(&points_m))
        })
        .collect()
}
