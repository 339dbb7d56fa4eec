//! Rectangles that share the work of clean-up: districts, and bands along their borders.

use crate::geometry::point::Point;
use crate::geometry::window::Window;
use crate::noding::arrangement::Arrangement;

/// How finely the work is cut. Unlike tiles and threads it has a part in the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grain {
    /// A district with more edges than this is halved.
    pub edges_max: usize,
    /// No side is shorter than this many mesh sizes.
    pub side_min: f64,
}

/// Districts of a size that stays in a core's own cache, with margins that are a small part.
pub const GRAIN: Grain = Grain {
    edges_max: 8000,
    side_min: 30.0,
};

/// Width of the margin in mesh sizes: a node and what it might be merged with are cleaned at once.
const MARGIN: f64 = 1.0;

/// How far a band reaches on either side of its border, in mesh sizes, if sides are long enough:
/// over both margins, and as far again as what is done there may lead.
const BAND: f64 = 5.0;

/// A part of the plane, and what comes into it.
#[derive(Clone, Debug, PartialEq)]
pub struct District {
    pub(super) window: Window,
    /// Of the arrangement, ascending; now and then one that only passes near.
    pub(super) edges: Vec<u32>,
}

/// A strip along the border of two districts, or of more on either side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    pub(super) window: Window,
}

impl District {
    /// Grows with the time that it takes.
    pub fn work(&self) -> i64 {
        self.edges.len() as i64
    }
}

impl Band {
    /// Grows with the time that it takes: bands are of one width.
    pub fn work(&self) -> i64 {
        let Window { min, max } = self.window;
        let side = |low: i32, high: i32| i64::from(high) - i64::from(low);
        side(min.x, max.x) + side(min.y, max.y)
    }
}

/// How the work is shared.
pub struct Layout {
    /// Disjoint, over all nodes; none if there is too little work to share.
    pub(super) districts: Vec<District>,
    /// Disjoint, over all borders.
    pub(super) bands: Vec<Band>,
    /// Width of the margins, cells.
    pub(super) margin: i32,
}

impl Layout {
    /// Of no districts.
    pub(super) fn whole() -> Layout {
        Layout {
            districts: Vec::new(),
            bands: Vec::new(),
            margin: 0,
        }
    }

    /// Halves until all is small enough; no district at all if the first one is. `size`: of the
    /// mesh, cells.
    pub(super) fn of(arrangement: &Arrangement, grain: &Grain, size: f64) -> Layout {
        let margin = (MARGIN * size).ceil() as i32;
        let cells = |sizes: f64| (sizes * size).ceil() as i64;
        let side_min = cells(grain.side_min);
        let reach = cells(BAND.min(grain.side_min / 2.0)) as i32;
        let whole = around(arrangement, margin);
        let mut open = vec![District {
            window: whole,
            edges: (0..arrangement.edges.len() as u32).collect(),
        }];
        let (mut districts, mut bands) = (Vec::new(), Vec::new());
        while let Some(district) = open.pop() {
            let Window { min, max } = district.window;
            let width = i64::from(max.x) - i64::from(min.x);
            let height = i64::from(max.y) - i64::from(min.y);
            if district.edges.len() <= grain.edges_max || width.max(height) < 2 * side_min {
                districts.push(district);
                continue;
            }
            let (along, across): (Axis, Axis) = match width >= height {
                true => (|p| &mut p.x, |p| &mut p.y),
                false => (|p| &mut p.y, |p| &mut p.x),
            };
            let parts = halves(arrangement, &district, side_min, along);
            let mut window = district.window;
            let at = *along(&mut parts[1].window.min.clone());
            *along(&mut window.min) = at - reach;
            *along(&mut window.max) = at + reach;
            // the band of the border that it ends at goes on there
            if *across(&mut window.min) > *across(&mut whole.min.clone()) {
                *across(&mut window.min) += reach;
            }
            if *across(&mut window.max) < *across(&mut whole.max.clone()) {
                *across(&mut window.max) -= reach;
            }
            bands.push(Band { window });
            open.extend(parts);
        }
        match districts.len() {
            1 => Layout::whole(),
            _ => Layout {
                districts,
                bands,
                margin,
            },
        }
    }
}

/// Picks a coordinate.
type Axis = fn(&mut Point) -> &mut i32;

/// A window around all nodes, so wide that none lies in its margin.
fn around(arrangement: &Arrangement, margin: i32) -> Window {
    let of = |axis: fn(&Point) -> i32| {
        let all = arrangement.points.iter().map(axis);
        let (low, high) = (all.clone().min().unwrap_or(0), all.max().unwrap_or(0));
        (low - margin - 1, high + margin + 2)
    };
    let ((left, right), (bottom, top)) = (of(|p| p.x), of(|p| p.y));
    Window {
        min: Point::new(left, bottom),
        max: Point::new(right, top),
    }
}

/// Both sides of the median of the nodes, or of the place nearest to it that leaves each of them
/// `side_min`. An edge may be on both.
fn halves(
    arrangement: &Arrangement,
    district: &District,
    side_min: i64,
    axis: Axis,
) -> [District; 2] {
    let along = |mut p: Point| *axis(&mut p);
    let ends = |edge: u32| {
        let [a, b] = arrangement.edges[edge as usize];
        [a, b].map(|node| along(arrangement.points[node as usize]))
    };
    let window = district.window;
    let mut places: Vec<i32> = district.edges.iter().map(|&edge| ends(edge)[0]).collect();
    let half = places.len() / 2;
    let median = *places.select_nth_unstable(half).1;
    let low = i64::from(along(window.min)) + side_min;
    let high = i64::from(along(window.max)) - side_min;
    let at = i64::from(median).clamp(low, high) as i32;
    let (mut below, mut above) = (window, window);
    *axis(&mut below.max) = at;
    *axis(&mut above.min) = at;
    let (mut lower, mut upper) = (Vec::with_capacity(half), Vec::with_capacity(half));
    for &edge in &district.edges {
        let [p, q] = ends(edge);
        if p.min(q) < at {
            lower.push(edge);
        }
        if p.max(q) >= at {
            upper.push(edge);
        }
    }
    [(below, lower), (above, upper)].map(|(window, edges)| District { window, edges })
}

/// The window without a margin.
pub(super) fn within(window: Window, margin: i32) -> Window {
    let (min, max) = (window.min, window.max);
    Window {
        min: Point::new(min.x + margin, min.y + margin),
        max: Point::new(max.x - margin, max.y - margin),
    }
}

/// True if the bounding box of the segment `a b` and the window have a cell in common.
pub(super) fn comes_into([a, b]: [Point; 2], window: &Window) -> bool {
    let Window { min, max } = *window;
    a.x.max(b.x) >= min.x && a.x.min(b.x) < max.x && a.y.max(b.y) >= min.y && a.y.min(b.y) < max.y
}
