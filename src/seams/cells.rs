//! What candidates divide the large sub-domains into.

use crate::domain::finding::Finding;
use crate::domain::line::Domain;
use crate::geometry::point::Point;
use crate::noding::arrangement::Arrangement;
use crate::partition;
use crate::partition::partition;
use crate::partition::sides;
use crate::partition::subdomains::Subdomain;
use crate::seams::merge::Border;
use crate::seams::propose::Candidate;
use crate::seams::splice::splice;
use crate::seams::splice::straight;

/// The faces of the arrangement with all candidates.
pub(super) struct Cells {
    /// Estimated quads of each.
    pub quads: Vec<f64>,
    /// A node of each.
    pub at: Vec<Point>,
    /// The cells on both sides of each candidate.
    pub borders: Vec<Border>,
}

/// Quads that a lattice of this pitch has in a sub-domain.
pub(super) fn quads(domain: &Domain, pitch: i32, subdomain: &Subdomain) -> f64 {
    let pitch_m = f64::from(pitch) * domain.grid.cell_m;
    subdomain.area_m2 / (pitch_m * pitch_m)
}

impl Cells {
    pub fn of(
        domain: &Domain,
        arrangement: &Arrangement,
        candidates: &[Candidate],
        pitch: i32,
    ) -> Cells {
        let straights: Vec<[Point; 2]> = candidates.iter().filter_map(straight).collect();
        let divided = splice(arrangement, candidates, &straights);
        // Corners and tiles do not matter for faces.
        let options = partition::Options {
            corner_deg: 180.0,
            tile_cells: u32::MAX,
        };
        let faces = partition(domain, &divided, &options)
            .expect("seams lie inside the domain and leave its rim as it was");
        let side = sides(&divided, &faces);
        let border = |candidate: &Candidate| {
            let on_it = straight(candidate).or(candidate.stops[0].piece());
            let half = on_it.map_or(0, |ends| edge_between(&divided, ends) << 1);
            Border {
                cells: [side[half as usize], side[half as usize + 1]],
                price: candidate.price,
            }
        };
        Cells {
            quads: (faces.subdomains.iter())
                .map(|face| quads(domain, pitch, face))
                .collect(),
            at: (faces.subdomains.iter())
                .map(|face| faces.curves[(face.walks[0][0] >> 1) as usize].nodes[0])
                .map(|node| divided.points[node as usize])
                .collect(),
            borders: candidates.iter().map(border).collect(),
        }
    }

    /// A finding for each of the parts (of cells, by `part`) with more than `most` quads.
    pub fn too_large(&self, domain: &Domain, part: &[u32], most: f64) -> Vec<Finding> {
        let mut quads = vec![0.0; part.len()];
        for (cell, &part) in part.iter().enumerate() {
            quads[part as usize] += self.quads[cell];
        }
        (quads.iter().enumerate())
            .filter(|(_, quads)| **quads > most)
            .map(|(part, quads)| Finding {
                what: "large-part",
                text: format!(
                    "A part of a sub-domain has about {quads:.0} quads, which is more than \
                     {most:.0}: no good place was found for a seam."
                ),
                feature: None,
                at_m: Some(domain.grid.projected_m(self.at[part])),
            })
            .collect()
    }
}

/// The edge between two points, which must be there.
fn edge_between(arrangement: &Arrangement, ends: [Point; 2]) -> u32 {
    let mut edge = ends.map(|end| arrangement.points.binary_search(&end).expect("a node") as u32);
    edge.sort_unstable();
    let found = arrangement.edges.binary_search(&edge);
    found.expect("a seam is an edge") as u32
}
