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
    let tolerance_m = measure.tolerance_m.iter().copied().fold(0.0, f64::max);
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
    /// Edges by the horizontal strips that they come into, CSR.
    strip_start: Vec<u32>,
    strip_edges: Vec<u32>,
    bottom_m: f64,
}

impl<'g, 'm> Faces<'g, 'm> {
    fn of(graph: &'g Graph<'m>) -> Faces<'g, 'm> {
        let mut made = Faces {
            graph,
            cycle_of: vec![u32::MAX; 2 * graph.edges.len()],
            cycles: Vec::new(),
            strip_start: Vec::new(),
            strip_edges: Vec::new(),
            bottom_m: 0.0,
        };
        for half in 0..made.cycle_of.len() as u32 {
            if made.cycle_of[half as usize] == u32::MAX {
                made.walk(half);
            }
        }
        made.fill_strips();
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

    fn strip(&self, y_m: f64) -> usize {
        let strips = self.strip_start.len().saturating_sub(2);
        (((y_m - self.bottom_m) / self.graph.measure.default_m).max(0.0) as usize).min(strips)
    }

    fn fill_strips(&mut self) {
        let graph = self.graph;
        let heights = |edge: usize| {
            let (a, b) = graph.ends_m(edge as u32);
            [a[1].min(b[1]), a[1].max(b[1])]
        };
        let all = 0..graph.edges.len();
        let spans = all.clone().map(heights);
        let [low, high] = spans.fold([f64::INFINITY, f64::NEG_INFINITY], |it, [low, high]| {
            [it[0].min(low), it[1].max(high)]
        });
        self.bottom_m = low;
        let strips = ((high - low) / graph.measure.default_m).max(0.0) as usize + 1;
        self.strip_start = vec![0; strips + 1];
        let mut entries: Vec<(u32, u32)> = Vec::new();
        for edge in all {
            let [low, high] = heights(edge).map(|y| self.strip(y));
            entries.extend((low..=high).map(|strip| (strip as u32, edge as u32)));
        }
        entries.sort_unstable();
        for (strip, _) in &entries {
            self.strip_start[*strip as usize + 1] += 1;
        }
        for strip in 0..strips {
            self.strip_start[strip + 1] += self.strip_start[strip];
        }
        self.strip_edges = entries.into_iter().map(|it| it.1).collect();
    }

    /// The half-edge that one sees first when looking left from `p`.
    fn seen_left(&self, p: Xy) -> Option<u32> {
        let strip = self.strip(p[1]);
        let edges = self.strip_start[strip] as usize..self.strip_start[strip + 1] as usize;
        let mut best: Option<(f64, u32)> = None;
        for &edge in &self.strip_edges[edges] {
            let (a, b) = self.graph.ends_m(edge);
            if (a[1] > p[1]) == (b[1] > p[1]) {
                continue;
            }
            let x = a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            if x < p[0] && best.is_none_or(|it| x > it.0) {
                // p is on its right if it leads up, on its left if it leads down
                best = Some((x, edge << 1 | u32::from(b[1] > a[1])));
            }
        }
        best.map(|it| it.1)
    }

    /// The face in which `p` lies, if that is a part of the domain.
    fn face_around(&self, p: Xy) -> Option<u32> {
        let mut half = self.seen_left(p)?;
        let edge = &self.graph.edges[(half >> 1) as usize];
        if !edge.inside[(half & 1) as usize] {
            return None;
        }
        loop {
            let cycle = &self.cycles[self.cycle_of[half as usize] as usize];
            if cycle.area_cells2 > 0 {
                return Some(self.cycle_of[half as usize]);
            }
            // the outside of a part that hangs on nothing: on from its leftmost node
            let [x, y] = self.graph.measure.metres(cycle.first);
            half = self.seen_left([x - 1e-9, y])?;
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
