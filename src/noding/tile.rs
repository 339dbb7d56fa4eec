//! Which segments pass which tile.

use crate::domain::line::Domain;
use crate::domain::line::LineId;
use crate::geometry::point::LIMIT;
use crate::geometry::point::Point;
use crate::geometry::window::Window;
use crate::noding::Options;
use rustc_hash::FxHashMap;

/// A segment of a line: from `points[at]` to `points[at + 1]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Segment {
    /// The line.
    pub line: LineId,
    /// Index of the segment's first point in the line.
    pub at: u32,
}

impl Segment {
    /// Its ends, in digitised order.
    pub fn ends(self, domain: &Domain) -> (Point, Point) {
        let points = &domain.lines[self.line as usize].points;
        (points[self.at as usize], points[self.at as usize + 1])
    }
}

/// A square of the grid and all segments that may pass through one of its pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// The pixels that the tile owns, by their centres.
    pub window: Window,
    /// Ascending; complete, and rarely one too many.
    pub segments: Vec<Segment>,
}

/// The tiles that hold at least one segment, by row, then column. A segment costs as many steps as
/// it passes tiles, however many tiles there are.
pub fn tiles(domain: &Domain, options: &Options) -> Vec<Tile> {
    let side = options.tile_cells;
    assert!((1..=LIMIT).contains(&side), "tile_cells: {side}");
    let mut tiles: Vec<([i32; 2], Vec<Segment>)> = Vec::new();
    let mut place: FxHashMap<[i32; 2], usize> = FxHashMap::default();
    for (line, of) in domain.lines.iter().enumerate() {
        for (at, pair) in of.points.windows(2).enumerate() {
            let segment = Segment {
                line: line as u32,
                at: at as u32,
            };
            each_tile(pair[0], pair[1], side, |key| {
                let at = *place.entry(key).or_insert(tiles.len());
                if at == tiles.len() {
                    tiles.push((key, Vec::new()));
                }
                tiles[at].1.push(segment);
            });
        }
    }
    tiles.sort_unstable_by_key(|it| it.0);
    (tiles.into_iter())
        .map(|(key, segments)| Tile {
            window: window(key, side),
            segments,
        })
        .collect()
}

fn window([row, column]: [i32; 2], side: i32) -> Window {
    Window {
        min: Point::new(column * side, row * side),
        max: Point::new((column + 1) * side, (row + 1) * side),
    }
}

/// Calls `visit` with `[row, column]` of each tile that the segment `a b` may pass.
fn each_tile(a: Point, b: Point, side: i32, mut visit: impl FnMut([i32; 2])) {
    let columns = a.x.min(b.x).div_euclid(side)..=a.x.max(b.x).div_euclid(side);
    for column in columns {
        let (low, high) = rows(a, b, column * side, (column + 1) * side - 1);
        for row in low.div_euclid(side)..=high.div_euclid(side) {
            visit([row, column]);
        }
    }
}

/// A range that holds the y of every pixel with `x_low <= x <= x_high` that `a b` passes through;
/// at most a few cells too wide. The segment must reach these columns.
pub(super) fn rows(a: Point, b: Point, x_low: i32, x_high: i32) -> (i32, i32) {
    let (a, b) = if a.x <= b.x { (a, b) } else { (b, a) };
    let (y_low, y_high) = (a.y.min(b.y), a.y.max(b.y));
    if a.x == b.x {
        return (y_low, y_high);
    }
    let dx = i64::from(b.x) - i64::from(a.x);
    let dy = i64::from(b.y) - i64::from(a.y);
    // a column's pixels reach half a cell beyond the centres, so look a whole one beyond
    let y_at = |x: i32| {
        let x = i64::from(x.clamp(a.x, b.x));
        i64::from(a.y) + (dy * (x - i64::from(a.x))).div_euclid(dx)
    };
    let (s, t) = (y_at(x_low - 1), y_at(x_high + 1));
    let low = (s.min(t) - 1).max(i64::from(y_low));
    let high = (s.max(t) + 2).min(i64::from(y_high));
    (low as i32, high as i32)
}
