//! Promises `bounds` and `certificate`: the interval counts and the proof of how good they are.

use crate::check::verdict::Promise;
use crate::check::verdict::projected;
use crate::chunk::reader::Mesh;
use crate::chunk::views::CertificateView;
use crate::chunk::views::FrameView;
use crate::partition::subdomains::OUTSIDE;

/// Relative difference that summing in another order may make.
const SUM_REL: f64 = 1e-9;

pub(crate) fn check(mesh: &Mesh) -> [Promise; 2] {
    let frame = mesh.frame();
    let origin_m = mesh.index().grid.origin_m;
    let mut bounds = Promise::new("bounds");
    for curve in 0..frame.curves() {
        let n = frame.count(curve);
        let (lower, upper) = (frame.lower[curve], frame.upper[curve]);
        if n < lower || n > upper {
            let node = frame.nodes_of(curve)[0] as usize;
            bounds.broken(projected(frame.nodes[node], origin_m), || {
                format!("curve {curve} has {n} intervals, not {lower} to {upper}")
            });
        }
    }
    bounds.says(format!("{} counts", frame.curves()));
    let mut proof = Promise::new("certificate");
    match frame.certificate {
        None => proof.says("none given".into()),
        Some(given) => verify(&frame, &given, &mut proof),
    }
    [bounds, proof]
}

/// What count `n` costs on `curve`, as `Goals::cost` defines it.
fn cost(frame: &FrameView, curve: usize, n: u32) -> f64 {
    let goal = frame.goal[curve].max(f64::from(frame.lower[curve]));
    let n = f64::from(n);
    frame.weight[curve] * ((n / goal).max(goal / n) - 1.0)
}

/// The cheapest count of a curve, its cost, and what the cheapest count of other parity costs more.
struct Choice {
    count: u32,
    cost: f64,
    /// Infinite if the curve has no other parity.
    change: f64,
}

fn choice(frame: &FrameView, curve: usize) -> Choice {
    let (lower, upper) = (
        frame.lower[curve],
        frame.upper[curve].max(frame.lower[curve]),
    );
    let goal = frame.goal[curve].clamp(f64::from(lower), f64::from(upper)) as u32;
    // Costs are convex in the count: the best of each parity lies within two of the goal.
    let near = goal.saturating_sub(2).max(lower).max(1)..=goal.saturating_add(3).min(upper);
    let best = |parity: u32| {
        (near.clone())
            .filter(|n| n % 2 == parity)
            .map(|n| (cost(frame, curve, n), n))
            .fold((f64::INFINITY, 0), |a, b| if b.0 < a.0 { b } else { a })
    };
    let (even, odd) = (best(0), best(1));
    let (mine, other) = if even.0 < odd.0 {
        (even, odd)
    } else {
        (odd, even)
    };
    Choice {
        count: mine.1,
        cost: mine.0,
        change: other.0 - mine.0,
    }
}

fn verify(frame: &FrameView, given: &CertificateView, promise: &mut Promise) {
    let choices: Vec<Choice> = (0..frame.curves())
        .map(|curve| choice(frame, curve))
        .collect();
    let base: f64 = choices.iter().map(|it| it.cost).sum();
    let objective: f64 = (0..frame.curves())
        .map(|curve| cost(frame, curve, frame.count(curve)))
        .sum();
    let differs = |a: f64, b: f64| (a - b).abs() > SUM_REL * (1.0 + a.abs().max(b.abs()));
    for (what, said, counted) in [
        ("objective", given.objective, objective),
        ("base", given.base, base),
    ] {
        if differs(said, counted) {
            promise.broken(None, || {
                format!("{what} {said} is claimed, it is {counted}")
            });
        }
    }
    if given.bound > objective * (1.0 + SUM_REL) + SUM_REL {
        let bound = given.bound;
        promise.broken(None, || {
            format!("the bound {bound} is above the objective {objective}")
        });
    }
    let proven = base + duals(frame, given, &choices, promise);
    let over_base = (objective - base).max(f64::MIN_POSITIVE);
    promise.says(format!(
        "objective {objective:.6}, base {base:.6}, bound {:.6} claimed, {proven:.6} from duals; \
         gap {:.3e}",
        given.bound,
        (objective - given.bound).max(0.0) / over_base
    ));
}

/// The sum of the duals, after making sure that they are feasible.
fn duals(
    frame: &FrameView,
    given: &CertificateView,
    choices: &[Choice],
    promise: &mut Promise,
) -> f64 {
    let is_odd = odd_subdomains(frame, choices);
    // Curve by curve: sum of the duals of the sets that it leaves.
    let mut load = vec![0.0_f64; frame.curves()];
    let mut sum = 0.0;
    let mut in_set = vec![false; frame.subdomains()];
    for set in 0..given.set_dual.len() {
        let (members, dual) = (given.members(set), given.set_dual[set]);
        let odd = members.iter().filter(|&&s| is_odd[s as usize]).count() % 2 == 1;
        if dual.is_nan() || dual < 0.0 || (dual > 0.0 && !odd) {
            promise.broken(None, || {
                format!("set {set} is not odd or its dual is {dual}")
            });
            continue;
        }
        members.iter().for_each(|&s| in_set[s as usize] = true);
        for curve in leaving(frame, members, &in_set) {
            load[curve] += dual;
        }
        members.iter().for_each(|&s| in_set[s as usize] = false);
        sum += dual;
    }
    for (curve, &load) in load.iter().enumerate() {
        if load > choices[curve].change * (1.0 + SUM_REL) + SUM_REL {
            let change = choices[curve].change;
            promise.broken(None, || {
                format!("curve {curve} carries duals of {load}, more than its cost {change}")
            });
        }
    }
    sum
}

/// Sub-domains with an odd number of boundary edges if each curve took its cheapest count.
fn odd_subdomains(frame: &FrameView, choices: &[Choice]) -> Vec<bool> {
    let mut is_odd = vec![false; frame.subdomains()];
    for (curve, choice) in choices.iter().enumerate() {
        for side in [frame.left[curve], frame.right[curve]] {
            if side != OUTSIDE && choice.count % 2 == 1 {
                is_odd[side as usize] ^= true;
            }
        }
    }
    is_odd
}

/// The curves with exactly one side in the set.
fn leaving(frame: &FrameView, members: &[u32], in_set: &[bool]) -> Vec<usize> {
    let inside = |side: u32| side != OUTSIDE && in_set[side as usize];
    let mut curves: Vec<usize> = (members.iter())
        .flat_map(|&s| frame.walks_of(s as usize))
        .flat_map(|walk| frame.halves_of(walk))
        .map(|&half| (half >> 1) as usize)
        .filter(|&curve| inside(frame.left[curve]) != inside(frame.right[curve]))
        .collect();
    curves.sort_unstable();
    curves.dedup();
    curves
}
