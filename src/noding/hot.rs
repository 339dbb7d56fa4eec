//! The hot pixels that a tile owns, and the segments that pass through each.

use crate::domain::line::Domain;
use crate::geometry::crossing::along;
use crate::geometry::crossing::crossing;
use crate::geometry::crossing::passes_pixel;
use crate::geometry::point::Point;
use crate::geometry::window::Window;
use crate::noding::tile::Segment;
use crate::noding::tile::Tile;
use crate::noding::tile::rows;
use rstar::AABB;
use rstar::RTree;
use rstar::RTreeObject;
use rstar::primitives::GeomWithData;

/// What noding found in one tile.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileNodes {
    /// Centres of the hot pixels that the tile owns, sorted.
    pub points: Vec<Point>,
    /// Where a segment passes through a hot pixel, whose index into `points` is the node; by segment.
    pub stops: Vec<Stop>,
}

/// A node on a segment; sorted, the nodes of a segment follow each other along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Stop {
    /// The segment.
    pub segment: Segment,
    /// As in [`along`], cells². Different pixels that one segment passes never tie: on the way
    /// both coordinates change in one direction only.
    pub along: i64,
    /// The hot pixel.
    pub node: u32,
}

/// A segment in the R-tree: its box is cut to the tile, so that long segments do not answer
/// queries far away from them; its ends are not.
struct Passing {
    index: u32,
    a: Point,
    b: Point,
    low: [i32; 2],
    high: [i32; 2],
}

impl RTreeObject for Passing {
    type Envelope = AABB<[i32; 2]>;

    fn envelope(&self) -> AABB<[i32; 2]> {
        AABB::from_corners(self.low, self.high)
    }
}

/// Nodes of one tile. Depends on the segments that pass the tile's own pixels, on nothing else.
pub fn node_tile(domain: &Domain, tile: &Tile) -> TileNodes {
    let tree = RTree::bulk_load(passing(domain, tile));
    let mut points = crossings(&tree, tile.window);
    for passing in &tree {
        for p in [passing.a, passing.b] {
            if tile.window.owns(p) {
                points.push(p);
            }
        }
    }
    points.sort_unstable();
    points.dedup();
    let mut passed = passages(&tree, &points);
    passed.sort_unstable();
    let stop = |(index, node): (u32, u32)| {
        let segment = tile.segments[index as usize];
        let (a, b) = segment.ends(domain);
        Stop {
            segment,
            along: along(a, b, points[node as usize]),
            node,
        }
    };
    let stops = passed.into_iter().map(stop).collect();
    TileNodes { points, stops }
}

/// Which segment passes which of the hot pixels: (segment, pixel), in no order.
fn passages(tree: &RTree<Passing>, points: &[Point]) -> Vec<(u32, u32)> {
    let pixels = points.iter().zip(0..);
    let pixels = pixels.map(|(p, node)| GeomWithData::new([p.x, p.y], node));
    let pixels = RTree::bulk_load(pixels.collect());
    let near = tree.intersection_candidates_with_other_tree(&pixels);
    near.filter(|(passing, pixel)| {
        let &[x, y] = pixel.geom();
        passes_pixel(passing.a, passing.b, Point::new(x, y))
    })
    .map(|(passing, pixel)| (passing.index, pixel.data))
    .collect()
}

fn passing(domain: &Domain, tile: &Tile) -> Vec<Passing> {
    let window = tile.window;
    let mut all = Vec::with_capacity(tile.segments.len());
    for (index, segment) in tile.segments.iter().enumerate() {
        let (a, b) = segment.ends(domain);
        let x_low = a.x.min(b.x).max(window.min.x);
        let x_high = a.x.max(b.x).min(window.max.x - 1);
        let (y_low, y_high) = rows(a, b, x_low, x_high);
        let (y_low, y_high) = (y_low.max(window.min.y), y_high.min(window.max.y - 1));
        // `tiles` is generous by a few cells: some segments only come near
        if x_low <= x_high && y_low <= y_high {
            all.push(Passing {
                index: index as u32,
                a,
                b,
                low: [x_low, y_low],
                high: [x_high, y_high],
            });
        }
    }
    all
}

/// Rounded crossings of all pairs that the window owns, with repetitions.
fn crossings(tree: &RTree<Passing>, window: Window) -> Vec<Point> {
    let near = tree.intersection_candidates_with_other_tree(tree);
    near.filter(|(s, t)| s.index < t.index)
        .filter_map(|(s, t)| crossing(s.a, s.b, t.a, t.b))
        .filter(|&p| window.owns(p))
        .collect()
}
