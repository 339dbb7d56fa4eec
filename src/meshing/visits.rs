//! The walks with one node a *visit*: what makes slits and touching walks ordinary boundaries.
//!
//! A free line is walked on both sides, so its nodes occur several times. Inside `meshing` each
//! occurrence is a node of its own ("visit"): the walks are then disjoint simple cycles, each visit
//! has exactly one interior angle, and no method needs to know what a slit is. Coincident visits
//! become one node again when the patch is finished.

use crate::geometry::point::Xy;
use crate::geometry::quad::cross;
use crate::meshing::patch::Loops;

/// The walks of one sub-domain, a node a visit, walk after walk.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Visits {
    /// Position of each visit, metres.
    pub nodes: Vec<Xy>,
    /// `walk_start[w]..walk_start[w + 1]` are the visits of walk `w`, in order; one longer than the
    /// number of walks.
    pub walk_start: Vec<u32>,
    /// Visit -> index into `Loops::nodes`.
    pub unique: Vec<u32>,
    /// True if the edge from this visit to the next lies on a seam.
    pub on_seam: Vec<bool>,
    /// How deep the quads across the edge from this visit to the next are likely to be, metres; 0 if unknown.
    pub across_m: Vec<f64>,
}

impl Visits {
    /// One visit for each entry of each walk.
    pub fn of(loops: &Loops) -> Visits {
        let mut visits = Visits {
            nodes: Vec::new(),
            walk_start: vec![0],
            unique: Vec::new(),
            on_seam: Vec::new(),
            across_m: loops.across_m.concat(),
        };
        for (walk, seam) in loops.walks.iter().zip(&loops.on_seam) {
            visits.unique.extend(walk);
            visits.on_seam.extend(seam);
            visits.walk_start.push(visits.unique.len() as u32);
        }
        visits.across_m.resize(visits.unique.len(), 0.0);
        let place = |&node: &u32| loops.nodes[node as usize];
        visits.nodes = visits.unique.iter().map(place).collect();
        visits
    }

    /// Number of visits, which is the number of boundary edges.
    pub fn len(&self) -> usize {
        self.unique.len()
    }

    /// The visit after `visit` on its walk.
    pub fn next(&self, visit: u32) -> u32 {
        let walk = self.walk_of(visit);
        if visit + 1 == self.walk_start[walk + 1] {
            self.walk_start[walk]
        } else {
            visit + 1
        }
    }

    /// The visit before `visit` on its walk.
    pub fn previous(&self, visit: u32) -> u32 {
        let walk = self.walk_of(visit);
        if visit == self.walk_start[walk] {
            self.walk_start[walk + 1] - 1
        } else {
            visit - 1
        }
    }

    /// The walk that `visit` belongs to. O(log walks).
    pub fn walk_of(&self, visit: u32) -> usize {
        self.walk_start.partition_point(|&start| start <= visit) - 1
    }

    /// The interior angle at `visit`, radians, in (0, 2 pi]; 2 pi at the tip of a slit.
    pub fn angle(&self, visit: u32) -> f64 {
        let at = self.nodes[visit as usize];
        let toward = |other: u32| {
            let p = self.nodes[other as usize];
            (p[1] - at[1]).atan2(p[0] - at[0])
        };
        let turn = toward(self.previous(visit)) - toward(self.next(visit));
        // A tip goes back along the very same segment, so its turn is exactly zero.
        if turn <= 0.0 {
            turn + std::f64::consts::TAU
        } else {
            turn
        }
    }

    /// Area of the sub-domain, m².
    pub fn area_m2(&self) -> f64 {
        let origin = self.nodes[0];
        let fan = (0..self.len() as u32).map(|visit| {
            let [a, b] = [visit, self.next(visit)].map(|visit| self.nodes[visit as usize]);
            cross(origin, a, b)
        });
        0.5 * fan.sum::<f64>()
    }
}
