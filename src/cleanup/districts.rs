//! Clean-up by districts: parts of the line work that are cleaned on their own, then together.
//!
//! # Promises
//! 1. The result of any districts in any order, or at once, joins to one planar graph in which no
//!    node has jumped over an edge.
//! 2. Districts follow from the arrangement and the sizes alone. So the result depends on neither
//!    tiles nor threads.
//!
//! # Method
//! 1. [`layout`]: rectangles that hold about equally many edges: the longer side is halved at the
//!    median of the nodes, while there are many edges and room for two halves. Along each border
//!    between two halves lies a *band*; it ends where the band of an earlier border begins, so that
//!    bands are disjoint as well (`layout`). Work that fits into one rectangle has no districts.
//! 2. [`clean_district`]: all steps of clean-up in one rectangle, on the graph of all edges that
//!    come into it. Nodes in a margin along its border, outside of it, and neighbours of nodes
//!    outside are *tied*: no operation moves or removes them or leads a new edge to one by way of a
//!    merge. The others are free, and stay off the margin.
//! 3. [`meet`], [`clean_band`]: the same in every band, on what the districts left. Now the nodes at
//!    the borders are free, and all steps run at those that were tied before and their neighbours,
//!    and from there as far as anything changes.
//! 4. [`join`]: all edges make one graph. All steps run once more, with nothing tied, at nodes that
//!    were tied twice, as where bands meet, and at those beside which a band changed something.
//!
//! # Why districts cannot harm each other
//! A free node and all its neighbours lie in the district's rectangle. Each operation changes edges
//! between free nodes and their neighbours only, and puts new nodes into the rectangle; so all that
//! it removes, adds or sweeps over lies in the convex hull of points of the rectangle, and the test
//! that the way is clear sees every edge that comes in there. An edge from one rectangle to another
//! has two tied ends: it stays as it is in both graphs. And rectangles are disjoint: what one
//! district does, no other one sees.
//!
//! Nothing of this asks what the rectangles are. So it holds for bands too, with the line work as
//! the districts left it in place of the arrangement: bands are disjoint rectangles, and start when
//! all districts have ended.
//!
//! # Cost
//! O(n log n) for cutting and joining n edges, and a look at each edge for every band that comes
//! into its district, some ten. Of the nodes of malta-osm at 35.2 a fifth are open in the bands, and
//! one in thirty in the last pass, which no cores share; relaxation stays with these.

use crate::cleanup::Options;
use crate::cleanup::changes::Change;
use crate::cleanup::changes::Dropped;
use crate::cleanup::edge::Loose;
use crate::cleanup::edge::as_cut;
use crate::cleanup::finish::Given;
use crate::cleanup::finish::Joined;
use crate::cleanup::graph::Graph;
use crate::cleanup::graph::Stand;
use crate::cleanup::layout::Band;
use crate::cleanup::layout::District;
use crate::cleanup::layout::Grain;
use crate::cleanup::layout::Layout;
use crate::cleanup::layout::comes_into;
use crate::cleanup::layout::within;
use crate::cleanup::leftovers;
use crate::cleanup::make_room;
use crate::cleanup::measure::Measure;
use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::geometry::point::Point;
use crate::geometry::window::Window;
use crate::noding::arrangement::Arrangement;
use crate::noding::arrangement::SortedPoints;
use crate::noding::arrangement::grouped;

/// All that districts share.
pub struct Site<'a> {
    measure: Measure<'a>,
    arrangement: Arrangement,
    /// False if the tolerance is zero, or all is clean already.
    is_on: bool,
    layout: Layout,
}

impl Site<'_> {
    /// What to clean first; none if there is too little work to share.
    pub fn districts(&self) -> &[District] {
        &self.layout.districts
    }

    /// What the end of clean-up asks of the input; it needs no graph.
    pub fn given(&self) -> Given {
        Given::of(&self.measure, &self.arrangement)
    }

    /// What to clean when all districts are clean.
    pub fn bands(&self) -> &[Band] {
        &self.layout.bands
    }
}

/// A district or a band after clean-up.
pub struct Made {
    /// All edges with both ends in it.
    edges: Vec<Loose>,
    /// Tied nodes where more may be to do.
    open: Vec<Point>,
    /// Where nodes were free that had been open.
    done: Vec<Point>,
    changes: Vec<Change>,
    dropped: Vec<Dropped>,
}

/// The line work after all districts.
pub struct Met {
    /// By district.
    made: Vec<Made>,
    /// The edges from one district to another.
    between: Vec<Loose>,
    /// Nodes that no district was free to change, sorted.
    open: Vec<Point>,
}

/// Cuts a noded and clipped arrangement into districts.
pub fn layout(
    domain: &Domain,
    sizes: &SizeWish,
    arrangement: &Arrangement,
    grain: &Grain,
) -> Layout {
    Layout::of(arrangement, grain, sizes.default_m / domain.grid.cell_m)
}

/// What the [`layout`] of the arrangement is for, and what its lines are measured by.
pub fn site<'a>(
    measure: Measure<'a>,
    layout: Layout,
    arrangement: Arrangement,
    options: &Options,
) -> Site<'a> {
    let is_clean = (options.left.as_ref())
        .is_some_and(|left| leftovers::are_only(&Graph::new(&arrangement, &measure), left));
    let is_on = measure.allows_any() && !is_clean;
    Site {
        measure,
        arrangement,
        is_on,
        layout: if is_on { layout } else { Layout::whole() },
    }
}

/// Cleans one district.
pub fn clean_district(site: &Site, district: &District) -> Made {
    let edges = district.edges.iter().map(|&edge| site.loose(edge));
    clean_window(site, district.window, edges.collect(), |_| true)
}

/// Puts the districts, in their order, beside each other.
pub fn meet(site: &Site, mut made: Vec<Made>) -> Met {
    let mut open: Vec<Point> = Vec::new();
    for it in &mut made {
        open.append(&mut it.open);
        it.done = Vec::new();
    }
    open.sort_unstable();
    open.dedup();
    Met {
        between: between(site),
        made,
        open,
    }
}

/// Cleans one band, at what the districts left open.
pub fn clean_band(site: &Site, met: &Met, band: &Band) -> Made {
    let mut edges: Vec<Loose> = Vec::new();
    let mut take = |from: &[Loose]| {
        let here = from.iter().filter(|it| comes_into(it.ends, &band.window));
        edges.extend(here.cloned());
    };
    for (district, made) in site.layout.districts.iter().zip(&met.made) {
        if district.window.meets(&band.window) {
            take(&made.edges);
        }
    }
    take(&met.between);
    let is_open = |p: Point| met.open.binary_search(&p).is_ok();
    clean_window(site, band.window, edges, is_open)
}

/// All steps of clean-up in one rectangle, at the open nodes. `edges`: all that come into it.
fn clean_window(
    site: &Site,
    window: Window,
    edges: Vec<Loose>,
    is_open: impl Fn(Point) -> bool,
) -> Made {
    let inner = within(window, site.layout.margin);
    let mut graph = graph_of(&site.measure, edges, Some(inner), &is_open);
    for node in 0..graph.at.len() as u32 {
        let is_in = |it: u32| window.owns(graph.point(it));
        if !inner.owns(graph.point(node)) || !graph.neighbours(node).into_iter().all(is_in) {
            graph.set_stand(node, Stand::Tied);
        }
    }
    let nodes = 0..graph.at.len() as u32;
    let (free, tied): (Vec<u32>, Vec<u32>) = nodes.partition(|&it| graph.is_free(it));
    let open_of = |nodes: &[u32]| -> Vec<Point> {
        let all = nodes.iter().map(|&it| graph.point(it));
        all.filter(|&p| is_open(p)).collect()
    };
    let (done, mut open) = (open_of(&free), open_of(&tied));
    let mark = graph.touched.len();
    make_room(&mut graph);
    let beside = graph.touched[mark..]
        .iter()
        .filter(|&&it| !graph.is_free(it));
    open.extend(beside.map(|&it| graph.point(it)));
    let edges = (graph.live().iter())
        .map(|&edge| graph.loose(edge))
        .filter(|edge| edge.ends.iter().all(|&end| window.owns(end)))
        .collect();
    Made {
        edges,
        open,
        done,
        changes: graph.changes,
        dropped: graph.dropped,
    }
}

/// Joins the bands, in their order, with all that lies outside of them, and cleans what is still
/// open; everything if there are no districts.
pub fn join<'a>(site: &'a Site, met: Met, bands: Vec<Made>) -> Joined<'a> {
    let mut graph = match site.layout.districts.is_empty() {
        true => Graph::new(&site.arrangement, &site.measure),
        false => joined(site, met, bands),
    };
    if site.is_on {
        make_room(&mut graph);
    }
    Joined {
        graph,
        input: &site.arrangement,
        is_on: site.is_on,
    }
}

fn joined<'a>(site: &'a Site, met: Met, bands: Vec<Made>) -> Graph<'a> {
    let all = met.made.iter().chain(&bands).map(|it| it.edges.len());
    let mut edges = Vec::with_capacity(all.sum::<usize>() + met.between.len());
    let (mut open, mut done) = (met.open, Vec::new());
    let (mut changes, mut dropped) = (Vec::new(), Vec::new());
    let mut keep = |kept: Vec<Loose>, bands: &[Window]| {
        let is_in = |it: &Loose, band: &Window| it.ends.iter().all(|&end| band.owns(end));
        let kept = kept.into_iter();
        edges.extend(kept.filter(|it| !bands.iter().any(|band| is_in(it, band))));
    };
    let windows: Vec<Window> = site.bands().iter().map(|it| it.window).collect();
    for (district, mut it) in site.layout.districts.iter().zip(met.made) {
        let all = windows.iter().copied();
        let here: Vec<Window> = all.filter(|it| it.meets(&district.window)).collect();
        keep(it.edges, &here);
        changes.append(&mut it.changes);
        dropped.append(&mut it.dropped);
    }
    keep(met.between, &windows);
    for mut it in bands {
        edges.append(&mut it.edges);
        open.append(&mut it.open);
        done.append(&mut it.done);
        changes.append(&mut it.changes);
        dropped.append(&mut it.dropped);
    }
    done.sort_unstable();
    open.retain(|p| done.binary_search(p).is_err());
    open.sort_unstable();
    let is_open = |p: Point| open.binary_search(&p).is_ok();
    let mut graph = graph_of(&site.measure, edges, None, is_open);
    (graph.changes, graph.dropped) = (changes, dropped);
    graph
}

/// The graph of these edges. Nodes are settled, but for the open ones and their neighbours.
fn graph_of<'a>(
    measure: &'a Measure<'a>,
    mut edges: Vec<Loose>,
    bounds: Option<Window>,
    is_open: impl Fn(Point) -> bool,
) -> Graph<'a> {
    let ends: Vec<Point> = edges.iter().flat_map(|edge| edge.ends).collect();
    let SortedPoints { points: at, id } = SortedPoints::of(&ends);
    let ends: Vec<[u32; 2]> = id.chunks_exact(2).map(|it| [it[0], it[1]]).collect();
    // in the order of their ids, which is that of the points
    let mut order = grouped(&ends, at.len(), |it| it[0] as usize);
    for star in order.chunk_by_mut(|&s, &t| ends[s as usize][0] == ends[t as usize][0]) {
        star.sort_unstable_by_key(|&it| ends[it as usize][1]);
    }
    let is_open: Vec<bool> = at.iter().map(|&p| is_open(p)).collect();
    let lengths = order.iter().map(|&it| {
        let [a, b] = edges[it as usize].ends;
        a.distance(b)
    });
    let length: f64 = lengths.sum();
    let mean = length / edges.len().max(1) as f64;
    let mut graph = Graph::without_edges(measure, at, mean, bounds);
    let mut stand = vec![Stand::Settled; is_open.len()];
    for it in order {
        let (edge, ends) = (&mut edges[it as usize], ends[it as usize]);
        if ends.iter().any(|&end| is_open[end as usize]) {
            ends.iter()
                .for_each(|&end| stand[end as usize] = Stand::Open);
        }
        graph.add(ends, std::mem::take(&mut edge.pieces), edge.inside);
    }
    for (node, &stand) in (0..).zip(&stand) {
        graph.set_stand(node, stand);
    }
    graph
}

/// The edges from one district to another: those that were on both sides where a window was halved,
/// and so are listed more than once.
fn between(site: &Site) -> Vec<Loose> {
    let mut lists = vec![0_u16; site.arrangement.edges.len()];
    for district in &site.layout.districts {
        for &edge in &district.edges {
            lists[edge as usize] += 1;
        }
    }
    let all = (0..).zip(&lists);
    all.filter(|&(_, &lists)| lists > 1)
        .map(|(edge, _)| site.loose(edge))
        .collect()
}

impl Site<'_> {
    /// An edge of the arrangement.
    fn loose(&self, edge: u32) -> Loose {
        let (pieces, inside) = as_cut(&self.arrangement, self.measure.domain, edge);
        let ends = self.arrangement.edges[edge as usize];
        Loose {
            ends: ends.map(|it| self.arrangement.points[it as usize]),
            pieces,
            inside,
        }
    }
}
