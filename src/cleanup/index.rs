//! A hash grid over segments: which edges come near a segment.

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use crate::geometry::point::Point;

/// Edges by the square cells of side `side` that they pass. A segment occupies every cell that it
/// touches (and now and then one beside it), so a query misses nothing. Queries and updates cost
/// O(cells passed + edges found).
pub(super) struct Index {
    side: f64,
    cells: FxHashMap<(i32, i32), SmallVec<[u32; 6]>>,
}

impl Index {
    /// An empty index with cells of `side` grid units.
    pub(super) fn new(side: f64) -> Index {
        Index {
            side,
            cells: FxHashMap::default(),
        }
    }

    pub(super) fn insert(&mut self, edge: u32, a: Point, b: Point) {
        let cells = &mut self.cells;
        passed(self.side, a, b, 0.0, |cell| {
            cells.entry(cell).or_default().push(edge);
        });
    }

    pub(super) fn remove(&mut self, edge: u32, a: Point, b: Point) {
        let cells = &mut self.cells;
        passed(self.side, a, b, 0.0, |cell| {
            let held = cells.get_mut(&cell).expect("a removed edge was inserted");
            let at = held.iter().position(|&it| it == edge);
            held.swap_remove(at.expect("an edge occupies all its cells"));
        });
    }

    /// All edges with a cell within `margin` of the segment `a b`, sorted, each once.
    pub(super) fn near(&self, a: Point, b: Point, margin: f64, found: &mut Vec<u32>) {
        found.clear();
        passed(self.side, a, b, margin + 1.0, |cell| {
            if let Some(held) = self.cells.get(&cell) {
                found.extend_from_slice(held);
            }
        });
        found.sort_unstable();
        found.dedup();
    }
}

/// Calls `visit` for every cell within `margin` of the segment: column by column, the rows that
/// the segment passes inside the column widened by the margin.
fn passed(side: f64, p: Point, q: Point, margin: f64, mut visit: impl FnMut((i32, i32))) {
    let (a, b) = (p.min(q), p.max(q));
    let (ax, ay) = (f64::from(a.x), f64::from(a.y));
    let (bx, by) = (f64::from(b.x), f64::from(b.y));
    let cell = |v: f64| (v / side).floor() as i32;
    let slope = if bx > ax { (by - ay) / (bx - ax) } else { 0.0 };
    let (low, high) = (ay.min(by), ay.max(by));
    for column in cell(ax - margin)..=cell(bx + margin) {
        let from = (f64::from(column) * side - margin).clamp(ax, bx);
        let to = (f64::from(column + 1) * side + margin).clamp(ax, bx);
        let (y0, y1) = if bx > ax {
            (ay + slope * (from - ax), ay + slope * (to - ax))
        } else {
            (ay, by)
        };
        let bottom = (y0.min(y1) - 1.0).clamp(low, high) - margin;
        let top = (y0.max(y1) + 1.0).clamp(low, high) + margin;
        for row in cell(bottom)..=cell(top) {
            visit((column, row));
        }
    }
}
