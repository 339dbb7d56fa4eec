//! The operations of the clean-up: what each one takes out, puts in and does to valences.

use crate::geometry::point::Xy;
use crate::meshing::kernel::Few;
use crate::meshing::kernel::Kernel;
use crate::meshing::kernel::after;
use crate::meshing::kernel::before;
use crate::meshing::kernel::quad_of;
use crate::meshing::last_resort::best_ring;
use crate::meshing::triangulate::NONE;

/// A ring is the last operation tried: its true cost in valences (about 8) would rule it out.
const RING_COST: f32 = 2.0;

/// One possible change of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Operation {
    /// Two quads share the two edges at a node of valence 2: one quad.
    Doublet { node: u32 },
    /// The shared edge of two quads turns to another diagonal of their hexagon: by one place if
    /// `left`, by two otherwise.
    Swap { side: u32, left: bool },
    /// A quad shrinks to its diagonal through the neighbours of the start of `side`; that free node
    /// merges with the one opposite.
    Collapse { side: u32 },
    /// The `width` quads from `side` counter-clockwise leave the start of `side` for a new node;
    /// a new quad fills the gap.
    Split { side: u32, width: u32 },
    /// Four new nodes inside a quad, and five quads in its place: mends what nothing else does, at
    /// the price of four irregular nodes.
    Ring { quad: u32 },
    /// A quad whose corner after the start of `side` is flat on the outline and has no inner edge,
    /// with its two neighbours off the outline: three quads become six.
    Fill { side: u32 },
}

/// An operation spelt out.
pub(crate) struct Edit {
    pub old: Few<u32>,
    /// New nodes are numbered from `kernel.nodes.len()`, in the order of `born`.
    pub new: Few<[u32; 4]>,
    pub born: Few<Xy>,
    /// A node that is put elsewhere.
    pub moved: Option<(u32, Xy)>,
}

/// How much `count` quads at `node` are worth avoiding.
pub(crate) fn valence_cost(kernel: &Kernel, node: u32, count: i32) -> f32 {
    let ideal = kernel.ideal[node as usize];
    let square = (count as f32 - ideal).powi(2);
    if !kernel.held[node as usize] {
        square + if count < 3 { 12.0 } else { 0.0 }
    } else if count < 1 || ideal / count as f32 > 1.83 {
        // One corner would be wider than 165 degrees.
        square + 4.0
    } else if count > 1 && ideal / (count as f32) < 0.5 {
        // Corners would be sharper than 45 degrees for no need.
        square + 3.0
    } else {
        square
    }
}

/// Change of the valence cost if the counts of `nodes` change.
fn change(kernel: &Kernel, nodes: &[(u32, i32)]) -> f32 {
    let delta = |&(node, by): &(u32, i32)| {
        let count = kernel.valence[node as usize] as i32;
        valence_cost(kernel, node, count + by) - valence_cost(kernel, node, count)
    };
    nodes.iter().map(delta).sum()
}

/// All operations on quad `quad` (and [`Operation::Fill`] if `fills`) whose change of the valence
/// cost is below `limit`, best first.
pub(crate) fn candidates(
    kernel: &Kernel,
    quad: u32,
    limit: f32,
    fills: bool,
) -> Vec<(f32, Operation)> {
    let mut found = Vec::new();
    for side in 4 * quad..4 * quad + 4 {
        swaps(kernel, side, &mut found);
        collapse(kernel, side, &mut found);
        splits(kernel, kernel.start(side), &mut found);
        let node = kernel.start(side);
        if !kernel.held[node as usize] && kernel.valence[node as usize] == 2 {
            found.push((-20.0, Operation::Doublet { node }));
        }
        let flat = kernel.end(side) as usize;
        if fills && kernel.held[flat] && kernel.valence[flat] == 1 && kernel.ideal[flat] > 1.5 {
            found.push((1.0, Operation::Fill { side }));
        }
    }
    if fills {
        found.push((RING_COST, Operation::Ring { quad }));
    }
    found.retain(|&(delta, _)| delta < limit);
    // Equal deltas stay in the order found, which depends on slots alone.
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

fn swaps(kernel: &Kernel, side: u32, found: &mut Vec<(f32, Operation)>) {
    let twin = kernel.twin(side);
    if twin == NONE || quad_of(twin) == quad_of(side) {
        return;
    }
    let [u, v, a, b] = around(kernel, side);
    let [_, _, c, e] = around(kernel, twin);
    let left = change(kernel, &[(u, -1), (v, -1), (a, 1), (c, 1)]);
    let right = change(kernel, &[(u, -1), (v, -1), (b, 1), (e, 1)]);
    found.push((left, Operation::Swap { side, left: true }));
    found.push((right, Operation::Swap { side, left: false }));
}

fn collapse(kernel: &Kernel, side: u32, found: &mut Vec<(f32, Operation)>) {
    let [a, b, c, e] = around(kernel, side);
    // Of two free nodes either may go; ask once.
    if kernel.held[a as usize] || (!kernel.held[c as usize] && side & 2 != 0) {
        return;
    }
    let count = |node: u32| kernel.valence[node as usize] as i32;
    let merged = valence_cost(kernel, c, count(a) + count(c) - 2);
    let before = valence_cost(kernel, a, count(a)) + valence_cost(kernel, c, count(c));
    let delta = merged - before + change(kernel, &[(b, -1), (e, -1)]);
    found.push((delta, Operation::Collapse { side }));
}

fn splits(kernel: &Kernel, node: u32, found: &mut Vec<(f32, Operation)>) {
    let count = kernel.valence[node as usize];
    let held = kernel.held[node as usize];
    let ideal = kernel.ideal[node as usize];
    if count < if held { 3 } else { 5 } || (held && count as f32 <= ideal + 0.45) {
        return;
    }
    let spokes = kernel.spokes(node);
    let total = spokes.len();
    for first in usize::from(held)..total {
        for width in 2..total - 1 {
            // The edges on the outline stay with the node.
            if held && first + width >= total {
                break;
            }
            let last = spokes[(first + width - 1) % total];
            let x = kernel.end(spokes[first]);
            let y = kernel.start(before(last));
            let born = (width as f32 - 3.0).powi(2);
            let delta = change(kernel, &[(node, 1 - width as i32), (x, 1), (y, 1)]) + born;
            let side = spokes[first];
            found.push((
                delta,
                Operation::Split {
                    side,
                    width: width as u32,
                },
            ));
        }
    }
}

/// The corners of a quad, beginning with the start of `side`.
fn around(kernel: &Kernel, side: u32) -> [u32; 4] {
    let corners = kernel.quads[quad_of(side) as usize];
    std::array::from_fn(|k| corners[(side as usize + k) & 3])
}

/// Spells `operation` out; `None` if the place does not allow it.
pub(crate) fn edit(kernel: &Kernel, operation: Operation) -> Option<Edit> {
    match operation {
        Operation::Doublet { node } => doublet_edit(kernel, node),
        Operation::Swap { side, left } => Some(swap_edit(kernel, side, left)),
        Operation::Collapse { side } => Some(collapse_edit(kernel, side)),
        Operation::Split { side, width } => Some(split_edit(kernel, side, width)),
        Operation::Fill { side } => fill_edit(kernel, side),
        Operation::Ring { quad } => Some(ring_edit(kernel, quad)),
    }
}

fn doublet_edit(kernel: &Kernel, node: u32) -> Option<Edit> {
    let spokes = kernel.spokes(node);
    let (&one, &two) = (spokes.first()?, spokes.get(1)?);
    let [_, b, c, e] = around(kernel, one);
    let far = kernel.end(after(two));
    Some(Edit {
        old: [quad_of(one), quad_of(two)].into_iter().collect(),
        new: [[far, b, c, e]].into_iter().collect(),
        born: Few::new(),
        moved: None,
    })
}

fn swap_edit(kernel: &Kernel, side: u32, left: bool) -> Edit {
    let twin = kernel.twin(side);
    let [u, v, a, b] = around(kernel, side);
    let [_, _, c, e] = around(kernel, twin);
    let new = if left {
        [[a, b, u, c], [c, e, v, a]]
    } else {
        [[b, u, c, e], [e, v, a, b]]
    };
    Edit {
        old: [quad_of(side), quad_of(twin)].into_iter().collect(),
        new: new.into_iter().collect(),
        born: Few::new(),
        moved: None,
    }
}

fn collapse_edit(kernel: &Kernel, side: u32) -> Edit {
    let [a, _, c, _] = around(kernel, side);
    let old: Few<u32> = kernel.spokes(a).iter().map(|&side| quad_of(side)).collect();
    let others = old.iter().filter(|&&quad| quad != quad_of(side));
    let merge = |node: u32| if node == a { c } else { node };
    let new = others
        .map(|&quad| kernel.quads[quad as usize].map(merge))
        .collect();
    let halfway = middle(kernel, a, c);
    Edit {
        old,
        new,
        born: Few::new(),
        moved: (!kernel.held[c as usize]).then_some((c, halfway)),
    }
}

fn split_edit(kernel: &Kernel, side: u32, width: u32) -> Edit {
    let node = kernel.start(side);
    let born = kernel.nodes.len() as u32;
    let mut edit = Edit {
        old: Few::new(),
        new: Few::new(),
        born: Few::new(),
        moved: None,
    };
    let mut mean = [0.0; 2];
    let mut spoke = side;
    for k in 0..width {
        edit.old.push(quad_of(spoke));
        let corners = kernel.quads[quad_of(spoke) as usize];
        edit.new
            .push(corners.map(|corner| if corner == node { born } else { corner }));
        for corner in corners.into_iter().filter(|&corner| corner != node) {
            mean[0] += kernel.nodes[corner as usize][0] / (3 * width) as f64;
            mean[1] += kernel.nodes[corner as usize][1] / (3 * width) as f64;
        }
        if k + 1 < width {
            spoke = kernel.twin(before(spoke));
        }
    }
    edit.new
        .push([node, kernel.end(side), born, kernel.start(before(spoke))]);
    let at = kernel.nodes[node as usize];
    edit.born.push([
        at[0] + 0.35 * (mean[0] - at[0]),
        at[1] + 0.35 * (mean[1] - at[1]),
    ]);
    edit
}

fn fill_edit(kernel: &Kernel, side: u32) -> Option<Edit> {
    let [u, v, w, i] = around(kernel, side);
    let left = kernel.twin(before(side));
    let right = kernel.twin(after(after(side)));
    if left == NONE || right == NONE || quad_of(left) == quad_of(right) {
        return None;
    }
    let [_, _, z, t] = around(kernel, left);
    let [_, _, x, y] = around(kernel, right);
    let a = kernel.nodes.len() as u32;
    let (b, c) = (a + 1, a + 2);
    Some(Edit {
        old: [side, left, right].map(quad_of).into_iter().collect(),
        new: [
            [t, u, a, z],
            [u, v, b, a],
            [v, w, c, b],
            [w, x, y, c],
            [z, a, b, i],
            [b, c, y, i],
        ]
        .into_iter()
        .collect(),
        born: [(u, z), (v, i), (w, y)]
            .map(|(p, q)| middle(kernel, p, q))
            .into_iter()
            .collect(),
        moved: None,
    })
}

fn ring_edit(kernel: &Kernel, quad: u32) -> Edit {
    let outer = kernel.quads[quad as usize];
    let first = kernel.nodes.len() as u32;
    let side = |i: u32| {
        let next = (i + 1) % 4;
        [
            outer[i as usize],
            outer[next as usize],
            first + next,
            first + i,
        ]
    };
    let mut new: Few<[u32; 4]> = (0..4).map(side).collect();
    new.push(std::array::from_fn(|i| first + i as u32));
    Edit {
        old: [quad].into_iter().collect(),
        new,
        born: best_ring(&kernel.corners(quad)).into_iter().collect(),
        moved: None,
    }
}

fn middle(kernel: &Kernel, p: u32, q: u32) -> Xy {
    let (p, q) = (kernel.nodes[p as usize], kernel.nodes[q as usize]);
    [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]
}
