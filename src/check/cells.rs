//! Promises `quads` and `jacobians`: each cell by itself.

use crate::check::verdict::Promise;
use crate::check::verdict::projected;
use crate::chunk::views::PatchView;
use crate::geometry::point::Xy;
use crate::geometry::quad::corner_jacobians;

pub(crate) struct Cells {
    origin_m: Xy,
    quads: Promise,
    jacobians: Promise,
    cells: u64,
    /// Least corner Jacobian so far, m².
    least_m2: f64,
    /// Node of the patch at hand -> is it used?
    used: Vec<bool>,
}

impl Cells {
    pub fn new(origin_m: Xy) -> Cells {
        Cells {
            origin_m,
            quads: Promise::new("quads"),
            jacobians: Promise::new("jacobians"),
            cells: 0,
            least_m2: f64::INFINITY,
            used: Vec::new(),
        }
    }

    /// True if every cell names nodes of its patch.
    pub fn has_sound_indices(&self, patch: &PatchView) -> bool {
        let nodes = patch.nodes() as u32;
        patch.quads.as_flattened().iter().all(|&node| node < nodes)
    }

    /// Looks at all cells of `patch`; false if some name no node of it.
    pub fn add(&mut self, patch: &PatchView, places: &[Xy]) -> bool {
        self.cells += patch.quads.len() as u64;
        let subdomain = patch.subdomain;
        if !self.has_sound_indices(patch) {
            let text = || format!("sub-domain {subdomain}: a cell names a node that is not there");
            self.quads.broken(None, text);
            return false;
        }
        self.used.clear();
        self.used.resize(patch.nodes(), false);
        for (k, quad) in patch.quads.iter().enumerate() {
            quad.iter()
                .for_each(|&node| self.used[node as usize] = true);
            let corners = quad.map(|node| places[node as usize]);
            let at_m = projected(corners[0], self.origin_m);
            let [a, b, c, d] = *quad;
            if a == b || a == c || a == d || b == c || b == d || c == d {
                self.quads.broken(at_m, || {
                    format!("sub-domain {subdomain}, quad {k}: nodes {quad:?} are not distinct")
                });
            }
            let mut least = least_jacobian_m2(&corners);
            if least < SMALL_M2 {
                // So thin a cell may fold where coordinates are projected, as exports are.
                let o = self.origin_m;
                least = least.min(least_jacobian_m2(
                    &corners.map(|p| [p[0] + o[0], p[1] + o[1]]),
                ));
            }
            self.least_m2 = self.least_m2.min(least);
            // Not `<=`: a NaN is no positive Jacobian either.
            if least.is_nan() || least <= 0.0 {
                self.jacobians.broken(at_m, || {
                    format!("sub-domain {subdomain}, quad {k}: corner Jacobian {least:e} m²")
                });
            }
        }
        if let Some(unused) = self.used.iter().position(|&it| !it) {
            let at_m = projected(places[unused], self.origin_m);
            self.quads.broken(at_m, || {
                format!("sub-domain {subdomain}: node {unused} is in no cell")
            });
        }
        true
    }

    pub fn promises(mut self) -> [Promise; 2] {
        self.quads
            .says(format!("{} cells, all of four nodes", self.cells));
        self.jacobians
            .says(format!("least corner Jacobian {:.3e} m²", self.least_m2));
        [self.quads, self.jacobians]
    }
}

/// Jacobians below this are computed again from projected coordinates, m². Those have an error of
/// about 1e-9 m, so a corner between sides shorter than 100 km cannot change its sign above it.
const SMALL_M2: f64 = 1e-3;

/// The least corner Jacobian, m²; NaN if any is.
fn least_jacobian_m2(corners: &[Xy; 4]) -> f64 {
    let lesser = |a: f64, b: f64| if a.is_nan() || a < b { a } else { b };
    corner_jacobians(corners)
        .into_iter()
        .fold(f64::INFINITY, lesser)
}
