//! More than one row of quads in narrow places, where a kind of line wishes it.

use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::intervals::Options;
use crate::intervals::goals::Goals;
use crate::noding::arrangement::Arrangement;
use crate::partition::subdomains::Partition;
use crate::seams::pitch_cells;

/// Gives each rung as many intervals as the lines at its ends wish rows, the more demanding one of
/// them, but none shorter than [`Options::least_edge`] sizes. A rung is a seam of one edge from line to
/// line, shorter than two sizes; seams through open country are longer.
pub(super) fn raise(
    goals: &mut Goals,
    domain: &Domain,
    sizes: &SizeWish,
    arrangement: &Arrangement,
    partition: &Partition,
    options: &Options,
) {
    if sizes.rows_by_kind.iter().all(|&rows| rows <= 1) {
        return;
    }
    let wished = rows_at(domain, sizes, arrangement);
    let size = f64::from(pitch_cells(domain, sizes));
    for (id, curve) in partition.curves.iter().enumerate() {
        let &[edge] = curve.edges.as_slice() else {
            continue;
        };
        let ends = arrangement.edges[edge as usize];
        let [a, b] = ends.map(|node| arrangement.points[node as usize]);
        let rows = ends.map(|node| wished[node as usize]);
        let length = a.distance(b) / size;
        let is_rung = curve.is_seam && !rows.contains(&0) && length < 2.0;
        if !is_rung || goals.lower[id] == goals.upper[id] {
            continue;
        }
        let room = (length / options.least_edge).max(1.0) as u32;
        let rows = rows[0].max(rows[1]).min(room);
        goals.lower[id] = goals.lower[id].max(rows);
        goals.upper[id] = goals.upper[id].max(rows + 3);
        goals.goal[id] = goals.goal[id].max(f64::from(rows));
    }
}

/// Most rows that a line at each node wishes; zero where there is no line.
fn rows_at(domain: &Domain, sizes: &SizeWish, arrangement: &Arrangement) -> Vec<u32> {
    let mut wished = vec![0; arrangement.points.len()];
    for (edge, ends) in arrangement.edges.iter().enumerate() {
        for piece in arrangement.pieces_of(edge as u32) {
            let kind = domain.lines[piece.line as usize].kind;
            let rows = sizes.rows_by_kind[usize::from(kind)];
            for &node in ends {
                wished[node as usize] = rows.max(wished[node as usize]);
            }
        }
    }
    wished
}
