//! Cavities around a poor quad, filled again by the best plans of the catalogue: the rescue where
//! no single operation helps, as in a pocket between two lines.
//!
//! Cavities are the quad with one or two neighbours across its edges or all of them, and the quads
//! around one of its free nodes, or around two. Cost: about 1 ms a quad that cannot be helped, so
//! only the poorest are tried.

use crate::geometry::point::Xy;
use crate::meshing::catalogue;
use crate::meshing::edits::Edit;
use crate::meshing::kernel::Few;
use crate::meshing::kernel::Kernel;
use crate::meshing::kernel::quad_of;
use crate::meshing::kernel::turn_rad;
use crate::meshing::triangulate::NONE;

/// So many plans are tried a cavity; a third one costs half as much again and helps once in a city.
const PLANS: usize = 2;

/// What one quad too many or too few at a free node of the outline costs, radians^2: it can move,
/// but the mesh around it is as it is.
const VALENCE: f64 = 0.4;

/// Every refill of a cavity around `quad` that is worth trying.
pub(crate) fn refills(kernel: &Kernel, quad: u32) -> Vec<Edit> {
    let mut edits = Vec::new();
    for cavity in cavities(kernel, quad) {
        let Some(outline) = outline(kernel, &cavity) else {
            continue;
        };
        if !catalogue::lists(outline.len()) {
            continue;
        }
        let costs: Vec<_> = (0..outline.len())
            .map(|k| costs(kernel, &cavity, &outline, k))
            .collect();
        let at: Vec<Xy> = (outline.iter())
            .map(|&node| kernel.nodes[node as usize])
            .collect();
        let first = kernel.nodes.len() as u32;
        for plan in catalogue::best(&costs, PLANS) {
            let name = |k: u8| match outline.get(k as usize) {
                Some(&node) => node,
                None => first + u32::from(k) - outline.len() as u32,
            };
            edits.push(Edit {
                old: cavity.clone(),
                new: plan.quads.iter().map(|quad| quad.map(name)).collect(),
                born: plan.inner_nodes(&at).into_iter().collect(),
                moved: None,
            });
        }
    }
    edits
}

/// Sets of quads around `quad`, each once.
fn cavities(kernel: &Kernel, quad: u32) -> Vec<Few<u32>> {
    let across = |k: u32| {
        let twin = kernel.twin(4 * quad + k % 4);
        (twin != NONE).then(|| quad_of(twin))
    };
    let around = |k: u32| -> Few<u32> {
        let node = kernel.start(4 * quad + k % 4);
        if kernel.held[node as usize] {
            return Few::new();
        }
        (kernel.spokes(node).iter())
            .map(|&side| quad_of(side))
            .collect()
    };
    let mut sets: Vec<Few<u32>> = Vec::new();
    let mut add = |more: &[&[u32]]| {
        let mut set: Few<u32> = more.iter().flat_map(|it| it.iter().copied()).collect();
        set.push(quad);
        set.sort_unstable();
        set.dedup();
        if set.len() > 1 && !sets.contains(&set) {
            sets.push(set);
        }
    };
    for k in 0..4 {
        add(&[across(k).as_slice()]);
        add(&[across(k).as_slice(), across(k + 1).as_slice()]);
        add(&[&around(k)]);
        add(&[&around(k), &around(k + 1)]);
    }
    add(&[0, 1, 2, 3].map(across).each_ref().map(Option::as_slice));
    sets
}

/// The nodes around a cavity, counter-clockwise; `None` if it is not one simple loop.
fn outline(kernel: &Kernel, cavity: &[u32]) -> Option<Few<u32>> {
    let mut edges: Few<(u32, u32)> = Few::new();
    for side in cavity.iter().flat_map(|&quad| 4 * quad..4 * quad + 4) {
        let twin = kernel.twin(side);
        if twin == NONE || !cavity.contains(&quad_of(twin)) {
            edges.push((kernel.start(side), kernel.end(side)));
        }
    }
    let mut outline: Few<u32> = Few::new();
    let mut node = edges[0].0;
    for _ in 0..edges.len() {
        outline.push(node);
        let mut on = edges.iter().filter(|edge| edge.0 == node);
        let (next, second) = (on.next()?.1, on.next());
        if second.is_some() {
            return None;
        }
        node = next;
    }
    let closes = node == outline[0] && !outline[1..].contains(&outline[0]);
    closes.then_some(outline)
}

/// What 1, 2, ... quads of the refill cost at entry `k` of the outline.
fn costs(kernel: &Kernel, cavity: &[u32], outline: &[u32], k: usize) -> catalogue::Costs {
    let n = outline.len();
    let node = outline[k] as usize;
    let [at, next, previous] =
        [k, k + 1, k + n - 1].map(|entry| kernel.nodes[outline[entry % n] as usize]);
    let costs = catalogue::corner_costs(turn_rad(at, next, previous));
    if kernel.held[node] {
        return costs;
    }
    let inside = (cavity.iter())
        .filter(|&&quad| kernel.quads[quad as usize].contains(&outline[k]))
        .count();
    let outside = kernel.valence[node] as f64 - inside as f64;
    std::array::from_fn(|quads| {
        let valence = outside + (quads + 1) as f64;
        0.5 * costs[quads].min(2.0) + VALENCE * (valence - 4.0).powi(2)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::kernel::grid;

    #[test]
    fn every_refill_fits_its_cavity_and_can_be_undone() {
        for quad in 0..16 {
            let mut kernel = grid(4, 4);
            let edits = refills(&kernel, quad);
            assert!(!edits.is_empty());
            for edit in edits {
                let before = kernel.quads.clone();
                let valence = kernel.valence.clone();
                let old: Vec<[u32; 4]> = (edit.old.iter())
                    .map(|&quad| kernel.quads[quad as usize])
                    .collect();
                for &at in &edit.born {
                    kernel.add_node(at, NONE);
                }
                let slots = kernel.replace(&edit.old, &edit.new).expect("outlines fit");
                kernel.replace(&slots, &old).expect("and back");
                edit.born.iter().for_each(|_| kernel.drop_last_node());
                assert_eq!(kernel.valence, valence);
                let alive = |quads: &[[u32; 4]]| {
                    let mut alive = quads.to_vec();
                    alive.retain(|quad| quad[0] != NONE);
                    alive.sort_unstable();
                    alive
                };
                assert_eq!(alive(&kernel.quads), alive(&before));
            }
        }
    }
}
