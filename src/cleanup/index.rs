//! A hash grid over segments: which edges come near a segment.

use rustc_hash::FxHashMap;

use crate::geometry::point::Point;

/// Edges by the square cells of side `side` that they pass. A segment occupies every cell that it
/// touches (and now and then one beside it), so a query misses nothing. Queries and updates cost
/// O(cells passed + edges there).
pub(super) struct Index {
    side: f64,
    /// Cells by blocks: most queries stay inside one, and hash once.
    blocks: FxHashMap<(i32, i32), Block>,
}

/// Cells a side of a block, as a power of two.
const BLOCK: u32 = 2;

/// The cells of a block, row by row.
type Block = [Vec<Held>; 1 << (2 * BLOCK)];

/// An edge with its bounding box, so that a query need not look it up.
#[derive(Clone, Copy)]
struct Held {
    edge: u32,
    min: Point,
    max: Point,
}

impl Index {
    /// An empty index with cells of `side` grid units.
    pub(super) fn new(side: f64) -> Index {
        Index {
            side,
            blocks: FxHashMap::default(),
        }
    }

    pub(super) fn insert(&mut self, edge: u32, a: Point, b: Point) {
        let blocks = &mut self.blocks;
        let (min, max) = bounding_box(a, b);
        passed(self.side, a, b, 0.0, |cell| {
            let held = Held { edge, min, max };
            blocks.entry(block(cell)).or_default()[within(cell)].push(held);
        });
    }

    pub(super) fn remove(&mut self, edge: u32, a: Point, b: Point) {
        let blocks = &mut self.blocks;
        passed(self.side, a, b, 0.0, |cell| {
            let held = blocks.get_mut(&block(cell));
            let held = &mut held.expect("a removed edge was inserted")[within(cell)];
            let at = held.iter().position(|it| it.edge == edge);
            held.swap_remove(at.expect("an edge occupies all its cells"));
        });
    }

    /// All edges whose bounding box comes within `margin` of that of the segment `a b` and that
    /// share a cell with what is within `margin` of it; sorted, each once.
    pub(super) fn near(&self, a: Point, b: Point, margin: f64, found: &mut Vec<u32>) {
        found.clear();
        let (min, max) = bounding_box(a, b);
        let reach = margin.ceil() as i32 + 1;
        let (left, right) = (min.x.saturating_sub(reach), max.x.saturating_add(reach));
        let (bottom, top) = (min.y.saturating_sub(reach), max.y.saturating_add(reach));
        let mut last: (Option<(i32, i32)>, Option<&Block>) = (None, None);
        passed(self.side, a, b, margin + 1.0, |cell| {
            if last.0 != Some(block(cell)) {
                last = (Some(block(cell)), self.blocks.get(&block(cell)));
            }
            let Some(block) = last.1 else {
                return;
            };
            for it in &block[within(cell)] {
                // one branch for all four: it is taken by few
                let is_aside =
                    (it.max.x < left) | (it.min.x > right) | (it.max.y < bottom) | (it.min.y > top);
                if !is_aside {
                    found.push(it.edge);
                }
            }
        });
        found.sort_unstable();
        found.dedup();
    }
}

fn bounding_box(a: Point, b: Point) -> (Point, Point) {
    (
        Point::new(a.x.min(b.x), a.y.min(b.y)),
        Point::new(a.x.max(b.x), a.y.max(b.y)),
    )
}

fn block((column, row): (i32, i32)) -> (i32, i32) {
    (column >> BLOCK, row >> BLOCK)
}

fn within((column, row): (i32, i32)) -> usize {
    let low = (1 << BLOCK) - 1;
    (((row & low) << BLOCK) | (column & low)) as usize
}

/// The next integer below; without a call, which `f64::floor` is on machines of no certain age.
fn floor(v: f64) -> i32 {
    let cut = v as i32;
    cut - i32::from(f64::from(cut) > v)
}

/// Calls `visit` for every cell within `margin` of the segment: column by column, the rows that
/// the segment passes inside the column widened by the margin.
fn passed(side: f64, p: Point, q: Point, margin: f64, mut visit: impl FnMut((i32, i32))) {
    let (a, b) = (p.min(q), p.max(q));
    let (ax, ay) = (f64::from(a.x), f64::from(a.y));
    let (bx, by) = (f64::from(b.x), f64::from(b.y));
    let per_side = 1.0 / side;
    let cell = |v: f64| floor(v * per_side);
    let (low, high) = (ay.min(by), ay.max(by));
    let (first, last) = (cell(ax - margin), cell(bx + margin));
    let (bottom, top) = (cell(low - margin), cell(high + margin));
    if first == last || bottom == top {
        // most segments are shorter than a cell
        for column in first..=last {
            for row in bottom..=top {
                visit((column, row));
            }
        }
        return;
    }
    let slope = if bx > ax { (by - ay) / (bx - ax) } else { 0.0 };
    for column in first..=last {
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
