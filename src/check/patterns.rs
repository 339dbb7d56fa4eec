//! Promise `patterns`: cost and patterns' price together, and the proof of how good they are.

use crate::check::verdict::Promise;
use crate::chunk::reader::Mesh;
use crate::chunk::views::FrameView;
use crate::chunk::views::PatternsView;
use crate::intervals::goals::Block;
use crate::intervals::goals::Goals;
use crate::parity::balance::Structure;
use crate::parity::check::recount;
use crate::parity::cuts::Cuts;
use crate::partition::subdomains::Curve;
use crate::partition::subdomains::Partition;
use crate::partition::subdomains::Subdomain;

pub(crate) fn check(mesh: &Mesh) -> Promise {
    let frame = mesh.frame();
    let mut promise = Promise::new("patterns");
    let (Some(given), Some(certificate)) = (&frame.patterns, &frame.certificate) else {
        promise.says("none wished for".into());
        return promise;
    };
    if let Some(block) = (0..given.block_subdomain.len()).find(|&it| !is_around(&frame, given, it))
    {
        promise.broken(None, || {
            format!("block {block} is not what its sub-domain's walk says")
        });
        return promise;
    }
    let (partition, goals) = network_of(&frame, given);
    let counts: Vec<u32> = (0..frame.curves())
        .map(|curve| frame.count(curve))
        .collect();
    let proof = Structure {
        worth: given.worth as f64 * certificate.cost_unit,
        multipliers: given.multiplier.to_vec(),
        cuts: Cuts {
            parent: given.set_parent.to_vec(),
            value2: given.set_dual2.to_vec(),
            set_of: given.set_of.to_vec(),
        },
        ..Structure::default()
    };
    match recount(&partition, &goals, &counts, &proof) {
        Err(what) => promise.broken(None, || what),
        Ok(found) => {
            if (found.price, found.bound) != (given.price, given.bound) || found.bound > found.total
            {
                promise.broken(None, || {
                    let (price, bound) = (given.price, given.bound);
                    format!("price {price} and bound {bound} are claimed, {found:?}")
                });
            }
            let gap =
                (found.total - found.bound) as f64 / (found.total - certificate.base).max(1) as f64;
            let claimed = given.solved.beside_bound(certificate.cost_unit);
            promise.says(format!(
                "{} of {} few-sided sub-domains fit a pattern; cost and price {}, bound {}{claimed}; gap {gap:.6}",
                found.mapped,
                goals.blocks.len(),
                found.total,
                found.bound
            ));
        }
    }
    promise
}

/// True if the sides of a block are the curves around its sub-domain, each once and without free
/// lines: of one walk in order, or by direction if there are four.
fn is_around(frame: &FrameView, given: &PatternsView, block: usize) -> bool {
    let subdomain = given.block_subdomain[block];
    let [first, end] = [0, 1].map(|k| frame.subdomain_start[subdomain as usize + k] as usize);
    let rows = frame.walk_start[first] as usize..frame.walk_start[end] as usize;
    let mut around: Vec<u32> = (frame.walk_halves[rows].iter())
        .map(|half| half >> 1)
        .filter(|&curve| frame.left[curve as usize] != frame.right[curve as usize])
        .collect();
    let sides = given.block_start[block] as usize..given.block_start[block + 1] as usize;
    let (from, to) = (given.side_start[sides.start], given.side_start[sides.end]);
    let mut curves = given.side_curves[from as usize..to as usize].to_vec();
    if sides.len() == 4 {
        around.sort_unstable();
        curves.sort_unstable();
    } else if let Some(by) =
        (curves.first()).and_then(|first| around.iter().position(|it| it == first))
    {
        around.rotate_left(by);
    }
    around == curves
}

/// What parity sees of the mesh; `None` if no patterns were wished for.
pub fn network(mesh: &Mesh) -> Option<(Partition, Goals)> {
    let frame = mesh.frame();
    (frame.patterns.as_ref()).map(|given| network_of(&frame, given))
}

fn network_of(frame: &FrameView, given: &PatternsView) -> (Partition, Goals) {
    let curve = |id: usize| Curve {
        nodes: Vec::new(),
        edges: Vec::new(),
        left: frame.left[id],
        right: frame.right[id],
        is_seam: false,
    };
    let partition = Partition {
        curves: (0..frame.curves()).map(curve).collect(),
        subdomains: vec![Subdomain::default(); frame.subdomains()],
    };
    let side = |k: u32| {
        let rows = given.side_start[k as usize] as usize..given.side_start[k as usize + 1] as usize;
        given.side_curves[rows].to_vec()
    };
    let blocks = (0..given.block_subdomain.len())
        .map(|k| Block {
            subdomain: given.block_subdomain[k],
            sides: (given.block_start[k]..given.block_start[k + 1])
                .map(side)
                .collect(),
        })
        .collect();
    let goals = Goals {
        goal: frame.goal.to_vec(),
        lower: frame.lower.to_vec(),
        upper: frame.upper.to_vec(),
        weight: frame.weight.to_vec(),
        blocks,
    };
    (partition, goals)
}
