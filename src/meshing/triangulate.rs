//! Visits + interior points -> the triangles of a constrained Delaunay triangulation.
//!
//! The numbering is that of the visits: a triangle in the left bank of a slit and one in its right
//! bank use different nodes, so the result is an ordinary triangulation of a region whose boundary
//! cycles are disjoint. Which visit a corner gets follows from the *rotation* about its node alone
//! (no angle is ever computed): the triangles from the walk edge that leaves a visit, counter-
//! clockwise, up to the next walk edge.

use crate::geometry::point::Xy;
use crate::meshing::visits::Visits;
use spade::ConstrainedDelaunayTriangulation;
use spade::Point2;
use spade::Triangulation;
use spade::handles::FixedFaceHandle;
use spade::handles::FixedVertexHandle;
use spade::handles::InnerTag;

/// No triangle, no node: the other side of a walk edge.
pub(crate) const NONE: u32 = u32::MAX;

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;
type Face = FixedFaceHandle<InnerTag>;

/// A triangulation in visit numbering.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Triangles {
    /// The visits, then the interior points as given (points that could not be used have no
    /// triangle), metres.
    pub nodes: Vec<Xy>,
    /// Number of visits.
    pub visits: usize,
    /// Corners, counter-clockwise.
    pub corners: Vec<[u32; 3]>,
    /// `neighbours[t][k]` lies across the edge from corner `k` to corner `k + 1`; [`NONE`] at a
    /// walk edge.
    pub neighbours: Vec<[u32; 3]>,
}

/// Triangulates what lies on the left of all walks.
///
/// Interior points outside, on a walk edge or at the place of another node stay unused. The number
/// of triangles has the parity of the number of visits, whatever points are inside.
///
/// `None` if the walks are not planar, which `boundary` promises they are.
pub(crate) fn triangulate(visits: &Visits, inner: &[Xy]) -> Option<Triangles> {
    let mut sites = Sites::of(visits, inner);
    loop {
        let cdt = sites.load()?;
        let lost = sites.on_a_walk(&cdt);
        if lost.is_empty() {
            return collect(visits, inner, &sites, &cdt);
        }
        if lost.iter().any(|&site| site < sites.fixed) {
            return None;
        }
        sites.drop_all(&lost);
    }
}

/// The distinct positions handed to spade, walk nodes first.
struct Sites {
    points: Vec<Point2<f64>>,
    /// Site -> visit (the first one there) or interior node.
    node: Vec<u32>,
    /// Number of sites that are walk nodes.
    fixed: usize,
    /// Visit -> site.
    of_visit: Vec<u32>,
    /// Walk edges as pairs of sites, one direction of each.
    edges: Vec<[usize; 2]>,
}

impl Sites {
    fn of(visits: &Visits, inner: &[Xy]) -> Sites {
        let unique_count = visits
            .unique
            .iter()
            .max()
            .map_or(0, |&last| last as usize + 1);
        let mut site_of_unique = vec![NONE; unique_count];
        let mut sites = Sites {
            points: Vec::with_capacity(visits.len() + inner.len()),
            node: Vec::with_capacity(visits.len() + inner.len()),
            fixed: 0,
            of_visit: Vec::with_capacity(visits.len()),
            edges: Vec::with_capacity(visits.len()),
        };
        for (visit, &unique) in visits.unique.iter().enumerate() {
            let site = &mut site_of_unique[unique as usize];
            if *site == NONE {
                *site = sites.points.len() as u32;
                sites.points.push(spade_point(visits.nodes[visit]));
                sites.node.push(visit as u32);
            }
            sites.of_visit.push(*site);
        }
        sites.fixed = sites.points.len();
        for visit in 0..visits.len() as u32 {
            let from = sites.of_visit[visit as usize] as usize;
            let to = sites.of_visit[visits.next(visit) as usize] as usize;
            sites.edges.push([from.min(to), from.max(to)]);
        }
        // Both sides of a slit are one constraint.
        sites.edges.sort_unstable();
        sites.edges.dedup();
        for (k, &at) in inner.iter().enumerate() {
            sites.points.push(spade_point(at));
            sites.node.push((visits.len() + k) as u32);
        }
        sites
    }

    fn load(&mut self) -> Option<Cdt> {
        let attempt = |sites: &Sites| {
            let mut planar = true;
            let load = Cdt::try_bulk_load_cdt(sites.points.clone(), sites.edges.clone(), |_| {
                planar = false;
            });
            load.ok().filter(|_| planar)
        };
        let cdt = attempt(self)?;
        if cdt.num_vertices() == self.points.len() {
            return Some(cdt);
        }
        // spade renumbers when it merges equal positions, so merge them before.
        let mut order: Vec<usize> = (0..self.points.len()).collect();
        let key = |&site: &usize| [self.points[site].x, self.points[site].y];
        order.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap().then(a.cmp(b)));
        let equal = order
            .windows(2)
            .filter(|pair| key(&pair[0]) == key(&pair[1]));
        let mut twins: Vec<usize> = equal.map(|pair| pair[1]).collect();
        twins.sort_unstable();
        if twins.first().is_none_or(|&site| site < self.fixed) {
            return None;
        }
        self.drop_all(&twins);
        attempt(self).filter(|cdt| cdt.num_vertices() == self.points.len())
    }

    /// Sites with a walk edge that is not theirs: interior points on a walk edge.
    fn on_a_walk(&self, cdt: &Cdt) -> Vec<usize> {
        let mut lost = Vec::new();
        for edge in cdt
            .undirected_edges()
            .filter(|edge| edge.is_constraint_edge())
        {
            let [a, b] = edge.vertices().map(|vertex| vertex.index());
            if self.edges.binary_search(&[a.min(b), a.max(b)]).is_err() {
                lost.push(a.max(b));
            }
        }
        lost.sort_unstable();
        lost.dedup();
        lost
    }

    fn drop_all(&mut self, sites: &[usize]) {
        let mut at = 0;
        self.node.retain(|_| {
            at += 1;
            sites.binary_search(&(at - 1)).is_err()
        });
        at = 0;
        self.points.retain(|_| {
            at += 1;
            sites.binary_search(&(at - 1)).is_err()
        });
    }
}

/// spade refuses coordinates that are tiny and not zero.
fn spade_point(at: Xy) -> Point2<f64> {
    let clean = |v: f64| if v.abs() < 1e-30 { 0.0 } else { v };
    Point2::new(clean(at[0]), clean(at[1]))
}

/// Rotates about each visit, floods what the rotations found, and numbers what was reached.
fn collect(visits: &Visits, inner: &[Xy], sites: &Sites, cdt: &Cdt) -> Option<Triangles> {
    let mut corners = vec![[NONE; 3]; cdt.num_all_faces()];
    for face in cdt.inner_faces() {
        let starts = face.adjacent_edges().map(|edge| edge.from().index());
        corners[face.index()] = starts.map(|site| sites.node[site]);
    }
    let mut number = vec![NONE; cdt.num_all_faces()];
    let mut reached = rotate(visits, sites, cdt, &mut corners, &mut number)?;
    let mut head = 0;
    while head < reached.len() {
        for edge in cdt.face(reached[head]).adjacent_edges() {
            if let (false, Some(next)) = (edge.is_constraint_edge(), edge.rev().face().as_inner())
                && number[next.index()] == NONE
            {
                number[next.index()] = 0;
                reached.push(next.fix());
            }
        }
        head += 1;
    }
    reached.sort_unstable_by_key(|face| face.index());
    for (k, face) in reached.iter().enumerate() {
        number[face.index()] = k as u32;
    }
    let across = |face: &Face| {
        cdt.face(*face).adjacent_edges().map(|edge| {
            let open = !edge.is_constraint_edge();
            let other = edge.rev().face().as_inner().filter(|_| open);
            other.map_or(NONE, |face| number[face.index()])
        })
    };
    Some(Triangles {
        nodes: visits.nodes.iter().chain(inner).copied().collect(),
        visits: visits.len(),
        corners: reached.iter().map(|face| corners[face.index()]).collect(),
        neighbours: reached.iter().map(across).collect(),
    })
}

/// Gives each visit the corners in its sector; returns the triangles met, each once.
fn rotate(
    visits: &Visits,
    sites: &Sites,
    cdt: &Cdt,
    corners: &mut [[u32; 3]],
    number: &mut [u32],
) -> Option<Vec<Face>> {
    let mut reached = Vec::new();
    for visit in 0..visits.len() as u32 {
        let here = sites.of_visit[visit as usize] as usize;
        let there = sites.of_visit[visits.next(visit) as usize] as usize;
        let [from, to] = [here, there].map(FixedVertexHandle::from_index);
        let mut edge = cdt.get_edge_from_neighbors(from, to)?;
        loop {
            let face = edge.face().as_inner()?;
            let starts = face.adjacent_edges().map(|edge| edge.from().index());
            let place = starts.iter().position(|&start| start == here)?;
            corners[face.index()][place] = visit;
            if number[face.index()] == NONE {
                number[face.index()] = 0;
                reached.push(face.fix());
            }
            edge = edge.ccw();
            if edge.is_constraint_edge() {
                break;
            }
        }
    }
    Some(reached)
}
