//! Holes and free lines joined to the outer walk by bridges: many walks become one loop.
//!
//! A bridge is a line of edges that the loop walks on both sides, so it adds an even number of
//! entries and parity is never touched. Its nodes are interior ones, and smoothing moves them.

use std::f64::consts::PI;

use crate::geometry::quad::distance;
use crate::meshing::contour::Contour;
use crate::meshing::sheet::Sheet;
use crate::meshing::splitting;
use crate::meshing::visits::Visits;

/// What a radian of angle error costs, in lengths of a bridge over spacing.
const ANGLE_COST: f64 = 1.0;
/// Bridges that are compared with their angles, the shortest over spacing.
const SHORTEST: usize = 200;

/// A possible bridge.
struct Bridge {
    cost: f64,
    /// Entry of the loop.
    from: usize,
    /// Inner walk.
    walk: usize,
    /// Entry of that walk.
    to: usize,
}

/// One loop through all walks; `None` if some walk cannot be seen from the rest.
pub(crate) fn merge(sheet: &mut Sheet, visits: &Visits, size_m: f64) -> Option<Vec<u32>> {
    let walk = |w: usize| (visits.walk_start[w]..visits.walk_start[w + 1]).collect::<Vec<u32>>();
    let mut merged = Contour::of(sheet, walk(0));
    let mut inner: Vec<Contour> = (1..visits.walk_start.len() - 1)
        .map(|w| Contour::of(sheet, walk(w)))
        .collect();
    while !inner.is_empty() {
        let bridge = nearest(&merged, &inner)?;
        let joined = inner.swap_remove(bridge.walk);
        let ids = join(sheet, &merged, &joined, &bridge, size_m);
        merged = Contour::of(sheet, ids);
    }
    Some(merged.ids)
}

/// The cheapest visible bridge from `merged` to one of the `inner` walks: among the shortest ones,
/// and only if none of those is visible among all.
fn nearest(merged: &Contour, inner: &[Contour]) -> Option<Bridge> {
    let mut pairs = pairs(merged, inner);
    if pairs.len() > SHORTEST {
        pairs.select_nth_unstable_by(SHORTEST, |p, q| {
            let order = p.cost.total_cmp(&q.cost);
            order.then((p.from, p.walk, p.to).cmp(&(q.from, q.walk, q.to)))
        });
        let rest = pairs.split_off(SHORTEST);
        let found = cheapest(merged, inner, pairs);
        return found.or_else(|| cheapest(merged, inner, rest));
    }
    cheapest(merged, inner, pairs)
}

/// All pairs of entries, their cost just the length over the spacing.
fn pairs(merged: &Contour, inner: &[Contour]) -> Vec<Bridge> {
    let mut pairs = Vec::new();
    for (walk, contour) in inner.iter().enumerate() {
        for from in 0..merged.len() {
            for to in 0..contour.len() {
                let (a, b) = (merged.at[from], contour.at[to]);
                let spacing_m = 0.5 * (merged.spacing_m[from] + contour.spacing_m[to]);
                let length2 = (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
                pairs.push(Bridge {
                    cost: length2.sqrt() / spacing_m,
                    from,
                    walk,
                    to,
                });
            }
        }
    }
    pairs
}

/// The cheapest visible one of `bridges`, with the angles at its ends.
fn cheapest(merged: &Contour, inner: &[Contour], mut bridges: Vec<Bridge>) -> Option<Bridge> {
    bridges.retain_mut(|bridge| {
        let angles = angle_error(merged, bridge.from, &inner[bridge.walk], bridge.to);
        bridge.cost += ANGLE_COST * angles.unwrap_or(0.0);
        angles.is_some()
    });
    bridges.sort_by(|p, q| {
        let order = p.cost.total_cmp(&q.cost);
        order.then((p.from, p.walk, p.to).cmp(&(q.from, q.walk, q.to)))
    });
    bridges.into_iter().find(|bridge| {
        let (a, b) = (merged.at[bridge.from], inner[bridge.walk].at[bridge.to]);
        let clear = |contour: &Contour| contour.clearance(a, b).is_some();
        clear(merged) && inner.iter().all(clear)
    })
}

/// Error of the angles at both ends, radians; `None` if the bridge does not leave into the area.
fn angle_error(merged: &Contour, from: usize, contour: &Contour, to: usize) -> Option<f64> {
    let (a, b) = (merged.at[from], contour.at[to]);
    if a == b {
        return None;
    }
    let direction = (b[1] - a[1]).atan2(b[0] - a[0]);
    let there = splitting::end_error(merged.opening(from, direction), merged.angle[from])?;
    let opening = contour.opening(to, direction + PI);
    Some(there + splitting::end_error(opening, contour.angle[to])?)
}

/// The loop that goes over the bridge, round the inner walk and back.
fn join(
    sheet: &mut Sheet,
    merged: &Contour,
    joined: &Contour,
    bridge: &Bridge,
    size_m: f64,
) -> Vec<u32> {
    let ends = [merged.ids[bridge.from], joined.ids[bridge.to]];
    let ends_m = [merged.spacing_m[bridge.from], joined.spacing_m[bridge.to]];
    let length = distance(merged.at[bridge.from], joined.at[bridge.to]);
    let count = splitting::ideal_count(length, ends_m, size_m)
        .round()
        .max(1.0);
    let line = splitting::lay_line(sheet, ends, ends_m, size_m, count as usize);
    let mut ids = merged.ids[..=bridge.from].to_vec();
    ids.extend(&line[1..]);
    ids.extend(&joined.ids[bridge.to + 1..]);
    ids.extend(&joined.ids[..=bridge.to]);
    ids.extend(line[..line.len() - 1].iter().rev());
    ids.extend(&merged.ids[bridge.from + 1..]);
    ids
}
