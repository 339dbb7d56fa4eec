//! The last resort where it is needed and nowhere else: bad quads and what is around them are taken
//! out, and the hole is filled by the method that cannot fail.
//!
//! One impossible corner must not cost a sub-domain its lattice. The hole around a bad quad is
//! widened ring by ring until its outline is planar (close to a bad quad it may not be) and its
//! filling better than what was there. The number of edges of an outline of quads is even, so the
//! filling always exists.

use crate::geometry::quad::distance;
use crate::geometry::quad::scaled_jacobian;
use crate::meshing::draft::Draft;
use crate::meshing::last_resort;
use crate::meshing::pairing;
use crate::meshing::scatter::scatter;
use crate::meshing::triangulate::NONE;
use crate::meshing::triangulate::Triangles;
use crate::meshing::triangulate::triangulate;
use crate::meshing::visits::Visits;
use rustc_hash::FxHashMap;

/// Quads below this scaled Jacobian, or with a side below this share of the size, are taken out: at
/// .02 a corner is sharper than 1.2 degrees or as near to flat, and a time step is lost.
const BAD: f64 = 0.02;

/// Widest hole, rings of quads around the bad one.
const RINGS_MAX: usize = 5;

/// Rounds: a filling may leave a bad quad at its own rim, in thin places.
const ROUNDS: usize = 3;

/// Replaces bad quads of `draft` and their surroundings; returns how many quads of the
/// result were put in.
pub(crate) fn refill(draft: &mut Draft, visits: &Visits, size_m: f64) -> usize {
    let mut filled = 0;
    for _ in 0..ROUNDS {
        let bad = bad_quads(draft, size_m);
        if bad.is_empty() {
            break;
        }
        let around = Around::of(draft);
        let mut taken = vec![false; draft.quads.len()];
        let mut fillings: Vec<Vec<[u32; 4]>> = Vec::new();
        for quad in bad {
            if taken[quad as usize] {
                continue;
            }
            for rings in 1..=RINGS_MAX {
                let hole = around.hole(draft, quad, rings);
                if hole.iter().any(|&it| taken[it as usize]) {
                    break;
                }
                if let Some(filling) = fill(draft, visits, &hole, size_m) {
                    hole.iter().for_each(|&it| taken[it as usize] = true);
                    fillings.push(filling);
                    break;
                }
            }
        }
        if fillings.is_empty() {
            break;
        }
        // What an earlier round put in are the last quads.
        let earlier = &taken[taken.len() - filled..];
        filled -= earlier.iter().filter(|&&it| it).count();
        filled += fillings.iter().map(Vec::len).sum::<usize>();
        replace(draft, &taken, fillings);
    }
    filled
}

/// The scaled Jacobian, or the shortest side over the size if that is less.
fn quality(draft: &Draft, quad: [u32; 4], size_m: f64) -> f64 {
    let corners = quad.map(|node| draft.nodes[node as usize]);
    let sides = (0..4).map(|k| distance(corners[k], corners[(k + 1) % 4]) / size_m);
    sides.fold(scaled_jacobian(&corners), f64::min)
}

fn bad_quads(draft: &Draft, size_m: f64) -> Vec<u32> {
    // Settled quads are perfect.
    (draft.settled as u32..draft.quads.len() as u32)
        .filter(|&quad| quality(draft, draft.quads[quad as usize], size_m) < BAD)
        .collect()
}

fn replace(draft: &mut Draft, taken: &[bool], fillings: Vec<Vec<[u32; 4]>>) {
    draft.settled -= taken[..draft.settled].iter().filter(|&&it| it).count();
    let mut quad = 0;
    draft.quads.retain(|_| {
        quad += 1;
        !taken[quad - 1]
    });
    draft.quads.extend(fillings.into_iter().flatten());
}

/// Quads around each node.
struct Around {
    start: Vec<u32>,
    quads: Vec<u32>,
}

impl Around {
    fn of(draft: &Draft) -> Around {
        let mut start = vec![0; draft.nodes.len() + 1];
        for &node in draft.quads.iter().flatten() {
            start[node as usize + 1] += 1;
        }
        for node in 0..draft.nodes.len() {
            start[node + 1] += start[node];
        }
        let mut fill = start.clone();
        let mut quads = vec![0; 4 * draft.quads.len()];
        for (quad, nodes) in draft.quads.iter().enumerate() {
            for &node in nodes {
                quads[fill[node as usize] as usize] = quad as u32;
                fill[node as usize] += 1;
            }
        }
        Around { start, quads }
    }

    /// The quads within `rings` rings of `quad`, sorted.
    fn hole(&self, draft: &Draft, quad: u32, rings: usize) -> Vec<u32> {
        let mut hole = vec![quad];
        for _ in 0..rings {
            let nodes: Vec<u32> = (hole.iter())
                .flat_map(|&it| draft.quads[it as usize])
                .collect();
            for node in nodes {
                let range = self.start[node as usize]..self.start[node as usize + 1];
                hole.extend(&self.quads[range.start as usize..range.end as usize]);
            }
            hole.sort_unstable();
            hole.dedup();
        }
        hole
    }
}

/// A filling of `hole` whose worst quad is better than the hole's; new nodes are added to `draft`.
fn fill(draft: &mut Draft, visits: &Visits, hole: &[u32], size_m: f64) -> Option<Vec<[u32; 4]>> {
    let worst = (hole.iter())
        .map(|&quad| quality(draft, draft.quads[quad as usize], size_m))
        .fold(f64::INFINITY, f64::min);
    let (outline, names) = outline(draft, visits, hole)?;
    let scattered = scatter(&outline, size_m);
    let mut best: Option<(f64, Draft)> = None;
    for inner in [&[][..], &scattered[..]] {
        let Some(triangles) = triangulate(&outline, inner).filter(can_be_paired) else {
            continue;
        };
        let made = last_resort::mesh(&pairing::join(&triangles, outline.len()));
        let least = (made.quads.iter())
            .map(|&quad| quality(&made, quad, size_m))
            .fold(f64::INFINITY, f64::min);
        if least > worst.max(0.0) && best.as_ref().is_none_or(|it| least > it.0) {
            best = Some((least, made));
        }
    }
    let (_, made) = best?;
    let first = draft.nodes.len() as u32;
    let name = |node: u32| match names.get(node as usize) {
        Some(&known) => known,
        None => first + node - names.len() as u32,
    };
    let quads = made.quads.iter().map(|quad| quad.map(name)).collect();
    draft.nodes.extend(&made.nodes[names.len()..]);
    Some(quads)
}

/// True if there is an even number of triangles, and one can go from any to any other: two parts that
/// meet in a node may be odd each.
fn can_be_paired(triangles: &Triangles) -> bool {
    triangles.corners.len().is_multiple_of(2) && is_connected(triangles)
}

fn is_connected(triangles: &Triangles) -> bool {
    let mut seen = vec![false; triangles.neighbours.len()];
    let mut open = vec![0_u32];
    let mut count = 0;
    while let Some(triangle) = open.pop() {
        let Some(seen) = seen.get_mut(triangle as usize) else {
            continue;
        };
        if !std::mem::replace(seen, true) {
            count += 1;
            let around = triangles.neighbours[triangle as usize];
            open.extend(around.iter().filter(|&&it| it != NONE));
        }
    }
    count == triangles.neighbours.len()
}

/// The outline of `hole` as walks with the hole on the left, and the node of the draft at each
/// visit.
fn outline(draft: &Draft, visits: &Visits, hole: &[u32]) -> Option<(Visits, Vec<u32>)> {
    let mut sides: FxHashMap<(u32, u32), (u32, usize)> = FxHashMap::default();
    for &quad in hole {
        let nodes = draft.quads[quad as usize];
        for k in 0..4 {
            sides.insert((nodes[k], nodes[(k + 1) % 4]), (quad, k));
        }
    }
    let rim: Vec<(u32, u32)> = (hole.iter())
        .flat_map(|&quad| (0..4).map(move |k| (quad, k)))
        .map(|(quad, k)| {
            let nodes = draft.quads[quad as usize];
            (nodes[k], nodes[(k + 1) % 4])
        })
        .filter(|&(a, b)| !sides.contains_key(&(b, a)))
        .collect();
    let mut walked: FxHashMap<(u32, u32), bool> = rim.iter().map(|&it| (it, false)).collect();
    let (mut names, mut walk_start) = (Vec::new(), vec![0]);
    for &begin in &rim {
        let mut side = begin;
        while !std::mem::replace(walked.get_mut(&side)?, true) {
            names.push(side.0);
            side = next_on_rim(draft, &sides, side)?;
        }
        if names.len() as u32 > walk_start[walk_start.len() - 1] {
            walk_start.push(names.len() as u32);
        }
    }
    let nodes = names
        .iter()
        .map(|&node| draft.nodes[node as usize])
        .collect();
    // Two visits of one place are one place here too: the two sides of a slit.
    let place = |node: u32| match visits.unique.get(node as usize) {
        Some(&unique) => (0, unique),
        None => (1, node),
    };
    let mut places: Vec<(u32, u32)> = names.iter().map(|&node| place(node)).collect();
    places.sort_unstable();
    places.dedup();
    let unique = (names.iter())
        .map(|&node| places.partition_point(|&it| it < place(node)) as u32)
        .collect();
    let on_seam = vec![false; names.len()];
    let outline = Visits {
        nodes,
        walk_start,
        unique,
        on_seam,
        across_m: Vec::new(),
    };
    Some((outline, names))
}

/// The rim side after `side`: around its end, through the quads of the hole.
fn next_on_rim(
    draft: &Draft,
    sides: &FxHashMap<(u32, u32), (u32, usize)>,
    side: (u32, u32),
) -> Option<(u32, u32)> {
    let mut at = *sides.get(&side)?;
    // No node of a sound draft has more quads than this.
    for _ in 0..1000 {
        let nodes = draft.quads[at.0 as usize];
        let k = (at.1 + 1) % 4;
        let leaving = (nodes[k], nodes[(k + 1) % 4]);
        match sides.get(&(leaving.1, leaving.0)) {
            None => return Some(leaving),
            Some(&beyond) => at = beyond,
        }
    }
    None
}
