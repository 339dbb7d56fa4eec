//! Promises `bounds` and `certificate`: the interval counts and the proof of how good they are.

use crate::check::verdict::Promise;
use crate::check::verdict::projected;
use crate::chunk::reader::Mesh;
use crate::chunk::views::CertificateView;
use crate::chunk::views::FrameView;
use crate::partition::subdomains::OUTSIDE;

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

/// What count `n` costs on `curve`, as `Goals::cost` defines it, in whole units.
fn cost(frame: &FrameView, unit: f64, curve: usize, n: u32) -> i64 {
    let goal = frame.goal[curve].max(f64::from(frame.lower[curve]));
    let n = f64::from(n);
    (frame.weight[curve] * ((n / goal).max(goal / n).powi(2) - 1.0) / unit).round() as i64
}

/// The cheapest count of a curve, its cost, and what the cheapest count of other parity costs more.
struct Choice {
    count: u32,
    cost: i64,
    /// `None` if the curve has no other parity.
    change: Option<i64>,
}

fn choice(frame: &FrameView, unit: f64, curve: usize) -> Choice {
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
            .map(|n| (cost(frame, unit, curve, n), n))
            .min()
    };
    let (mine, other) = match (best(0), best(1)) {
        (Some(even), Some(odd)) => (even.min(odd), Some(even.max(odd))),
        (even, odd) => (even.or(odd).unwrap_or((0, 0)), None),
    };
    Choice {
        count: mine.1,
        cost: mine.0,
        change: other.map(|it| it.0 - mine.0),
    }
}

fn verify(frame: &FrameView, given: &CertificateView, promise: &mut Promise) {
    let unit = given.cost_unit;
    let choices: Vec<Choice> = (0..frame.curves())
        .map(|c| choice(frame, unit, c))
        .collect();
    let base: i64 = choices.iter().map(|it| it.cost).sum();
    let objective: i64 = (0..frame.curves())
        .map(|curve| cost(frame, unit, curve, frame.count(curve)))
        .sum();
    sets_are_odd(frame, given, &choices, promise);
    pays_no_more_than_it_costs(frame, given, &choices, promise);
    let bound = base + (given.set_dual2.iter().sum::<i64>() + 1) / 2;
    for (what, said, counted) in [
        ("objective", given.objective, objective),
        ("base", given.base, base),
        ("bound", given.bound, bound),
    ] {
        if said != counted {
            promise.broken(None, || {
                format!("{what}: {said} is claimed, {counted} counted")
            });
        }
    }
    if bound > objective {
        promise.broken(None, || {
            format!("the bound {bound} is above the objective {objective}")
        });
    }
    let gap = (objective - bound) as f64 / ((objective - base).max(1)) as f64;
    let beyond = match frame.patterns {
        Some(_) => "spent on patterns, share",
        None => "gap",
    };
    let claimed = given.solved.beside_bound(unit);
    promise.says(format!(
        "objective {objective}, bound {bound}{claimed}, free rounding {base} (units of {unit:e}); {beyond} {gap:.6}"
    ));
}

/// Each set holds an odd number of sub-domains that are odd under the cheapest counts, and pays.
fn sets_are_odd(
    frame: &FrameView,
    given: &CertificateView,
    choices: &[Choice],
    promise: &mut Promise,
) {
    let sets = given.set_parent.len();
    let mut odd = vec![false; sets];
    for (curve, _) in choices
        .iter()
        .enumerate()
        .filter(|(_, it)| it.count % 2 == 1)
    {
        for side in [frame.left[curve], frame.right[curve]] {
            let set = if side == OUTSIDE {
                NONE
            } else {
                given.set_of[side as usize]
            };
            if set != NONE {
                odd[set as usize] ^= true;
            }
        }
    }
    // Children come after their parents, so each is complete when it is added to its parent.
    for set in (0..sets).rev() {
        if !odd[set] || given.set_dual2[set] <= 0 {
            promise.broken(None, || {
                format!("set {set} of the certificate proves nothing")
            });
        }
        let parent = given.set_parent[set];
        if parent != NONE && odd[set] {
            odd[parent as usize] ^= true;
        }
    }
}

/// No set, or none around it.
const NONE: u32 = u32::MAX;

/// The sets with exactly one side of a curve pay together at most what changing it costs.
fn pays_no_more_than_it_costs(
    frame: &FrameView,
    given: &CertificateView,
    choices: &[Choice],
    promise: &mut Promise,
) {
    let least = |side: u32| {
        if side == OUTSIDE {
            NONE
        } else {
            given.set_of[side as usize]
        }
    };
    for (curve, choice) in choices.iter().enumerate() {
        let Some(change) = choice.change else {
            continue;
        };
        let (mut a, mut b) = (least(frame.left[curve]), least(frame.right[curve]));
        let mut paid2 = 0;
        // Parents precede children, so the later of two different sets does not hold the other.
        while a != b {
            let inner = if b == NONE || (a != NONE && a > b) {
                &mut a
            } else {
                &mut b
            };
            paid2 += given.set_dual2[*inner as usize];
            *inner = given.set_parent[*inner as usize];
        }
        if paid2 > 2 * change {
            promise.broken(None, || {
                format!("curve {curve} is paid {paid2} half units, its change costs {change} units")
            });
        }
    }
}
