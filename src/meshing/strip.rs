//! A lattice core, and around it a strip of paired triangles to the walks.
//!
//! 1. `lattice`: direction and phase that suit the walks (given if the sub-domain was cut).
//! 2. `core`: the cells at least two pitches from the walks, without whiskers and pinches.
//! 3. `core_quads`, `strip_border`: its quads; what is left is bounded by the walks and its rim.
//! 4. `rows`: a row of nodes along the walks by angle, lattice nodes behind it.
//! 5. `triangulate`, `pairing`: constrained Delaunay triangles, paired to quads.
//!
//! The finish then moves the strip and three rows of the core. Where nothing is far enough from the
//! walks there is no core, and the rest goes on as it is.

use crate::meshing::core::Core;
use crate::meshing::core_quads;
use crate::meshing::core_quads::CoreQuads;
use crate::meshing::corridor;
use crate::meshing::draft::Draft;
use crate::meshing::lattice::Lattice;
use crate::meshing::pairing;
use crate::meshing::patch::Loops;
use crate::meshing::patch::Method;
use crate::meshing::rows;
use crate::meshing::strip_border;
use crate::meshing::strip_border::StripBorder;
use crate::meshing::triangulate::triangulate;
use crate::meshing::visits::Visits;

/// Corridors change the strip, so they may have to be laid again; then the core is given up.
const MOST_ROUNDS: usize = 4;

/// Meshes one sub-domain. `None` if its walks are not planar or its extent is out of all
/// proportion to its size.
pub(crate) fn mesh(visits: &Visits, loops: &Loops) -> Option<Draft> {
    let next = successors(visits);
    let lattice = match loops.lattice_origin {
        Some(origin_m) => Lattice::aligned(origin_m, loops.size_m),
        None => Lattice::fit(visits, &next, loops.size_m),
    };
    let mut core = Core::carve(visits, &next, lattice)?;
    for round in 0..=MOST_ROUNDS {
        core.mark_zone();
        let quads = core_quads::collect(&core, visits, &next);
        let border = strip_border::chain(visits, &next, &quads)?;
        let inner = rows::nodes(&border, &core);
        let triangles = triangulate(&border.visits, &inner)?;
        let regions = corridor::regions(&triangles);
        if regions.all_even() {
            let fixed = fixed_visits(&border);
            let strip = pairing::pair(&triangles, fixed);
            return Some(assemble(visits, quads, &border, &strip));
        }
        if round + 1 < MOST_ROUNDS {
            corridor::join_odd(&mut core, &border, &triangles, &regions);
        } else {
            core.clear_all();
        }
    }
    None
}

/// Visit -> the visit after it.
fn successors(visits: &Visits) -> Vec<u32> {
    let mut next: Vec<u32> = (1..=visits.len() as u32).collect();
    for walk in visits.walk_start.windows(2) {
        next[walk[1] as usize - 1] = walk[0];
    }
    next
}

/// Border visits up to the end of the last walk that has a fixed node.
fn fixed_visits(border: &StripBorder) -> usize {
    let starts = &border.visits.walk_start;
    let mut fixed = 0;
    for walk in starts.windows(2) {
        let range = walk[0] as usize..walk[1] as usize;
        if border.rim_cell[range.clone()].iter().any(Option::is_none) {
            fixed = range.end;
        }
    }
    fixed
}

/// Core quads, then the strip's, in one numbering without unused nodes.
fn assemble(visits: &Visits, core: CoreQuads, border: &StripBorder, strip: &Draft) -> Draft {
    let mut nodes = visits.nodes.clone();
    nodes.extend(&core.nodes);
    let mut number = border.node.clone();
    number.resize(strip.nodes.len(), u32::MAX);
    let settled = core.settled;
    let has_core = !core.quads.is_empty();
    let mut quads = core.quads;
    for quad in &strip.quads {
        quads.push(quad.map(|node| {
            let node = node as usize;
            if number[node] == u32::MAX {
                number[node] = nodes.len() as u32;
                nodes.push(strip.nodes[node]);
            }
            number[node]
        }));
    }
    Draft {
        nodes,
        visits: visits.len(),
        quads,
        settled,
        method: if has_core {
            Method::Strip
        } else {
            Method::Indirect
        },
    }
}
