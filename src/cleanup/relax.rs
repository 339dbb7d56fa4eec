//! Pushes nodes and edges apart, and nodes back to their lines, with frozen topology, until edges
//! and gaps have the length that the mesh wants, or the tolerance is used up.

use crate::cleanup::graph::Graph;
use crate::cleanup::importance::is_rim_corner;
use crate::cleanup::measure::NEAR;
use crate::cleanup::measure::ROUNDING_M;
use crate::cleanup::measure::distance;
use crate::cleanup::measure::to_segment;
use crate::cleanup::nearby::Nearby;
use crate::cleanup::operate::Shift;
use crate::cleanup::separate::gap_below_m;
use crate::cleanup::separate::is_beside;
use crate::cleanup::steps::Step;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;

/// What is wanted, in shares of the local mesh size.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// Least length of an edge.
    pub(super) edge: f64,
    /// Least distance of a node from an edge that is not its own.
    pub(super) gap: f64,
    /// How much of the tolerance may be used: if possible the first, else the second. A node that
    /// once needed the second keeps to it.
    pub(super) shares: [f64; 2],
    /// How often each node is looked at, at most.
    pub(super) rounds: u8,
}

/// Share of the wanted push that is made at once: neighbours push too.
const STEP: f64 = 0.6;
/// Pushes below this share of the mesh size are not made: smaller ones go on and on, and move no
/// figure of the mesh.
const STILL: f64 = 0.01;

/// So many rounds go by before what is near is looked up again,
const ROUNDS_A_LOOK: u8 = 3;
/// in which nodes seldom move by more than this, in mesh sizes. If one does, a push comes late.
const DRIFT: f64 = 0.1;

/// Moves `nodes`, and no others, one after the other, in rounds over those that are pushed.
pub(super) fn relax(graph: &mut Graph, wanted: &Wanted, nodes: &[u32]) {
    if !graph.measure.does(Step::Relax) {
        return;
    }
    let mut is_part = vec![false; graph.at.len()];
    for &node in nodes {
        is_part[node as usize] = graph.is_free(node);
    }
    let mut active = nodes.to_vec();
    let mut first_share = vec![0_u8; graph.at.len()];
    // the first round in which a node is not yet known to be looked at
    let mut asked = vec![0_u8; graph.at.len()];
    // where a node was last found near all its lines: as long as it is there, it still is
    let mut is_home: Vec<Option<Point>> = vec![None; graph.at.len()];
    let mut around = Vec::new();
    let mut nearby = Nearby::new(graph, wanted.gap + DRIFT);
    for round in 0..wanted.rounds {
        if round > 0 && round % ROUNDS_A_LOOK == 0 {
            nearby.forget();
        }
        let mut again = Vec::new();
        for &node in &active {
            if !is_part[node as usize] || stays(graph, wanted, node) {
                continue;
            }
            let mut push = push_m(graph, wanted, node, &mut nearby, &mut around);
            let at = graph.point(node);
            if is_home[node as usize] != Some(at) {
                match homeward_m(graph, node) {
                    Some(home) => push = [push[0] + home[0], push[1] + home[1]],
                    None => is_home[node as usize] = Some(at),
                }
            }
            let push = along_rim(graph, node, push);
            let size = graph.size_at_m(node);
            if distance(push, [0.0; 2]) <= STILL * size {
                continue;
            }
            let from = usize::from(first_share[node as usize]);
            if let Some(share) = pushed(graph, &wanted.shares[from..], node, push) {
                first_share[node as usize] = (from + share) as u8;
                let near = graph.neighbours(node);
                for it in near.iter().chain(&around).chain([&node]).copied() {
                    if asked[it as usize] <= round {
                        asked[it as usize] = round + 1;
                        again.push(it);
                    }
                }
            }
        }
        again.sort_unstable();
        active = again;
    }
}

/// Nodes farther than this from one of their lines are pulled back to it, in mesh sizes.
const FAR: f64 = 0.2;

/// Where the line that is farthest away pulls a node, metres; none if all are near.
fn homeward_m(graph: &Graph, node: u32) -> Option<Xy> {
    let at = graph.metres(node);
    let far = FAR * graph.size_at_m(node);
    let (mut away, mut way) = (far, [0.0; 2]);
    let (mut last, mut end_m, mut is_near) = (None, 0.0, true);
    for &edge in &graph.star[node as usize] {
        let it = &graph.edges[edge as usize];
        for piece in &graph.pieces[edge as usize] {
            let (here, there) = match it.ends[0] == node {
                true => (piece.from_m, piece.to_m),
                false => (piece.to_m, piece.from_m),
            };
            // no stretch is farther away than its end; mostly the next one starts there
            if last != Some((piece.line, here)) {
                last = Some((piece.line, here));
                end_m = distance(at, graph.measure.point(piece.line, here));
            }
            if end_m <= away {
                continue;
            }
            is_near = false;
            let (low, high) = (here.min(there), here.max(there));
            let (station, away_m) = (graph.measure).nearest(piece.line, low, high, at);
            if away_m + ROUNDING_M <= away {
                continue;
            }
            let place = graph.measure.point(piece.line, station);
            if distance(at, place) > away {
                away = distance(at, place);
                way = [place[0] - at[0], place[1] - at[1]];
            }
        }
    }
    (!is_near).then(|| way.map(|it| it * (1.0 - far / away)))
}

/// Corners of the outline stay, but at the ends of its short edges.
fn stays(graph: &Graph, wanted: &Wanted, node: u32) -> bool {
    let is_short = |&edge: &u32| {
        let it = &graph.edges[edge as usize];
        let (a, b) = graph.ends_m(edge);
        it.is_rim() && distance(a, b) < wanted.edge * it.size_m
    };
    is_rim_corner(graph, node) && !graph.star[node as usize].iter().any(is_short)
}

/// How much of the lines may come farther away than [`NEAR`] of their tolerance for a push, by its length: much for
/// what is very narrow, little for what nearly has room. (Measured on twelve cities: with no limit, as before, the
/// displacement that 99 % of the lines stay below is .005 of the size more, for no better cells, and clean-up takes
/// longer; with 3 it is .0015 less, but the .1 % quantile of the time-step proxy .8 % lower. A limit of half the size for
/// all pushes takes cells from the narrowest strips: towradgi-anuga .291 > .243.)
const FAR_FOR_PUSH: f64 = 5.0;

/// Tries the whole step, then a half and a quarter, with each share of the tolerance; returns which
/// share it took.
fn pushed(graph: &mut Graph, shares: &[f64], node: u32, push: Xy) -> Option<usize> {
    let at = graph.metres(node);
    let push_m = distance(push, [0.0; 2]);
    // what is in the way of a step still is with more of the tolerance
    let mut is_blocked = [false; 3];
    shares.iter().position(|&share| {
        // half of the tolerance is used freely
        let is_free = share <= NEAR;
        let most_m = match is_free {
            true => f64::INFINITY,
            false => graph.beyond_m(node).max(FAR_FOR_PUSH * push_m),
        };
        let steps = [STEP, STEP / 2.0, STEP / 4.0];
        steps.iter().zip(&mut is_blocked).any(|(step, is_blocked)| {
            if *is_blocked {
                return false;
            }
            let place = [at[0] + step * push[0], at[1] + step * push[1]];
            let p = graph.measure.on_grid(place);
            let shift = match is_free {
                true => graph.try_shift(node, p, share),
                false => graph.shift_near(node, p, share, most_m),
            };
            *is_blocked = shift == Shift::Blocked;
            shift == Shift::Done
        })
    })
}

/// Where a node is pushed by all that is too near, metres. Leaves the nodes in `around` that its
/// edges might push, or theirs it.
fn push_m(
    graph: &Graph,
    wanted: &Wanted,
    node: u32,
    nearby: &mut Nearby,
    around: &mut Vec<u32>,
) -> Xy {
    let at = graph.metres(node);
    let mut push = [0.0, 0.0];
    let mut add = |by: Xy, length: f64| {
        push[0] += by[0] * length;
        push[1] += by[1] * length;
    };
    for &edge in &graph.star[node as usize] {
        let it = &graph.edges[edge as usize];
        let end = graph.metres(it.other(node));
        let (length, wants) = (distance(at, end), wanted.edge * it.size_m);
        if length < wants {
            add(unit(end, at), 0.5 * (wants - length));
        }
    }
    let size = graph.size_at_m(node);
    around.clear();
    for &edge in nearby.edges(graph, node) {
        let wants = wanted.gap * graph.edges[edge as usize].size_m.min(size);
        if let Some((gap, t)) = gap_below_m(graph, node, edge, wants) {
            around.extend(graph.edges[edge as usize].ends);
            let (a, b) = graph.ends_m(edge);
            add(unit(between(a, b, t), at), 0.5 * (wants - gap));
        }
    }
    for &edge in &graph.star[node as usize] {
        let it = &graph.edges[edge as usize];
        let (far, reach) = (graph.metres(it.other(node)), wanted.gap * it.size_m);
        for &other in nearby.nodes(graph, edge) {
            let it = graph.metres(other);
            if !is_beside(it, at, far, reach) {
                continue;
            }
            around.push(other);
            let wants = reach.min(wanted.gap * graph.size_at_m(other));
            if let Some((gap, _)) = gap_below_m(graph, other, edge, wants) {
                let t = to_segment(it, at, far).1;
                add(
                    unit(it, between(at, far, t)),
                    0.5 * (1.0 - t) * (wants - gap),
                );
            }
        }
    }
    push
}

/// On the outline, only the part of a push along it.
pub(super) fn along_rim(graph: &Graph, node: u32, push: Xy) -> Xy {
    let star = graph.star[node as usize].iter();
    let rim: Vec<u32> = star
        .copied()
        .filter(|&e| graph.edges[e as usize].is_rim())
        .collect();
    let &[e, f] = rim.as_slice() else {
        return push;
    };
    if is_rim_corner(graph, node) {
        return push;
    }
    let [a, b] = [e, f].map(|edge| graph.metres(graph.edges[edge as usize].other(node)));
    let way = unit(a, b);
    let along = push[0] * way[0] + push[1] * way[1];
    [way[0] * along, way[1] * along]
}

fn between(a: Xy, b: Xy, t: f64) -> Xy {
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
}

/// The direction from `a` to `b`; none if they are equal.
fn unit(a: Xy, b: Xy) -> Xy {
    let length = distance(a, b);
    if length > 0.0 {
        [(b[0] - a[0]) / length, (b[1] - a[1]) / length]
    } else {
        [0.0, 0.0]
    }
}
