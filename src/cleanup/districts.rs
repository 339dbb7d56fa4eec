//! Clean-up by districts: parts of the line work that are cleaned on their own, then together.
//!
//! # Promises
//! 1. The result of any districts in any order, or at once, joins to one planar graph in which no
//!    node has jumped over an edge.
//! 2. Districts follow from the arrangement and the sizes alone. So the result depends on neither
//!    tiles nor threads.
//!
//! # Method
//! 1. [`site`]: rectangles that hold about equally many edges: the longer side is halved at the
//!    median of the nodes, while there are many edges and room for two halves. Work that fits into
//!    one rectangle has no districts.
//! 2. [`clean_district`]: all steps of clean-up in one rectangle, on the graph of all edges that
//!    come into it. Nodes in a margin along its border, outside of it, and neighbours of nodes
//!    outside are *tied*: no operation moves or removes them or leads a new edge to one by way of a
//!    merge. The others are free, and stay off the margin.
//! 3. [`join`]: the edges of all districts, and those between districts, make one graph. All steps
//!    run again, now with nothing tied, at the nodes that were tied and their neighbours, and from
//!    there as far as anything changes.
//!
//! # Why districts cannot harm each other
//! A free node and all its neighbours lie in the district's rectangle. Each operation changes edges
//! between free nodes and their neighbours only, and puts new nodes into the rectangle; so all that
//! it removes, adds or sweeps over lies in the convex hull of points of the rectangle, and the test
//! that the way is clear sees every edge that comes in there. An edge from one rectangle to another
//! has two tied ends: it stays as it is in both graphs. And rectangles are disjoint: what one
//! district does, no other one sees.
//!
//! # Cost
//! O(n log n) for cutting and joining n edges. The last pass looks at the nodes that were tied, some
//! tenth of all, and at those that it changes; relaxation stays with these.

use crate::cleanup::Cleaned;
use crate::cleanup::Options;
use crate::cleanup::changes::Change;
use crate::cleanup::changes::Dropped;
use crate::cleanup::finish;
use crate::cleanup::graph::Graph;
use crate::cleanup::graph::Loose;
use crate::cleanup::graph::Stand;
use crate::cleanup::graph::as_cut;
use crate::cleanup::leftovers;
use crate::cleanup::make_room;
use crate::cleanup::measure::Measure;
use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
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

/// All that districts share.
pub struct Site<'a> {
    measure: Measure<'a>,
    arrangement: Arrangement,
    /// False if the tolerance is zero, or all is clean already.
    is_on: bool,
    /// What to clean; none if there is too little work to share.
    pub districts: Vec<District>,
}

/// A part of the plane, and what comes into it.
#[derive(Clone, Debug, PartialEq)]
pub struct District {
    window: Window,
    /// Of the arrangement, ascending; now and then one that only passes near.
    edges: Vec<u32>,
}

/// A district after clean-up.
pub struct Made {
    /// All edges with both ends in the district.
    edges: Vec<Loose>,
    /// The nodes that were tied, where more may be to do.
    open: Vec<Point>,
    changes: Vec<Change>,
    dropped: Vec<Dropped>,
}

/// Cuts a noded and clipped arrangement into districts.
pub fn site<'a>(
    domain: &'a Domain,
    sizes: &SizeWish,
    arrangement: Arrangement,
    options: &Options,
    grain: &Grain,
) -> Site<'a> {
    let measure = Measure::new(domain, sizes, options);
    let is_clean = (options.left.as_ref())
        .is_some_and(|left| leftovers::are_only(&Graph::new(&arrangement, &measure), left));
    let is_on = measure.allows_any() && !is_clean;
    let size = sizes.default_m / domain.grid.cell_m;
    let districts = if is_on {
        cut(&arrangement, grain, (grain.side_min * size).ceil() as i64)
    } else {
        Vec::new()
    };
    Site {
        measure,
        arrangement,
        is_on,
        districts,
    }
}

/// Halves until all is small enough; no district at all if the first one is.
fn cut(arrangement: &Arrangement, grain: &Grain, side_min: i64) -> Vec<District> {
    let of = |axis: fn(&Point) -> i32| {
        let all = arrangement.points.iter().map(axis);
        (all.clone().min().unwrap_or(0), all.max().unwrap_or(0) + 1)
    };
    let ((left, right), (bottom, top)) = (of(|p| p.x), of(|p| p.y));
    let whole = District {
        window: Window {
            min: Point::new(left, bottom),
            max: Point::new(right, top),
        },
        edges: (0..arrangement.edges.len() as u32).collect(),
    };
    let mut open = vec![whole];
    let mut districts = Vec::new();
    while let Some(district) = open.pop() {
        let Window { min, max } = district.window;
        let width = i64::from(max.x) - i64::from(min.x);
        let height = i64::from(max.y) - i64::from(min.y);
        if district.edges.len() <= grain.edges_max || width.max(height) < 2 * side_min {
            districts.push(district);
        } else if width >= height {
            open.extend(halves(arrangement, &district, side_min, |p| &mut p.x));
        } else {
            open.extend(halves(arrangement, &district, side_min, |p| &mut p.y));
        }
    }
    if districts.len() == 1 {
        districts.clear();
    }
    districts
}

/// Both sides of the median of the nodes, or of the place nearest to it that leaves each of them
/// `side_min`. An edge may be on both.
fn halves(
    arrangement: &Arrangement,
    district: &District,
    side_min: i64,
    axis: fn(&mut Point) -> &mut i32,
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
    let all = || district.edges.iter().copied();
    let half = |window, edges| District { window, edges };
    [
        half(
            below,
            all()
                .filter(|&it| ends(it).iter().any(|&p| p < at))
                .collect(),
        ),
        half(
            above,
            all()
                .filter(|&it| ends(it).iter().any(|&p| p >= at))
                .collect(),
        ),
    ]
}

/// Cleans one district.
pub fn clean_district(site: &Site, district: &District) -> Made {
    let (mut graph, tied) = graph_of(site, district);
    make_room(&mut graph);
    let is_in = |node: u32| district.window.owns(graph.point(node));
    let edges = (graph.live().iter())
        .map(|&edge| &graph.edges[edge as usize])
        .filter(|edge| edge.ends.iter().all(|&end| is_in(end)))
        .map(|edge| Loose {
            ends: edge.ends.map(|end| graph.point(end)),
            pieces: edge.pieces.clone(),
            inside: edge.inside,
        })
        .collect();
    Made {
        edges,
        open: tied,
        changes: graph.changes,
        dropped: graph.dropped,
    }
}

/// The graph of a district, and the places of its tied nodes.
fn graph_of<'a>(site: &'a Site, district: &District) -> (Graph<'a>, Vec<Point>) {
    let arrangement = &site.arrangement;
    let ends = |edge: u32| arrangement.edges[edge as usize];
    let mut nodes: Vec<u32> = district.edges.iter().flat_map(|&edge| ends(edge)).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let at: Vec<Point> = nodes
        .iter()
        .map(|&node| arrangement.points[node as usize])
        .collect();
    let size = site.measure.default_m / site.measure.grid().cell_m;
    let inner = within(district.window, (MARGIN * size).ceil() as i32);
    let mut graph = Graph::without_edges(&site.measure, at, Some(inner));
    for node in 0..nodes.len() as u32 {
        if !inner.owns(graph.point(node)) {
            graph.set_stand(node, Stand::Tied);
        }
    }
    for &edge in &district.edges {
        let own =
            ends(edge).map(|end| nodes.binary_search(&end).expect("all ends are there") as u32);
        let leaves = own.iter().any(|&it| !district.window.owns(graph.point(it)));
        if leaves {
            own.iter().for_each(|&it| graph.set_stand(it, Stand::Tied));
        }
        let (pieces, inside) = as_cut(arrangement, site.measure.domain, edge);
        graph.add(own, pieces, inside);
    }
    let all = 0..nodes.len() as u32;
    let tied = all
        .filter(|&node| !graph.is_free(node))
        .map(|node| graph.point(node));
    let tied = tied.collect();
    (graph, tied)
}

/// The window without a margin.
fn within(window: Window, margin: i32) -> Window {
    let (min, max) = (window.min, window.max);
    Window {
        min: Point::new(min.x + margin, min.y + margin),
        max: Point::new(max.x - margin, max.y - margin),
    }
}

/// Joins the districts, in their order, and cleans what lies between them; everything if there are
/// none.
pub fn join(site: Site, made: Vec<Made>) -> Cleaned {
    let mut graph = if made.is_empty() {
        Graph::new(&site.arrangement, &site.measure)
    } else {
        joined(&site, made)
    };
    if site.is_on {
        make_room(&mut graph);
    }
    finish(graph, site.arrangement.clone(), site.is_on)
}

fn joined<'a>(site: &'a Site, made: Vec<Made>) -> Graph<'a> {
    let (mut edges, mut open) = (between(site), Vec::new());
    let (mut changes, mut dropped) = (Vec::new(), Vec::new());
    for mut it in made {
        edges.append(&mut it.edges);
        open.append(&mut it.open);
        changes.append(&mut it.changes);
        dropped.append(&mut it.dropped);
    }
    open.sort_unstable();
    let mut at: Vec<Point> = edges.iter().flat_map(|edge| edge.ends).collect();
    at.sort_unstable();
    at.dedup();
    let id = |p: Point| at.binary_search(&p).expect("all ends are there") as u32;
    let mut named: Vec<([u32; 2], Loose)> =
        edges.into_iter().map(|it| (it.ends.map(id), it)).collect();
    named.sort_unstable_by_key(|it| it.0);
    let is_open: Vec<bool> = at.iter().map(|p| open.binary_search(p).is_ok()).collect();
    let mut graph = Graph::without_edges(&site.measure, at, None);
    (graph.changes, graph.dropped) = (changes, dropped);
    let mut stand = vec![Stand::Settled; is_open.len()];
    for (ends, edge) in named {
        if ends.iter().any(|&end| is_open[end as usize]) {
            ends.iter()
                .for_each(|&end| stand[end as usize] = Stand::Open);
        }
        graph.add(ends, edge.pieces, edge.inside);
    }
    for (node, &stand) in (0..).zip(&stand) {
        graph.set_stand(node, stand);
    }
    graph
}

/// The edges from one district to another.
fn between(site: &Site) -> Vec<Loose> {
    let arrangement = &site.arrangement;
    let mut home = vec![u32::MAX; arrangement.points.len()];
    for (k, district) in (0..).zip(&site.districts) {
        for node in district
            .edges
            .iter()
            .flat_map(|&edge| arrangement.edges[edge as usize])
        {
            if district.window.owns(arrangement.points[node as usize]) {
                home[node as usize] = k;
            }
        }
    }
    let all = (0..).zip(&arrangement.edges);
    all.filter(|(_, [a, b])| home[*a as usize] != home[*b as usize])
        .map(|(edge, ends)| {
            let (pieces, inside) = as_cut(arrangement, site.measure.domain, edge);
            Loose {
                ends: ends.map(|it| arrangement.points[it as usize]),
                pieces,
                inside,
            }
        })
        .collect()
}
