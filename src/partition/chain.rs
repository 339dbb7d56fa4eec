//! Edges -> curves: maximal chains between junctions.

use crate::domain::line::Domain;
use crate::noding::arrangement::Arrangement;
use crate::noding::rim::rim_side;
use crate::partition::star::HalfEdge;
use crate::partition::star::Stars;
use crate::partition::star::direction;
use crate::partition::star::head;
use crate::partition::subdomains::Curve;
use crate::partition::subdomains::HalfCurve;
use crate::partition::subdomains::OUTSIDE;

/// All curves, before their sides are known.
pub struct Chains {
    /// By their least edges; their sides are `OUTSIDE`.
    pub(super) curves: Vec<Curve>,
    /// For each half-edge, the half-curve that it begins, or `None` inside one.
    pub(super) begins: Vec<Option<HalfCurve>>,
}

/// The chains of an arrangement; they need nothing of its faces.
pub fn chains(domain: &Domain, arrangement: &Arrangement, corner_deg: f64) -> Chains {
    let curves = curves(domain, arrangement, corner_deg);
    let begins = beginnings(&curves, arrangement);
    Chains { curves, begins }
}

/// The least edge of a chain is run from its first node to its second; it contains the least node
/// of the chain, at which a closed chain without a junction begins.
fn curves(domain: &Domain, arrangement: &Arrangement, corner_deg: f64) -> Vec<Curve> {
    let stars = Stars::of_all(arrangement);
    let is_junction: Vec<bool> = (0..arrangement.points.len())
        .map(|node| is_junction(domain, arrangement, stars.of(node), corner_deg))
        .collect();
    let mut used = vec![false; arrangement.edges.len()];
    let mut curves = Vec::new();
    for edge in 0..arrangement.edges.len() as u32 {
        if used[edge as usize] {
            continue;
        }
        let onward = follow(arrangement, &stars, &is_junction, edge << 1);
        let is_closed =
            head(arrangement, onward[onward.len() - 1]) == arrangement.edges[edge as usize][0];
        let mut chain: Vec<HalfEdge> = Vec::new();
        if !is_closed {
            let back = follow(arrangement, &stars, &is_junction, edge << 1 | 1);
            chain.extend(back[1..].iter().rev().map(|half| half ^ 1));
        }
        chain.extend(onward);
        for half in &chain {
            used[(half >> 1) as usize] = true;
        }
        curves.push(curve(arrangement, &chain));
    }
    curves
}

fn curve(arrangement: &Arrangement, chain: &[HalfEdge]) -> Curve {
    let mut nodes = vec![head(arrangement, chain[0] ^ 1)];
    nodes.extend(chain.iter().map(|&half| head(arrangement, half)));
    Curve {
        nodes,
        edges: chain.iter().map(|half| half >> 1).collect(),
        left: OUTSIDE,
        right: OUTSIDE,
        is_seam: arrangement.pieces_of(chain[0] >> 1).is_empty(),
    }
}

/// The half-edges from `first` on to the next junction, or around to where it began.
fn follow(
    arrangement: &Arrangement,
    stars: &Stars,
    is_junction: &[bool],
    first: HalfEdge,
) -> Vec<HalfEdge> {
    let mut chain = vec![first];
    let mut half = first;
    loop {
        let node = head(arrangement, half) as usize;
        if is_junction[node] {
            return chain;
        }
        let star = stars.of(node);
        half = if star[0] == half ^ 1 {
            star[1]
        } else {
            star[0]
        };
        if half == first {
            return chain;
        }
        chain.push(half);
    }
}

/// True if the chain ends at the node with this star.
fn is_junction(
    domain: &Domain,
    arrangement: &Arrangement,
    star: &[HalfEdge],
    corner_deg: f64,
) -> bool {
    let &[g, h] = star else {
        return true;
    };
    let pieces = |half: HalfEdge| arrangement.pieces_of(half >> 1);
    if pieces(g).is_empty() && pieces(h).is_empty() {
        // A seam follows the lattice from node to node: each stretch has a count of its own.
        return true;
    }
    let lines = |half: HalfEdge| pieces(half).iter().map(|piece| piece.line);
    let is_rim = |half: HalfEdge| rim_side(domain, pieces(half)) != 0;
    // Pieces are sorted by line, and one line may run along an edge more than once.
    let same_lines = lines(g).all(|line| lines(h).any(|other| other == line))
        && lines(h).all(|line| lines(g).any(|other| other == line));
    !same_lines || is_rim(g) != is_rim(h) || turns_by_more_than(arrangement, g, h, corner_deg)
}

/// True if a way in by `g` reversed and out by `h` turns by more than `corner_deg`.
fn turns_by_more_than(
    arrangement: &Arrangement,
    g: HalfEdge,
    h: HalfEdge,
    corner_deg: f64,
) -> bool {
    let float = |(x, y): (i64, i64)| (x as f64, y as f64);
    let (ux, uy) = float(direction(arrangement, g ^ 1));
    let (vx, vy) = float(direction(arrangement, h));
    let turn_deg = (ux * vy - uy * vx).atan2(ux * vx + uy * vy).to_degrees();
    turn_deg.abs() > corner_deg
}

fn beginnings(curves: &[Curve], arrangement: &Arrangement) -> Vec<Option<HalfCurve>> {
    let mut begins = vec![None; 2 * arrangement.edges.len()];
    for (curve, at) in curves.iter().enumerate() {
        let last = at.edges.len() - 1;
        let is_against =
            |k: usize| u32::from(arrangement.edges[at.edges[k] as usize][0] != at.nodes[k]);
        let first = at.edges[0] << 1 | is_against(0);
        let final_reversed = at.edges[last] << 1 | (is_against(last) ^ 1);
        begins[first as usize] = Some((curve as HalfCurve) << 1);
        begins[final_reversed as usize] = Some((curve as HalfCurve) << 1 | 1);
    }
    begins
}
