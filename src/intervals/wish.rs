//! What one straight edge wishes: its real count and its bounds.

use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::geometry::point::Point;
use crate::noding::arrangement::Arrangement;
use crate::seams::pitch_cells;

/// The wish of one edge of the arrangement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeWish {
    /// Wished (real) number of intervals: length / size, or the exact count of a lattice seam.
    pub goal: f64,
    /// Least count.
    pub lower: u32,
    /// Largest count; `u32::MAX` unless the count is fixed.
    pub upper: u32,
}

impl EdgeWish {
    /// The one count that is allowed, if there is only one.
    pub fn fixed(&self) -> Option<u32> {
        (self.lower == self.upper).then_some(self.lower)
    }
}

/// The wish of edge `edge`.
pub fn edge_wish(
    domain: &Domain,
    sizes: &SizeWish,
    arrangement: &Arrangement,
    edge: u32,
) -> EdgeWish {
    let [a, b] = arrangement.edges[edge as usize].map(|node| arrangement.points[node as usize]);
    let pieces = arrangement.pieces_of(edge);
    if pieces.is_empty() {
        let pitch = pitch_cells(domain, sizes);
        if let Some(count) = lattice_count(a, b, pitch) {
            return EdgeWish {
                goal: f64::from(count),
                lower: count,
                upper: count,
            };
        }
    }
    let size_m = (pieces.iter())
        .map(|piece| sizes.by_kind_m[usize::from(domain.lines[piece.line as usize].kind)])
        .reduce(f64::min)
        .unwrap_or(sizes.default_m);
    EdgeWish {
        goal: a.distance(b) * domain.grid.cell_m / size_m,
        lower: 1,
        upper: u32::MAX,
    }
}

/// Number of pitches between two lattice nodes on one row or column; `None` for other points.
fn lattice_count(a: Point, b: Point, pitch: i32) -> Option<u32> {
    let on_lattice = [a.x, a.y, b.x, b.y].iter().all(|v| v % pitch == 0);
    let straight = a.x == b.x || a.y == b.y;
    let cells = a.x.abs_diff(b.x) + a.y.abs_diff(b.y);
    (on_lattice && straight).then(|| cells / pitch as u32)
}
