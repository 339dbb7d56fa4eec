//! Moves the free nodes of few quads by compass search, one after the other, without regard to derivatives: what
//! `lift` and `level` raise has none.

use crate::geometry::point::COMPASS;
use crate::geometry::point::Xy;
use crate::meshing::kernel::Few;
use crate::meshing::kernel::Kernel;
use crate::meshing::kernel::quad_of;
use crate::meshing::ring::Ring;
use crate::meshing::triangulate::NONE;

/// Sweeps over the quads that are still to be mended.
const SWEEPS: usize = 8;

/// Steps of one search.
const STEPS: usize = 6;

/// A search that has gained less is not worth another sweep.
const GAIN: f64 = 1e-3;

/// Sweeps over the free nodes of all quads that are `poor`, in the order of their numbers, and of what
/// becomes so, while a search still gains. A search may look at the quads of its node and at their neighbours.
pub(crate) fn mend(
    kernel: &mut Kernel,
    poor: impl Fn(&Kernel, u32) -> bool,
    search: impl Fn(&mut Kernel, u32) -> f64,
) {
    let mut doubtful: Vec<u32> = (0..kernel.quads.len() as u32).collect();
    // when a corner of a quad last moved, and when a search last left its node where it was: it would again
    let mut changed = vec![1_u32; kernel.quads.len()];
    let mut failed = vec![0_u32; kernel.nodes.len()];
    let mut now = 1;
    for _ in 0..SWEEPS {
        doubtful.retain(|&quad| kernel.lives(quad) && poor(kernel, quad));
        let mut nodes: Vec<u32> = doubtful
            .iter()
            .flat_map(|&quad| kernel.quads[quad as usize])
            .collect();
        nodes.retain(|&node| !kernel.held[node as usize]);
        nodes.sort_unstable();
        nodes.dedup();
        let mut any = false;
        for node in nodes {
            let quads: Few<u32> = (kernel.spokes(node).iter().map(|&side| quad_of(side))).collect();
            if !has_changed(kernel, &quads, &changed, failed[node as usize]) {
                continue;
            }
            let start = kernel.nodes[node as usize];
            any |= search(kernel, node) > GAIN;
            if kernel.nodes[node as usize] == start {
                failed[node as usize] = now;
            } else {
                now += 1;
                quads.iter().for_each(|&quad| changed[quad as usize] = now);
                doubtful.extend(quads);
            }
        }
        if !any {
            break;
        }
        doubtful.sort_unstable();
        doubtful.dedup();
    }
}

/// True if one of these quads or of their neighbours has changed since.
fn has_changed(kernel: &Kernel, quads: &[u32], changed: &[u32], since: u32) -> bool {
    quads.iter().any(|&quad| {
        let beside = kernel.twins[quad as usize]
            .iter()
            .filter(|&&twin| twin != NONE);
        let mut all = beside.map(|&twin| quad_of(twin)).chain([quad]);
        all.any(|it| changed[it as usize] > since)
    })
}

/// A node may not come nearer to a neighbour than this share of the wished edge length to mend a
/// quad: shape alone would let two nodes fall together.
const APART: f64 = 0.18;

/// Searches a place for the node of a ring where `better`, given the best value until now, finds a better one; returns
/// the best and its place.
pub(crate) fn compass(
    ring: &Ring,
    start: f64,
    better: impl Fn(Xy, f64) -> Option<f64>,
) -> (f64, Xy) {
    let (mut best, mut at) = (start, ring.at);
    let shortest_m = ring.shortest_m(at);
    let mut step_m = 0.3 * shortest_m;
    let floor_m = shortest_m.min(APART / ring.per_m);
    for _ in 0..STEPS {
        let mut to = at;
        for [x, y] in COMPASS {
            let place = [at[0] + step_m * x, at[1] + step_m * y];
            let value = better(place, best).filter(|_| ring.shortest_m(place) >= floor_m);
            if let Some(value) = value {
                (best, to) = (value, place);
            }
        }
        if to == at {
            step_m *= 0.4;
        }
        at = to;
    }
    (best, at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::kernel::shaken;
    use crate::meshing::level::evenness;
    use crate::meshing::ring::Beside;
    use proptest::prelude::*;

    /// The same, each node of a doubtful quad searched in each sweep.
    fn mend_all(
        kernel: &mut Kernel,
        poor: impl Fn(&Kernel, u32) -> bool,
        search: impl Fn(&mut Kernel, u32) -> f64,
    ) {
        let mut is_doubtful = vec![true; kernel.quads.len()];
        for _ in 0..SWEEPS {
            for quad in 0..kernel.quads.len() {
                is_doubtful[quad] &= poor(kernel, quad as u32);
            }
            let quads = (0..kernel.quads.len()).filter(|&quad| is_doubtful[quad]);
            let all: Vec<u32> = quads.flat_map(|quad| kernel.quads[quad]).collect();
            let mut any = false;
            for node in 0..kernel.nodes.len() as u32 {
                if kernel.held[node as usize] || !all.contains(&node) {
                    continue;
                }
                let start = kernel.nodes[node as usize];
                any |= search(kernel, node) > GAIN;
                if kernel.nodes[node as usize] != start {
                    let around = kernel.spokes(node);
                    around
                        .iter()
                        .for_each(|&it| is_doubtful[quad_of(it) as usize] = true);
                }
            }
            if !any {
                break;
            }
        }
    }

    proptest! {
        #[test]
        fn what_failed_is_not_tried_again_in_vain(
            moves in proptest::collection::vec(prop::array::uniform2(-1.0_f64..1.0), 12),
            by in 0.0_f64..0.45,
        ) {
            let poor = |kernel: &Kernel, quad| evenness(kernel, quad) < 0.8;
            let search = |kernel: &mut Kernel, node: u32| {
                let ring = Ring::of(kernel, node, 1.0);
                let beside = Beside::of(kernel, &ring, false);
                let start = beside.least(&ring, ring.at);
                let better = |place: Xy, best: f64| {
                    Some(beside.least(&ring, place)).filter(|&it| it > best)
                };
                let (best, place) = compass(&ring, start, better);
                kernel.nodes[node as usize] = place;
                best - start
            };
            let (mut one, mut other) = (shaken(&moves, by), shaken(&moves, by));
            mend(&mut one, poor, search);
            mend_all(&mut other, poor, search);
            prop_assert_eq!(one.nodes, other.nodes);
        }
    }
}
