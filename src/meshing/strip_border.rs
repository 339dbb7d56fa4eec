//! The border of the strip: what of the walks is not covered by the core, and the core's rim.

use crate::geometry::point::Xy;
use crate::meshing::core_quads::CoreQuads;
use crate::meshing::core_quads::turn;
use crate::meshing::visits::Visits;

/// The strip's border as walks of its own, with the strip on their left.
#[derive(Clone, Debug)]
pub(crate) struct StripBorder {
    /// The border's walks. Its visits are numbered anew.
    pub visits: Visits,
    /// Border visit -> node of the draft (visits, then core nodes).
    pub node: Vec<u32>,
    /// Border visit -> true if the edges before and after it are both walk edges.
    pub on_walk: Vec<bool>,
    /// Border visit -> the map's cell at its edge if that is a rim edge.
    pub rim_cell: Vec<Option<u32>>,
}

/// An edge of the border, not yet chained.
#[derive(Clone, Copy)]
struct Edge {
    from: u32,
    to: u32,
    rim_cell: Option<u32>,
}

/// Chains walk edges and reversed rim edges to closed walks.
///
/// Where several edges leave one node (the core touches a seam in a corner), the walk goes on along
/// the first one clockwise from where it came, so that no other edge lies in the strip between.
pub(crate) fn chain(visits: &Visits, next: &[u32], core: &CoreQuads) -> Option<StripBorder> {
    let edges = border_edges(next, core);
    let place = |node: u32| {
        let own = (node as usize).checked_sub(visits.len());
        own.map_or_else(|| visits.nodes[node as usize], |k| core.nodes[k])
    };
    let first_unique = visits.unique.iter().max().map_or(0, |&last| last + 1);
    let mut border = StripBorder {
        visits: Visits {
            nodes: Vec::with_capacity(edges.len()),
            walk_start: vec![0],
            unique: Vec::with_capacity(edges.len()),
            on_seam: Vec::with_capacity(edges.len()),
            across_m: Vec::new(),
        },
        node: Vec::with_capacity(edges.len()),
        on_walk: Vec::with_capacity(edges.len()),
        rim_cell: Vec::with_capacity(edges.len()),
    };
    let mut used = vec![false; edges.len()];
    for start in 0..edges.len() {
        if used[start] {
            continue;
        }
        let (mut at, mut before) = (start, None);
        while !used[at] {
            used[at] = true;
            let edge = edges[at];
            let on_walk =
                edge.rim_cell.is_none() && before.is_none_or(|e: Edge| e.rim_cell.is_none());
            border.node.push(edge.from);
            border.visits.nodes.push(place(edge.from));
            border
                .visits
                .unique
                .push(match (edge.from as usize).checked_sub(visits.len()) {
                    None => visits.unique[edge.from as usize],
                    Some(k) => first_unique + k as u32,
                });
            border
                .visits
                .on_seam
                .push(edge.rim_cell.is_none() && visits.on_seam[edge.from as usize]);
            border.on_walk.push(on_walk);
            border.rim_cell.push(edge.rim_cell);
            before = Some(edge);
            at = following(&edges, edge, place)?;
        }
        if at != start {
            return None;
        }
        let first = *border.visits.walk_start.last().expect("never empty") as usize;
        border.on_walk[first] &= before.is_none_or(|edge| edge.rim_cell.is_none());
        border.visits.walk_start.push(border.node.len() as u32);
    }
    Some(border)
}

/// Walk edges that the core does not cover, then rim edges turned round; sorted by start.
fn border_edges(next: &[u32], core: &CoreQuads) -> Vec<Edge> {
    let open = |&v: &u32| !core.covered[v as usize];
    let on_walk = |v: u32| Edge {
        from: v,
        to: next[v as usize],
        rim_cell: None,
    };
    let mut edges: Vec<Edge> = (0..next.len() as u32).filter(open).map(on_walk).collect();
    edges.extend(core.rim.iter().map(|rim| Edge {
        from: rim.to,
        to: rim.from,
        rim_cell: Some(rim.beyond),
    }));
    edges.sort_unstable_by_key(|edge| (edge.from, edge.to));
    edges
}

/// The edge on which a walk along `edge` goes on.
fn following(edges: &[Edge], edge: Edge, place: impl Fn(u32) -> Xy) -> Option<usize> {
    let first = edges.partition_point(|other| other.from < edge.to);
    let count = edges[first..]
        .iter()
        .take_while(|other| other.from == edge.to)
        .count();
    let at = place(edge.to);
    let clockwise = |&k: &usize| match count {
        1 => 0.0,
        // A turn of zero is a way straight back: last resort.
        _ => match turn(at, place(edges[k].to), place(edge.from)) {
            0.0 => std::f64::consts::TAU,
            angle => angle,
        },
    };
    (first..first + count).min_by(|a, b| clockwise(a).total_cmp(&clockwise(b)))
}
