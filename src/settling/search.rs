//! Moves the nodes at poor quads, by compass search.

use crate::cleanup::shifts::Limits;
use crate::cleanup::shifts::Shifts;
use crate::geometry::point::COMPASS;
use crate::geometry::point::Xy;
use crate::settling::rings::Rings;

/// How far a node may go in one round, sizes. (Measured on six cities: with .35 nothing gains.)
pub const REACH: f64 = 0.2;

/// A quad of less worth is poor. (Measured on twelve cities: with the .75 of `meshing`, which has many more quads to
/// look at, the mean shape is .0024 lower and irregular nodes are .18 % more, and the displacement that 99 % of the
/// lines stay below is .002 of the size less; .97 gains nothing.)
const POOR: f64 = 0.92;

/// What is poorer than this may take lines farther away than half of their tolerance, as long as no more than 1 % of
/// all lines are. (Measured on twelve cities, of which eight have so much to spare: the .1 % quantile of the time-step
/// proxy grows by .9 %, that of edges by .7 %, the 1 % quantile of shapes by .005, and the displacement that 99 % of the
/// lines stay below by .002 of the size. With .5 half of the gain in edges is gone, and all of that in shapes; with .8
/// the last two grow by .002 more, and the first two do not.)
const VERY_POOR: f64 = 0.7;

/// How much of the lines may come farther away for one step, sizes.
const FAR: f64 = 0.5;

/// Sweeps over the nodes of quads that are still poor.
const SWEEPS: usize = 8;

/// First step of a search, sizes, and how many steps there are, the shorter ones included.
const STEP: f64 = 0.1;
const STEPS: usize = 5;

/// A step gains so much worth, or it is not made.
const GAIN: f64 = 1e-3;

/// Moves nodes of the line work and the rings with them; returns which ones moved. `min_edge`: the least edge that is
/// asked for, sizes.
///
/// Nodes come in the order of their ids, in sweeps over those around poor quads. O(poor quads).
pub(super) fn search(rings: &mut Rings, shifts: &mut Shifts, min_edge: f64) -> Vec<bool> {
    let mut moved = vec![false; rings.way.len()];
    let mut doubtful: Vec<u32> = (0..rings.len()).collect();
    // when a ring last changed, and when a node was last tried: where nothing has changed since, it would fail again
    let mut changed = vec![1_u32; rings.len() as usize];
    let mut tried = vec![0_u32; rings.way.len()];
    let mut now = 1;
    let mut spare_m = shifts.spare_m();
    for _ in 0..SWEEPS {
        doubtful.retain(|&ring| rings.worth(ring) < POOR);
        let nodes = doubtful.iter().flat_map(|&ring| rings.nodes_of(ring));
        let mut nodes: Vec<u32> = nodes.filter(|&node| shifts.may_move(node)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut any = false;
        for node in nodes {
            let mut around = rings.at(node).iter();
            if !around.any(|&ring| changed[ring as usize] > tried[node as usize]) {
                continue;
            }
            tried[node as usize] = now;
            now += 1;
            if improve(rings, node, shifts, min_edge, &mut spare_m) {
                let around = rings.at(node);
                around.iter().for_each(|&ring| changed[ring as usize] = now);
                doubtful.extend(around);
                moved[node as usize] = true;
                any = true;
            }
        }
        if !any {
            break;
        }
        doubtful.sort_unstable();
        doubtful.dedup();
    }
    moved
}

/// Searches a better least worth around one node; true if it moved. `spare_m`: how much more of the lines may come
/// farther away than half of their tolerance.
fn improve(
    rings: &mut Rings,
    node: u32,
    shifts: &mut Shifts,
    min_edge: f64,
    spare_m: &mut f64,
) -> bool {
    let size_m = rings.size_m(node);
    let least_edge = rings.shortest_on_lines(node).min(min_edge);
    let mut step_m = STEP * size_m;
    let mut has_moved = false;
    for _ in 0..STEPS {
        let way = rings.way[node as usize];
        let (worth, poorest) = rings.poorest_at(node);
        let mut found: Vec<(f64, Xy)> = Vec::new();
        for [x, y] in COMPASS {
            let by = shifts.open_to(node, [step_m * x, step_m * y]);
            let to = [way[0] + by[0], way[1] + by[1]];
            if to[0].hypot(to[1]) > REACH * size_m {
                continue;
            }
            rings.way[node as usize] = to;
            let value = rings.least(node, poorest, worth + GAIN);
            if value >= worth + GAIN && rings.shortest_on_lines(node) >= least_edge {
                found.push((value, by));
            }
        }
        rings.way[node as usize] = way;
        // equal ones in the order of the compass
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut went = go(shifts, node, &found);
        let more_m = spare_m.min(FAR * size_m);
        if went.is_none() && worth < VERY_POOR && more_m > 0.0 {
            went = go_far(shifts, node, &found, more_m, spare_m);
        }
        match went {
            Some(by) => {
                rings.way[node as usize] = [way[0] + by[0], way[1] + by[1]];
                has_moved = true;
            }
            None => step_m *= 0.5,
        }
    }
    has_moved
}

/// Moves a node the first of these ways, each in metres, that clean-up allows.
fn go(shifts: &mut Shifts, node: u32, ways: &[(f64, Xy)]) -> Option<Xy> {
    if ways.is_empty() {
        return None;
    }
    let limits = shifts.limits(node);
    first_open(shifts, node, ways, &limits)
}

/// The same at the cost of `spare_m`, of which it may take `more_m`.
fn go_far(
    shifts: &mut Shifts,
    node: u32,
    ways: &[(f64, Xy)],
    more_m: f64,
    spare_m: &mut f64,
) -> Option<Xy> {
    let before_m = shifts.beyond_m(node);
    let limits = shifts.wide_limits(node, more_m);
    let by = first_open(shifts, node, ways, &limits)?;
    *spare_m -= shifts.beyond_m(node) - before_m;
    Some(by)
}

fn first_open(shifts: &mut Shifts, node: u32, ways: &[(f64, Xy)], limits: &Limits) -> Option<Xy> {
    let mut ways = ways.iter().map(|it| it.1);
    ways.find(|&by| shifts.shift(node, by, limits))
}
