//! Where the nodes of the strip lie: a row along the walks, by angle, and lattice nodes behind it.
//!
//! Each visit of a walk proposes the nodes that a regular mesh would have around it. Proposals too
//! close to the walks, to the core or to better ones are dropped; what stays open is filled with
//! lattice nodes, so that strip and core go over into each other where there is room.

use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::meshing::clearance::Clearance;
use crate::meshing::clearance::Spacing;
use crate::meshing::core::Core;
use crate::meshing::core::cell;
use crate::meshing::strip_border::StripBorder;

/// A row's nodes keep this share of their offset from the walks and from each other.
const ROW_GAP: f64 = 0.62;
/// Their least distance to a node of the core, pitches.
const CORE_GAP: f64 = 0.6;
/// Least distance of lattice nodes to the row and (in local spacings) to the walks, pitches.
const FILL_GAP: f64 = 0.75;

/// A proposed node. The order is that in which they are heard.
struct Proposal {
    rank: Rank,
    at: Xy,
    /// Distance to the walks, metres.
    clear_m: f64,
    /// Offset from its visit that it was made with, metres.
    offset_m: f64,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    /// In an acute corner: makes the corner one quad, so it must be there.
    Acute,
    /// Along sides and around corners.
    Row,
    /// In a corner near 90 degrees: where two rows meet, one node would do.
    End,
}

/// The inner nodes of the strip, metres.
pub(crate) fn nodes(border: &StripBorder, core: &Core) -> Vec<Xy> {
    let size_m = core.lattice.pitch_m;
    let walk = WalkEdges::of(border);
    let clearance = Clearance::of(walk.segments.clone(), size_m);
    let mut proposals = Vec::new();
    for k in 0..border.visits.len() {
        if border.on_walk[k] {
            propose(border, &walk, k, size_m, &clearance, &mut proposals);
        }
    }
    proposals.sort_by(|a, b| a.rank.cmp(&b.rank).then(b.clear_m.total_cmp(&a.clear_m)));
    let mut spacing = Spacing::new(size_m);
    let mut nodes = Vec::new();
    for proposal in &proposals {
        let gap = ROW_GAP * proposal.offset_m.min(size_m);
        if is_clear_of_core(core, proposal.at, CORE_GAP) && spacing.is_free(proposal.at, gap) {
            spacing.add(proposal.at);
            nodes.push(proposal.at);
        }
    }
    fill(core, &walk, &clearance, &spacing, &mut nodes);
    nodes
}

/// The border's walk edges, and which they are.
struct WalkEdges {
    segments: Vec<[Xy; 2]>,
    /// Border visit -> length of the edge that starts there, metres.
    length_m: Vec<f64>,
    /// Border visit -> the visits before and after it.
    before: Vec<u32>,
    after: Vec<u32>,
}

impl WalkEdges {
    fn of(border: &StripBorder) -> WalkEdges {
        let visits = &border.visits;
        let count = visits.len();
        let mut walk = WalkEdges {
            segments: Vec::with_capacity(count),
            length_m: Vec::with_capacity(count),
            before: vec![0; count],
            after: vec![0; count],
        };
        for range in visits.walk_start.windows(2) {
            for v in range[0]..range[1] {
                let after = if v + 1 == range[1] { range[0] } else { v + 1 };
                walk.after[v as usize] = after;
                walk.before[after as usize] = v;
            }
        }
        for v in 0..count {
            let [a, b] = [visits.nodes[v], visits.nodes[walk.after[v] as usize]];
            walk.length_m.push(distance(a, b));
            if border.rim_cell[v].is_none() {
                walk.segments.push([a, b]);
            }
        }
        walk
    }
}

/// How far from the walk its row lies where its nodes are `spacing_m` apart.
fn row_offset_m(spacing_m: f64, size_m: f64) -> f64 {
    (spacing_m * size_m)
        .sqrt()
        .clamp(0.5 * size_m, 1.5 * size_m)
}

/// The nodes that the angle at border visit `k` asks for.
fn propose(
    border: &StripBorder,
    walk: &WalkEdges,
    k: usize,
    size_m: f64,
    clearance: &Clearance,
    proposals: &mut Vec<Proposal>,
) {
    let at = border.visits.nodes[k];
    let after = border.visits.nodes[walk.after[k] as usize];
    let before = border.visits.nodes[walk.before[k] as usize];
    let toward = |p: Xy| (p[1] - at[1]).atan2(p[0] - at[0]);
    let start = toward(after);
    let mut angle = toward(before) - start;
    if angle <= 0.0 {
        angle += std::f64::consts::TAU;
    }
    let around_m = 0.5 * (walk.length_m[k] + walk.length_m[walk.before[k] as usize]);
    // Searches reach as far as this, so it must not follow a single very long edge.
    let spacing_m = around_m.min(4.0 * size_m);
    let offset_m = row_offset_m(spacing_m, size_m);
    let half = (0.5 * angle).sin();
    let (rank, fan): (Rank, &[(f64, f64)]) = match angle.to_degrees() {
        a if a < 60.0 => (Rank::Acute, &[(0.5, 1.6 * spacing_m * (0.5 * angle).cos())]),
        a if a < 120.0 => (Rank::End, &[(0.5, offset_m / half)]),
        a if a < 240.0 => (Rank::Row, &[(0.5, offset_m / half.max(0.8))]),
        a if a < 300.0 => (
            Rank::Row,
            &[
                (1.0 / 3.0, offset_m),
                (0.5, 1.414 * offset_m),
                (2.0 / 3.0, offset_m),
            ],
        ),
        _ => (
            Rank::Row,
            &[
                (0.25, offset_m),
                (0.375, 1.414 * offset_m),
                (0.5, offset_m),
                (0.625, 1.414 * offset_m),
                (0.75, offset_m),
            ],
        ),
    };
    for &(share, reach_m) in fan {
        let direction = start + share * angle;
        let place = [
            at[0] + reach_m * direction.cos(),
            at[1] + reach_m * direction.sin(),
        ];
        let least_m = match rank {
            Rank::Acute => 0.2 * spacing_m,
            _ => ROW_GAP * offset_m.min(size_m),
        };
        let Some(nearest) = clearance.nearest(place, 2.5 * size_m.max(spacing_m)) else {
            continue;
        };
        if nearest.inside && nearest.distance_m >= least_m {
            proposals.push(Proposal {
                rank,
                at: place,
                clear_m: nearest.distance_m,
                offset_m,
            });
        }
    }
}

/// True if `p` is not in the core, nor nearer to a node of it than `gap`, pitches.
fn is_clear_of_core(core: &Core, p: Xy, gap: f64) -> bool {
    let u = core.lattice.coordinates(p);
    if core.state(u) != cell::STRIP {
        // A place in an OUT cell may still be inside; it has no core node near unless on a seam.
        return core.state(u) == cell::OUT;
    }
    let (i, j) = (u[0] as usize, u[1] as usize);
    [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)]
        .into_iter()
        .all(|(i, j)| distance(u, [i as f64, j as f64]) >= gap || !core.is_core_node(i, j))
}

/// Adds the lattice nodes of the strip that have room, those farthest from the walks first.
fn fill(core: &Core, walk: &WalkEdges, clearance: &Clearance, row: &Spacing, nodes: &mut Vec<Xy>) {
    let size_m = core.lattice.pitch_m;
    let w = core.columns;
    for j in 1..core.rows {
        for i in 1..w {
            let at = j * w + i;
            let corner_cells = [at - w - 1, at - w, at - 1, at];
            if !corner_cells.iter().any(|&n| core.cells[n] == cell::STRIP)
                || corner_cells.iter().any(|&n| core.cells[n] >= cell::ZONE)
            {
                continue;
            }
            let place = core.lattice.place([i as f64, j as f64]);
            let room = clearance
                .nearest(place, 2.0 * size_m)
                .is_none_or(|nearest| {
                    let [a, b] = walk.segments[nearest.segment as usize];
                    let spacing_m = distance(a, b);
                    nearest.inside
                        && nearest.distance_m > FILL_GAP * row_offset_m(spacing_m, size_m)
                });
            if room && row.is_free(place, FILL_GAP * size_m) {
                nodes.push(place);
            }
        }
    }
}
