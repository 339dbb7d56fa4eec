//! A grid of square cells over a window, and what lies in each.

use crate::geometry::point::Point;
use crate::geometry::window::Window;

/// The cells of a grid, by blocks: most queries stay inside one, and most blocks around a city are
/// empty.
pub(super) struct Cells<T> {
    pub(super) grid: Grid,
    /// Where each block is, row by row.
    table: Vec<u32>,
    /// The first one is that of all empty cells.
    blocks: Vec<Block<T>>,
}

/// Cells a side of a block, as a power of two.
const BLOCK: u32 = 2;

/// The cells of a block, row by row.
type Block<T> = [T; 1 << (2 * BLOCK)];

impl<T: Default> Cells<T> {
    /// Empty cells. `held`: about how many blocks will hold something; more have to be moved.
    pub(super) fn new(grid: Grid, held: usize) -> Cells<T> {
        let all = (grid.columns >> BLOCK) as usize * (grid.rows >> BLOCK) as usize;
        let mut blocks = Vec::with_capacity(held.min(all) + 1);
        blocks.push(Block::default());
        Cells {
            grid,
            table: vec![0; all],
            blocks,
        }
    }

    fn block(&self, (column, row): (i32, i32)) -> usize {
        let blocks = (self.grid.columns >> BLOCK) as usize;
        (row >> BLOCK) as usize * blocks + (column >> BLOCK) as usize
    }

    #[inline]
    pub(super) fn get(&self, cell: (i32, i32)) -> &T {
        let block = self.table[self.block(cell)];
        &self.blocks[block as usize][within(cell)]
    }

    pub(super) fn at(&mut self, cell: (i32, i32)) -> &mut T {
        let block = self.block(cell);
        if self.table[block] == 0 {
            self.table[block] = self.blocks.len() as u32;
            self.blocks.push(Block::default());
        }
        &mut self.blocks[self.table[block] as usize][within(cell)]
    }
}

/// Where a cell is in its block.
fn within((column, row): (i32, i32)) -> usize {
    let low = (1 << BLOCK) - 1;
    (((row & low) << BLOCK) | (column & low)) as usize
}

/// A rectangle of cells.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Range {
    first: i32,
    last: i32,
    bottom: i32,
    top: i32,
}

impl Range {
    /// True if a segment from side to side passes all of it.
    pub(super) fn is_row(&self) -> bool {
        self.first == self.last || self.bottom == self.top
    }

    /// Calls `visit` for every cell, until it says true.
    pub(super) fn any(&self, mut visit: impl FnMut((i32, i32)) -> bool) -> bool {
        let mut columns = self.first..=self.last;
        columns.any(|column| (self.bottom..=self.top).any(|row| visit((column, row))))
    }
}

/// Square cells over a window, whole blocks of them. Those at its border go on without end: what is
/// beyond is theirs.
#[derive(Clone, Copy)]
pub(super) struct Grid {
    /// Cells in a grid unit.
    per_unit: f64,
    low: [f64; 2],
    columns: i32,
    rows: i32,
}

impl Grid {
    /// Of cells of this side, or of wider ones where there would be too many.
    pub(super) fn over(window: Window, mut side: f64, cells_max: usize) -> Grid {
        let [low, high] = [window.min, window.max].map(|p| [f64::from(p.x), f64::from(p.y)]);
        let span = [high[0] - low[0], high[1] - low[1]];
        let cells = |side: f64| (span[0] / side + 1.0) * (span[1] / side + 1.0);
        while cells(side) > cells_max as f64 {
            side *= 2.0;
        }
        let [columns, rows] = span.map(|it| whole_blocks((it / side) as i32 + 1));
        Grid {
            per_unit: 1.0 / side,
            low,
            columns,
            rows,
        }
    }

    /// The same window in cells that are smaller by this factor.
    pub(super) fn finer(&self, factor: f64) -> Grid {
        let more = |cells: i32| whole_blocks((f64::from(cells) / factor).ceil() as i32);
        Grid {
            per_unit: self.per_unit / factor,
            low: self.low,
            columns: more(self.columns),
            rows: more(self.rows),
        }
    }

    #[inline]
    fn column(&self, x: f64) -> i32 {
        // what is below zero, or beyond all numbers, is cut to the nearest
        (((x - self.low[0]) * self.per_unit) as i32).clamp(0, self.columns - 1)
    }

    #[inline]
    fn row(&self, y: f64) -> i32 {
        (((y - self.low[1]) * self.per_unit) as i32).clamp(0, self.rows - 1)
    }

    /// The cell that `p` lies in.
    pub(super) fn cell(&self, p: Point) -> (i32, i32) {
        (self.column(f64::from(p.x)), self.row(f64::from(p.y)))
    }

    fn range(&self, low: [f64; 2], high: [f64; 2]) -> Range {
        Range {
            first: self.column(low[0]),
            last: self.column(high[0]),
            bottom: self.row(low[1]),
            top: self.row(high[1]),
        }
    }

    /// The cells of the bounding box of a segment.
    pub(super) fn box_of(&self, p: Point, q: Point) -> Range {
        let low = [p.x.min(q.x), p.y.min(q.y)].map(f64::from);
        let high = [p.x.max(q.x), p.y.max(q.y)].map(f64::from);
        self.range(low, high)
    }

    /// Calls `visit` for every cell within `margin` of the segment, until it says true: column by
    /// column, the rows that the segment passes inside the column widened by the margin.
    #[inline]
    pub(super) fn passed(
        &self,
        p: Point,
        q: Point,
        margin: f64,
        mut visit: impl FnMut((i32, i32)) -> bool,
    ) -> bool {
        let (a, b) = (p.min(q), p.max(q));
        let (ax, ay) = (f64::from(a.x), f64::from(a.y));
        let (bx, by) = (f64::from(b.x), f64::from(b.y));
        let (low, high) = (ay.min(by), ay.max(by));
        let range = self.range([ax - margin, low - margin], [bx + margin, high + margin]);
        if a == b || range.is_row() {
            // most segments are shorter than a cell
            return range.any(visit);
        }
        let Range { first, last, .. } = range;
        let slope = if bx > ax { (by - ay) / (bx - ax) } else { 0.0 };
        let side = 1.0 / self.per_unit;
        (first..=last).any(|column| {
            // columns at the border have no end
            let from = match column {
                0 => ax,
                _ => (self.low[0] + f64::from(column) * side - margin).clamp(ax, bx),
            };
            let to = match column {
                _ if column == self.columns - 1 => bx,
                _ => (self.low[0] + f64::from(column + 1) * side + margin).clamp(ax, bx),
            };
            let (y0, y1) = if bx > ax {
                (ay + slope * (from - ax), ay + slope * (to - ax))
            } else {
                (ay, by)
            };
            let bottom = (y0.min(y1) - 1.0).clamp(low, high) - margin;
            let top = (y0.max(y1) + 1.0).clamp(low, high) + margin;
            (self.row(bottom)..=self.row(top)).any(|row| visit((column, row)))
        })
    }
}

fn whole_blocks(cells: i32) -> i32 {
    (((cells - 1) >> BLOCK) + 1) << BLOCK
}
