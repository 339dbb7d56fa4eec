//! Promises `conforming` and `areas`: the cells of a patch against its walks.

use crate::check::verdict::Promise;
use crate::check::verdict::projected;
use crate::chunk::views::FrameView;
use crate::chunk::views::PatchView;
use crate::geometry::point::Xy;
use crate::geometry::quad::area;

/// Relative difference of areas that rounding may make.
pub(crate) const AREA_REL: f64 = 1e-9;

/// Directed edges by their first node; asking for one costs the node's valence.
#[derive(Default)]
struct Fans {
    start: Vec<u32>,
    to: Vec<u32>,
}

impl Fans {
    fn fill(&mut self, nodes: usize, edges: impl Iterator<Item = [u32; 2]> + Clone) {
        self.start.clear();
        self.start.resize(nodes + 1, 0);
        for [a, _] in edges.clone() {
            self.start[a as usize] += 1;
        }
        let mut at = 0;
        for start in &mut self.start {
            at += *start;
            *start = at;
        }
        self.to.clear();
        self.to.resize(at as usize, 0);
        // Filled from the end of each fan, so that `start` ends up at its begin.
        for [a, b] in edges {
            self.start[a as usize] -= 1;
            self.to[self.start[a as usize] as usize] = b;
        }
    }

    fn of(&self, a: u32) -> &[u32] {
        let a = a as usize;
        &self.to[self.start[a] as usize..self.start[a + 1] as usize]
    }

    fn has(&self, a: u32, b: u32) -> bool {
        self.of(a).contains(&b)
    }
}

pub(crate) struct Conforming<'a> {
    frame: FrameView<'a>,
    origin_m: Xy,
    conforming: Promise,
    areas: Promise,
    /// Global id -> local id in the patch at hand; `NONE` elsewhere.
    local_of: Vec<u32>,
    /// Directed edges of the cells.
    cells: Fans,
    /// Directed edges of the walks, local ids.
    walk: Vec<[u32; 2]>,
    /// Boundary node of the patch at hand -> does a walk pass it?
    walked: Vec<bool>,
    walks: Fans,
    edges: u64,
    worst_area_rel: f64,
}

const NONE: u32 = u32::MAX;

impl<'a> Conforming<'a> {
    pub fn new(frame: FrameView<'a>, origin_m: Xy) -> Conforming<'a> {
        Conforming {
            frame,
            origin_m,
            conforming: Promise::new("conforming"),
            areas: Promise::new("areas"),
            local_of: vec![NONE; frame.nodes.len()],
            cells: Fans::default(),
            walk: Vec::new(),
            walked: Vec::new(),
            walks: Fans::default(),
            edges: 0,
            worst_area_rel: 0.0,
        }
    }

    pub fn add(&mut self, patch: &PatchView, places: &[Xy]) {
        if self.localise_walks(patch) {
            let nodes = patch.nodes();
            let quads = patch.quads.iter();
            let sides = quads.flat_map(|q| (0..4).map(move |k| [q[k], q[(k + 1) % 4]]));
            self.cells.fill(nodes, sides);
            self.walks.fill(nodes, self.walk.iter().copied());
            self.compare(patch, places);
            self.compare_areas(patch, places);
        }
        for &id in patch.boundary {
            self.local_of[id as usize] = NONE;
        }
    }

    /// The walks in local ids. False (and a defect) if their nodes are not the patch's.
    fn localise_walks(&mut self, patch: &PatchView) -> bool {
        let subdomain = patch.subdomain;
        let mut fits = true;
        for (local, &id) in patch.boundary.iter().enumerate() {
            fits &= self.local_of[id as usize] == NONE;
            self.local_of[id as usize] = local as u32;
        }
        self.walk.clear();
        self.walked.clear();
        self.walked.resize(patch.boundary.len(), false);
        for walk in self.frame.walks_of(subdomain as usize) {
            for [a, b] in self.frame.walk_edges(walk) {
                let edge = [a, b].map(|id| self.local_of[id as usize]);
                fits &= !edge.contains(&NONE);
                if let Some(walked) = self.walked.get_mut(edge[0] as usize) {
                    *walked = true;
                }
                self.walk.push(edge);
            }
        }
        fits &= self.walked.iter().all(|&it| it);
        if !fits {
            let at_m = (patch.boundary.first())
                .and_then(|&id| projected(self.frame.nodes[id as usize], self.origin_m));
            self.conforming.broken(at_m, || {
                format!("sub-domain {subdomain}: its boundary nodes are not those of its walks")
            });
        }
        fits
    }

    fn compare(&mut self, patch: &PatchView, places: &[Xy]) {
        let boundary = patch.boundary.len() as u32;
        let subdomain = patch.subdomain;
        let middle = |a: u32, b: u32| {
            let (p, q) = (places[a as usize], places[b as usize]);
            projected([0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])], self.origin_m)
        };
        let mut broken = |a: u32, b: u32, what: &str| {
            self.conforming.broken(middle(a, b), || {
                format!("sub-domain {subdomain}, edge {a} -> {b}: {what}")
            });
        };
        for &[a, b] in &self.walk {
            if !self.cells.has(a, b) {
                broken(a, b, "no cell has this edge of the walk");
            }
            if self.walks.of(a).iter().filter(|&&to| to == b).count() > 1 {
                broken(a, b, "walked twice in one direction");
            }
        }
        for a in 0..patch.nodes() as u32 {
            let fan = self.cells.of(a);
            self.edges += fan.len() as u64;
            for (k, &b) in fan.iter().enumerate() {
                if fan[..k].contains(&b) {
                    broken(a, b, "used by more than two cells");
                }
                let twice = self.cells.has(b, a);
                let may_be_walked = a < boundary && b < boundary;
                let walked = may_be_walked && self.walks.has(a, b);
                if !twice && !walked {
                    broken(a, b, "used by one cell only: a hanging node or a crack");
                }
                if twice && walked != (may_be_walked && self.walks.has(b, a)) {
                    broken(a, b, "cells on both sides of an edge of the walk");
                }
            }
        }
    }

    fn compare_areas(&mut self, patch: &PatchView, places: &[Xy]) {
        // Differences to a node of the patch: products of large coordinates would cancel badly.
        let o = places[0];
        let walks_m2: f64 = (self.walk.iter())
            .map(|&[a, b]| {
                let (p, q) = (places[a as usize], places[b as usize]);
                0.5 * ((p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]))
            })
            .sum();
        let cells_m2: f64 = (patch.quads.iter())
            .map(|quad| area(&quad.map(|node| places[node as usize])))
            .sum();
        let rel = (walks_m2 - cells_m2).abs() / walks_m2.abs().max(cells_m2.abs());
        self.worst_area_rel = self.worst_area_rel.max(rel);
        if rel.is_nan() || rel > AREA_REL {
            let subdomain = patch.subdomain;
            self.areas.broken(projected(o, self.origin_m), || {
                format!("sub-domain {subdomain}: cells {cells_m2} m², walks {walks_m2} m²")
            });
        }
    }

    pub fn promises(mut self) -> [Promise; 2] {
        // Each directed edge of a cell once; an inner edge has two of them.
        self.conforming
            .says(format!("{} sides of cells", self.edges));
        self.areas.says(format!(
            "largest relative difference {:.1e}",
            self.worst_area_rel
        ));
        [self.conforming, self.areas]
    }
}
