//! The quads of the core, and its rim toward the strip.

use crate::geometry::point::Xy;
use crate::meshing::core::Core;
use crate::meshing::core::cell;
use crate::meshing::visits::Visits;

/// No node.
const NONE: u32 = u32::MAX;
/// A lattice node on a seam: which visit it is depends on the cell that asks.
const SEAM: u32 = u32::MAX - 1;

/// The core as quads; its own nodes are numbered on from the visits.
#[derive(Clone, Debug)]
pub(crate) struct CoreQuads {
    /// The nodes of the core that are no visits, metres.
    pub nodes: Vec<Xy>,
    /// Settled quads, then those of the zone.
    pub quads: Vec<[u32; 4]>,
    /// Number of settled quads.
    pub settled: usize,
    /// Edges of the core toward the strip.
    pub rim: Vec<RimEdge>,
    /// Visits whose edge to the next visit is a core edge (on a seam).
    pub covered: Vec<bool>,
}

/// An edge between core and strip, with the core on its left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RimEdge {
    pub from: u32,
    pub to: u32,
    /// The map's cell on its right, in the strip.
    pub beyond: u32,
}

/// Numbers the nodes row by row and collects quads and rim. O(cells of the map).
pub(crate) fn collect(core: &Core, visits: &Visits, next: &[u32]) -> CoreQuads {
    let w = core.columns;
    let count = core.count();
    let mut out = CoreQuads {
        nodes: Vec::with_capacity(count + count / 8),
        quads: Vec::with_capacity(count),
        settled: 0,
        rim: Vec::new(),
        covered: vec![false; visits.len()],
    };
    let mut zone: Vec<[u32; 4]> = Vec::new();
    let (mut low, mut high) = (vec![NONE; w], vec![NONE; w]);
    for j in 1..core.rows - 1 {
        std::mem::swap(&mut low, &mut high);
        number_row(core, j + 1, visits.len(), &mut high, &mut out.nodes);
        for i in 1..w - 1 {
            let state = core.cells[j * w + i];
            if state < cell::ZONE {
                continue;
            }
            let mut quad = [low[i], low[i + 1], high[i + 1], high[i]];
            let at_seam = quad.contains(&SEAM);
            if at_seam {
                settle_on_seam(core, visits, next, [i, j], &mut quad);
            }
            if at_seam || state == cell::ZONE {
                note_sides(core, next, j * w + i, quad, &mut out);
            }
            if state == cell::SETTLED {
                out.quads.push(quad);
            } else {
                zone.push(quad);
            }
        }
    }
    out.settled = out.quads.len();
    out.quads.append(&mut zone);
    out
}

/// Numbers the core's nodes on lattice row `j`.
fn number_row(core: &Core, j: usize, visits: usize, row: &mut [u32], nodes: &mut Vec<Xy>) {
    let w = core.columns;
    let (under, over) = core.cells[(j - 1) * w..(j + 1) * w].split_at(w);
    row.fill(NONE);
    let first = core.seam_nodes.partition_point(|&(row, ..)| row < j as u32);
    let on_row = core.seam_nodes[first..].iter();
    for &(_, i, _) in on_row.take_while(|&&(row, ..)| row == j as u32) {
        row[i as usize] = SEAM;
    }
    for i in 1..w {
        let most = under[i - 1].max(under[i]).max(over[i - 1]).max(over[i]);
        if most >= cell::ZONE && row[i] != SEAM {
            row[i] = (visits + nodes.len()) as u32;
            nodes.push(core.lattice.place([i as f64, j as f64]));
        }
    }
}

/// Gives cell `[i, j]` the visits in whose sectors it lies.
fn settle_on_seam(
    core: &Core,
    visits: &Visits,
    next: &[u32],
    [i, j]: [usize; 2],
    quad: &mut [u32; 4],
) {
    let middle = core.lattice.place([i as f64 + 0.5, j as f64 + 0.5]);
    for (k, (di, dj)) in [(0, 0), (1, 0), (1, 1), (0, 1)].into_iter().enumerate() {
        if quad[k] != SEAM {
            continue;
        }
        let here = core.seam_visits(i + di, j + dj);
        let faces = |&&(_, _, visit): &&(u32, u32, u32)| {
            let after = visits.nodes[next[visit as usize] as usize];
            let at = visits.nodes[visit as usize];
            turn(at, after, middle) < visits.angle(visit)
        };
        let found = here.iter().find(faces).unwrap_or(&here[0]);
        quad[k] = found.2;
    }
}

/// The angle at `at` from the direction of `a` counter-clockwise to that of `b`, in [0, 2 pi).
pub(crate) fn turn(at: Xy, a: Xy, b: Xy) -> f64 {
    let (ax, ay) = (a[0] - at[0], a[1] - at[1]);
    let (bx, by) = (b[0] - at[0], b[1] - at[1]);
    let angle = (ax * by - ay * bx).atan2(ax * bx + ay * by);
    if angle < 0.0 {
        angle + std::f64::consts::TAU
    } else {
        angle
    }
}

/// Notes which sides of a core cell are walk edges, and which look at the strip.
fn note_sides(core: &Core, next: &[u32], at: usize, quad: [u32; 4], out: &mut CoreQuads) {
    let w = core.columns;
    for (k, beyond) in [at - w, at + 1, at + w, at - 1].into_iter().enumerate() {
        let (from, to) = (quad[k], quad[(k + 1) % 4]);
        if next.get(from as usize) == Some(&to) {
            out.covered[from as usize] = true;
        } else if core.cells[beyond] < cell::ZONE {
            out.rim.push(RimEdge {
                from,
                to,
                beyond: beyond as u32,
            });
        }
    }
}
