//! Did every sub-domain with room for elements survive?
//!
//! A *room* is a face of the noded line work in which a circle of radius half the mesh size (or the
//! tolerance, if that is more) finds place. Its witness is the centre of such a circle. In the
//! cleaned line work all witnesses must lie in faces of their own: a face without one was lost, one
//! with two is two merged.
//!
//! The inscribed radius is not computed. Circles are tried that touch an edge of the face, at its
//! middle and a quarter of a size apart along it: a face whose inscribed radius is above the wanted
//! one by an eighth is found, one below it never is.

use crate::cleanup::Options;
use crate::cleanup::collapse::leaving;
use crate::cleanup::graph::Graph;
use crate::cleanup::index::NO_NODE;
use crate::cleanup::measure::Measure;
use crate::cleanup::measure::distance;
use crate::cleanup::measure::to_segment;
use crate::domain::finding::Finding;
use crate::domain::line::Domain;
use crate::domain::size::SizeWish;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::geometry::predicates::orient;
use crate::noding::arrangement::Arrangement;

/// Touching circles are a little larger than needed, so that rounding cannot lose them.
const SLACK: f64 = 1.02;

/// A finding for each room of `input` that `cleaned` has not, or not as its own.
pub fn lost(
    domain: &Domain,
    sizes: &SizeWish,
    options: &Options,
    input: &Arrangement,
    cleaned: &Arrangement,
) -> Vec<Finding> {
    let measure = Measure::new(domain, sizes, options);
    let lines = 0..domain.lines.len() as u32;
    let tolerance_m = lines.map(|it| measure.tolerance_m(it)).fold(0.0, f64::max);
    let radius_m = SLACK * tolerance_m.max(0.5 * sizes.default_m);
    let witnesses = witnesses(&Faces::of(&Graph::new(input, &measure)), radius_m);
    let graph = Graph::new(cleaned, &measure);
    let faces = Faces::of(&graph);
    let mut homes: Vec<(Option<u32>, Xy)> = (witnesses.iter())
        .map(|&at| (faces.face_around(at), at))
        .collect();
    homes.sort_by(|a, b| {
        (a.0.cmp(&b.0))
            .then(a.1[0].total_cmp(&b.1[0]))
            .then(a.1[1].total_cmp(&b.1[1]))
    });
    let mut findings = Vec::new();
    for (k, &(home, at)) in homes.iter().enumerate() {
        let is_second = k > 0 && homes[k - 1].0 == home;
        let text = match home {
            None => "A sub-domain with room for elements lies outside after clean-up.",
            Some(_) if is_second => {
                "Two sub-domains with room for elements became one: what parted them was dropped \
                 or moved."
            }
            Some(_) => continue,
        };
        let origin_m = domain.grid.origin_m;
        findings.push(Finding {
            what: "sub-domain-lost",
            text: text.to_string(),
            feature: None,
            at_m: Some([at[0] + origin_m[0], at[1] + origin_m[1]]),
        });
    }
    findings
}

/// The centres of circles of this radius, one for each face inside the domain that has place for it.
fn witnesses(faces: &Faces, radius_m: f64) -> Vec<Xy> {
    let graph = faces.graph;
    let mut seen: Vec<bool> = vec![false; faces.cycles.len()];
    let mut witnesses = Vec::new();
    let mut found = Vec::new();
    for half in 0..faces.cycle_of.len() as u32 {
        let cycle = faces.cycle_of[half as usize] as usize;
        let edge = &graph.edges[(half >> 1) as usize];
        if seen[cycle] || !edge.inside[(half & 1) as usize] {
            continue;
        }
        let [a, b] = faces.ends(half).map(|node| graph.metres(node));
        let length = distance(a, b);
        let normal = [(a[1] - b[1]) / length, (b[0] - a[0]) / length];
        let parts = 2
            * (length / (0.25 * graph.measure.default_m) / 2.0)
                .ceil()
                .max(1.0) as usize;
        let centre = (1..parts).find_map(|k| {
            let t = k as f64 / parts as f64;
            let p = [0, 1].map(|i| a[i] + t * (b[i] - a[i]) + radius_m * normal[i]);
            (faces.clearance_m(p, radius_m, &mut found) >= radius_m / SLACK).then_some(p)
        });
        if let Some(centre) = centre
            && let Some(face) = faces.face_around(centre)
        {
            let is_new = !std::mem::replace(&mut seen[face as usize], true);
            seen[cycle] = true;
            if is_new {
                witnesses.push(centre);
            }
        }
    }
    witnesses
}

/// A walk around a face, the face on its left.
struct Cycle {
    /// Twice its area, cells²: positive if it is the outer walk of its face. Exact: the walk around a
    /// free line has none.
    area_cells2: i128,
    /// Its lowest node from the left.
    first: Point,
}

/// The faces of a planar graph: a face is named by its outer walk.
struct Faces<'g, 'm> {
    graph: &'g Graph<'m>,
    /// Half-edge (edge << 1 | side) -> walk.
    cycle_of: Vec<u32>,
    cycles: Vec<Cycle>,
    /// By walk, the face that it bounds: its own one if it is an outer walk, none if that is the outside of all.
    face_of: Vec<Option<u32>>,
    /// West of this there is nothing, local metres.
    west_m: f64,
}

impl<'g, 'm> Faces<'g, 'm> {
    fn of(graph: &'g Graph<'m>) -> Faces<'g, 'm> {
        let mut made = Faces {
            graph,
            cycle_of: vec![u32::MAX; 2 * graph.edges.len()],
            cycles: Vec::new(),
            face_of: Vec::new(),
            west_m: f64::INFINITY,
        };
        for half in 0..made.cycle_of.len() as u32 {
            if made.cycle_of[half as usize] == u32::MAX {
                made.walk(half);
            }
        }
        made.name_faces();
        made
    }

    /// The nodes of a half-edge in its direction.
    fn ends(&self, half: u32) -> [u32; 2] {
        let [a, b] = self.graph.edges[(half >> 1) as usize].ends;
        if half & 1 == 0 { [a, b] } else { [b, a] }
    }

    fn walk(&mut self, start: u32) {
        let id = self.cycles.len() as u32;
        let origin = self.graph.point(self.ends(start)[0]);
        let mut cycle = Cycle {
            area_cells2: 0,
            first: origin,
        };
        let mut half = start;
        while self.cycle_of[half as usize] == u32::MAX {
            self.cycle_of[half as usize] = id;
            let [from, to] = self.ends(half);
            let (a, b) = (self.graph.point(from), self.graph.point(to));
            cycle.area_cells2 += i128::from(orient(origin, a, b));
            cycle.first = cycle.first.min(a);
            let next = leaving(self.graph, half >> 1, to);
            half = next << 1 | self.graph.edges[next as usize].end_at(to) as u32;
        }
        self.cycles.push(cycle);
    }

    /// The outside of a part that hangs on nothing is of the face that is seen left of its leftmost node. That one's walk
    /// begins farther left, so it is named before.
    fn name_faces(&mut self) {
        let mut order: Vec<usize> = (0..self.cycles.len()).collect();
        order.sort_unstable_by_key(|&id| self.cycles[id].first);
        let first = order.first().map(|&id| self.cycles[id].first);
        self.west_m = first.map_or(0.0, |it| self.graph.measure.metres(it)[0]);
        self.face_of = vec![None; self.cycles.len()];
        for id in order {
            let cycle = &self.cycles[id];
            let [x, y] = self.graph.measure.metres(cycle.first);
            self.face_of[id] = match cycle.area_cells2 > 0 {
                true => Some(id as u32),
                false => (self.seen_left([x - 1e-9, y]))
                    .and_then(|half| self.face_of[self.cycle_of[half as usize] as usize]),
            };
        }
    }

    /// The half-edge that one sees first when looking left from just above `p`: as far as it takes, four times as far
    /// each time.
    fn seen_left(&self, p: Xy) -> Option<u32> {
        let (graph, measure) = (self.graph, self.graph.measure);
        let mut reach_m = measure.default_m;
        loop {
            let west_m = (p[0] - reach_m).max(self.west_m);
            let [from, to] = [[west_m, p[1]], p].map(|it| measure.on_grid(it));
            // where it is seen, and how far right it leads on the way up: of two at one place, that one is in front
            let mut best: Option<([f64; 2], u32)> = None;
            graph.index.any(from, to, 1.0, |held| {
                let (a, b) = graph.ends_m(held.edge);
                if (a[1] > p[1]) == (b[1] > p[1]) {
                    return false;
                }
                let slope = (b[0] - a[0]) / (b[1] - a[1]);
                let seen = [a[0] + (p[1] - a[1]) * slope, slope];
                if seen[0] < p[0] && best.is_none_or(|it| seen > it.0) {
                    // p is on its right if it leads up, on its left if it leads down
                    best = Some((seen, held.edge << 1 | u32::from(b[1] > a[1])));
                }
                false
            });
            // what was not looked for may be in front of what is farther away
            let is_sure = best.is_some_and(|it| it.0[0] >= west_m);
            if is_sure || west_m <= self.west_m {
                return best.map(|it| it.1);
            }
            reach_m *= 4.0;
        }
    }

    /// The face in which `p` lies, if that is a part of the domain.
    fn face_around(&self, p: Xy) -> Option<u32> {
        let half = self.seen_left(p)?;
        let edge = &self.graph.edges[(half >> 1) as usize];
        match edge.inside[(half & 1) as usize] {
            true => self.face_of[self.cycle_of[half as usize] as usize],
            false => None,
        }
    }

    /// Distance from `p` to the nearest edge, or `reach_m`.
    fn clearance_m(&self, p: Xy, reach_m: f64, found: &mut Vec<u32>) -> f64 {
        let cell_m = self.graph.measure.grid().cell_m;
        let at = self.graph.measure.on_grid(p);
        (self.graph.index).edges_near(NO_NODE, at, reach_m / cell_m, found);
        let away = found.iter().map(|&edge| {
            let (a, b) = self.graph.ends_m(edge);
            to_segment(p, a, b).0
        });
        away.fold(reach_m, f64::min)
    }
}
