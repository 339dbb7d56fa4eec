//! Strips with an odd number of border edges, joined through the core.
//!
//! Walks may be odd one by one; only their sum is even. A core that separates two odd walks (an
//! island inside it, the two sides of a part between seams) leaves two strips of which neither can
//! be paired. No regular lattice exists around an odd walk, so the core is opened between them
//! along a shortest way.

use crate::meshing::core::Core;
use crate::meshing::core::cell;
use crate::meshing::strip_border::StripBorder;
use crate::meshing::triangulate::NONE;
use crate::meshing::triangulate::Triangles;

/// The connected parts of the strip.
pub(crate) struct Regions {
    /// Triangle -> region.
    of: Vec<u32>,
    /// Region -> true if its number of triangles is odd.
    is_odd: Vec<bool>,
}

impl Regions {
    /// True if every part can be paired.
    pub fn all_even(&self) -> bool {
        !self.is_odd.contains(&true)
    }
}

/// Floods the triangles.
pub(crate) fn regions(triangles: &Triangles) -> Regions {
    let count = triangles.corners.len();
    let mut regions = Regions {
        of: vec![NONE; count],
        is_odd: Vec::new(),
    };
    let mut stack = Vec::new();
    for start in 0..count {
        if regions.of[start] != NONE {
            continue;
        }
        let region = regions.is_odd.len() as u32;
        regions.is_odd.push(false);
        regions.of[start] = region;
        stack.push(start);
        while let Some(t) = stack.pop() {
            regions.is_odd[region as usize] ^= true;
            for &n in &triangles.neighbours[t] {
                if n != NONE && regions.of[n as usize] == NONE {
                    regions.of[n as usize] = region;
                    stack.push(n as usize);
                }
            }
        }
    }
    regions
}

/// Opens corridors through the core until every part of the strip that is joined by them is even:
/// each odd part goes to the nearest other odd one, or to the nearest at all.
pub(crate) fn join_odd(
    core: &mut Core,
    border: &StripBorder,
    triangles: &Triangles,
    regions: &Regions,
) {
    let mut gates = gates(border, triangles, regions);
    let mut is_odd = regions.is_odd.clone();
    let mut opened = Vec::new();
    while let Some(region) = is_odd.iter().position(|&odd| odd) {
        let Some(way) = shortest_way(core, &gates, &is_odd, region as u32) else {
            break;
        };
        let other = way.to as usize;
        is_odd[other] ^= true;
        is_odd[region] = false;
        for gate in &mut gates {
            if gate.1 == region as u32 {
                gate.1 = way.to;
            }
        }
        opened.extend(way.cells);
    }
    core.open_corridors(&opened);
}

/// Strip cells at the core's rim, and the region that they belong to; sorted.
fn gates(border: &StripBorder, triangles: &Triangles, regions: &Regions) -> Vec<(u32, u32)> {
    let mut gates = Vec::new();
    for (t, corners) in triangles.corners.iter().enumerate() {
        for k in 0..3 {
            if triangles.neighbours[t][k] == NONE
                && let Some(cell) = border.rim_cell[corners[k] as usize]
            {
                gates.push((cell, regions.of[t]));
            }
        }
    }
    gates.sort_unstable();
    gates.dedup();
    gates
}

/// A way through the core from one region to another.
struct Way {
    to: u32,
    cells: Vec<u32>,
}

/// Breadth-first through core cells from `region` to the nearest odd region, else to the nearest.
fn shortest_way(core: &Core, gates: &[(u32, u32)], is_odd: &[bool], region: u32) -> Option<Way> {
    let w = core.columns;
    let mut from = vec![NONE; core.cells.len()];
    let mut queue: Vec<u32> = Vec::new();
    for &(cell, _) in gates.iter().filter(|gate| gate.1 == region) {
        from[cell as usize] = cell;
        queue.push(cell);
    }
    let mut best: Option<(u32, u32)> = None;
    let mut head = 0;
    while head < queue.len() {
        let at = queue[head] as usize;
        head += 1;
        for n in [at - w, at - 1, at + 1, at + w] {
            if from[n] != NONE {
                continue;
            }
            if core.cells[n] >= cell::ZONE {
                from[n] = at as u32;
                queue.push(n as u32);
                continue;
            }
            let first = gates.partition_point(|gate| gate.0 < n as u32);
            let Some(&(_, other)) = gates[first..].iter().find(|gate| gate.0 == n as u32) else {
                continue;
            };
            if core.cells[at] >= cell::ZONE && other != region {
                if is_odd[other as usize] {
                    return Some(trace(&from, at as u32, other));
                }
                best = best.or(Some((at as u32, other)));
            }
        }
    }
    best.map(|(at, other)| trace(&from, at, other))
}

/// The core cells on the way back from `at`.
fn trace(from: &[u32], mut at: u32, to: u32) -> Way {
    let mut cells = Vec::new();
    while from[at as usize] != at {
        cells.push(at);
        at = from[at as usize];
    }
    Way { to, cells }
}
