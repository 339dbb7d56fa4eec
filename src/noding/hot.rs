//! The hot pixels that a tile owns, and the segments that pass through each.

use crate::domain::line::Domain;
use crate::geometry::crossing::crossing;
use crate::geometry::crossing::passes_pixel;
use crate::geometry::point::Point;
use crate::geometry::window::Window;
use crate::noding::tile::Segment;
use crate::noding::tile::Tile;
use crate::noding::tile::rows;

/// What noding found in one tile.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileNodes {
    /// Centres of the hot pixels that the tile owns, sorted.
    pub points: Vec<Point>,
    /// All (segment, index into `points`) such that the segment passes through the hot pixel; by
    /// point.
    pub incidences: Vec<(Segment, u32)>,
}

/// A segment of the tile.
#[derive(Clone, Copy)]
struct Passing {
    /// Its place in the tile's list.
    index: u32,
    a: Point,
    b: Point,
}

/// Windows with at most so many segments are not cut any further: each is held against each.
const FEW: usize = 16;

/// So many segments are wished in the parts of a window that is cut.
const WISHED: usize = 4;

/// Windows of this side, cells, are not cut either: many segments may meet in one pixel.
const SIDE_MIN: i32 = 16;

/// Nodes of one tile. Depends on the segments that pass the tile's own pixels, on nothing else.
pub fn node_tile(domain: &Domain, tile: &Tile) -> TileNodes {
    let segments = tile.segments.iter().zip(0..);
    let passing = segments.map(|(segment, index)| {
        let (a, b) = segment.ends(domain);
        Passing { index, a, b }
    });
    let mut found = Vec::with_capacity(3 * tile.segments.len());
    search(tile.window, passing.collect(), &mut found);
    found.sort_unstable();
    let mut nodes = TileNodes {
        points: Vec::with_capacity(found.len()),
        incidences: Vec::with_capacity(found.len()),
    };
    for (p, index) in found {
        if nodes.points.last() != Some(&p) {
            nodes.points.push(p);
        }
        let node = nodes.points.len() as u32 - 1;
        (nodes.incidences).push((tile.segments[index as usize], node));
    }
    nodes
}

/// Finds the hot pixels that the window owns, each with the indices of the segments that pass it.
/// `here`: all segments that may pass a pixel of the window, ascending. Where they are many, in parts
/// of the window, and parts of those: so dense places cost no more than others.
fn search(window: Window, here: Vec<Passing>, found: &mut Vec<(Point, u32)>) {
    let Window { min, max } = window;
    let (width, height) = (max.x - min.x, max.y - min.y);
    if here.len() <= FEW || width.max(height) <= SIDE_MIN {
        return hold_against_each_other(window, &here, found);
    }
    let parts = ((here.len() / WISHED) as f64).sqrt().ceil() as i32;
    let side = (width.max(height) / parts + 1).max(SIDE_MIN);
    let mut passed: Vec<([i32; 2], u32)> = Vec::with_capacity(2 * here.len());
    for (it, k) in here.iter().zip(0..) {
        each_part(window, side, it, |part| passed.push((part, k)));
    }
    passed.sort_unstable();
    let groups = || passed.chunk_by(|s, t| s.0 == t.0);
    let pairs: usize = groups().map(|it| it.len() * it.len()).sum();
    if 2 * pairs > here.len() * here.len() && 2 * passed.len() > 3 * here.len() {
        // long and side by side, or all to one place: cut, they would be more to do
        return hold_against_each_other(window, &here, found);
    }
    for group in groups() {
        let [column, row] = group[0].0;
        let low = Point::new(min.x + column * side, min.y + row * side);
        let part = Window {
            min: low,
            max: Point::new(max.x.min(low.x + side), max.y.min(low.y + side)),
        };
        let passing = group.iter().map(|&(_, k)| here[k as usize]);
        search(part, passing.collect(), found);
    }
}

/// Calls `visit` with [column, row] of each part of the window that the segment may pass.
fn each_part(window: Window, side: i32, it: &Passing, mut visit: impl FnMut([i32; 2])) {
    let Window { min, max } = window;
    let x_low = it.a.x.min(it.b.x).max(min.x);
    let x_high = it.a.x.max(it.b.x).min(max.x - 1);
    if x_low > x_high {
        return;
    }
    for column in (x_low - min.x) / side..=(x_high - min.x) / side {
        let left = min.x + column * side;
        let (from, to) = (x_low.max(left), x_high.min(left + side - 1));
        let (low, high) = rows(it.a, it.b, from, to);
        let (low, high) = (low.max(min.y), high.min(max.y - 1));
        if low <= high {
            let rows = (low - min.y) / side..=(high - min.y) / side;
            rows.for_each(|row| visit([column, row]));
        }
    }
}

fn hold_against_each_other(window: Window, here: &[Passing], found: &mut Vec<(Point, u32)>) {
    let mut hot: Vec<Point> = Vec::new();
    for (k, s) in here.iter().enumerate() {
        hot.extend([s.a, s.b].iter().filter(|&&end| window.owns(end)));
        let others = here[k + 1..].iter().filter(|t| may_cross(s, t));
        let crossings = others.filter_map(|t| crossing(s.a, s.b, t.a, t.b));
        hot.extend(crossings.filter(|&p| window.owns(p)));
    }
    hot.sort_unstable();
    hot.dedup();
    for p in hot {
        let passing = here.iter().filter(|it| passes_pixel(it.a, it.b, p));
        found.extend(passing.map(|it| (p, it.index)));
    }
}

/// False if the bounding boxes have nothing in common.
fn may_cross(s: &Passing, t: &Passing) -> bool {
    let meets = |a: i32, b: i32, c: i32, d: i32| a.min(b) <= c.max(d) && c.min(d) <= a.max(b);
    meets(s.a.x, s.b.x, t.a.x, t.b.x) && meets(s.a.y, s.b.y, t.a.y, t.b.y)
}
