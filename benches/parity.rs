//! Parity of synthetic cities of growing size: time, proof, memory; beside it the work of HiGHS.
//!
//! `cargo bench --bench parity [-- LARGEST]`, with LARGEST sub-domains at most (default 100 000; `--smoke`: 1000).

use polder::intervals::goals::Goals;
use polder::parity;
use polder::parity::Options;
use polder::parity::check::check;
use polder::partition::subdomains::Curve;
use polder::partition::subdomains::OUTSIDE;
use polder::partition::subdomains::Partition;
use polder::partition::subdomains::Subdomain;
use std::time::Instant;

fn main() {
    let smoke = std::env::args().any(|word| word == "--smoke");
    let largest = std::env::args()
        .filter_map(|word| word.parse().ok())
        .next()
        .unwrap_or(if smoke { 1000 } else { 100_000 });
    println!(
        "family  sub-domains   curves     odd  proven  extra cost        gap  events  rows  seconds  + HiGHS"
    );
    for family in ["grid", "merged", "long", "fine"] {
        for subdomains in [1_000_usize, 10_000, 100_000, 1_000_000] {
            if subdomains <= largest {
                row(family, subdomains);
            }
        }
    }
}

fn row(family: &str, subdomains: usize) {
    let (partition, goals) = city(family, (subdomains as f64).sqrt().round() as usize);
    let alone = Options {
        events_max: u64::MAX,
        nodes_max: 1000,
        rows_max: 0,
        worth: 0.0,
        rounds_max: 20,
        climb_max: 60,
        neighbourhoods_max: 20,
    };
    let start = Instant::now();
    let made = parity::balance(&partition, &goals, &alone).expect("a feasible city");
    let seconds = start.elapsed().as_secs_f64();
    check(&partition, &goals, &made).expect("a sound balance");
    let start = Instant::now();
    let asked = Options {
        rows_max: 2_000_000,
        ..alone
    };
    let both = parity::balance(&partition, &goals, &asked).expect("a feasible city");
    println!(
        "{family:7} {:11} {:8} {:7}  {:6}  {:10.3}  {:9.2e}  {:6.1}  {}x{}{}  {seconds:7.2}  {:8.2}",
        partition.subdomains.len(),
        partition.curves.len(),
        made.odd_subdomains,
        made.proven,
        made.objective - made.base,
        made.gap(),
        made.events as f64 / partition.curves.len() as f64,
        both.rows,
        both.columns,
        if both.branched { "*" } else { "" },
        start.elapsed().as_secs_f64(),
    );
    if let Some(claimed) = both.claimed {
        let off = (claimed - both.objective).abs() / both.objective;
        assert!(
            off < 1e-6,
            "HiGHS claims {claimed}, {} is proven",
            both.objective
        );
    }
}

/// A deterministic stream of numbers in [0, 1).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// `side` x `side` cells. grid: blocks; merged: a third of them joined to their western neighbour;
/// long: streets far longer one way than the other; fine: 40 to 400 intervals a curve.
fn city(family: &str, side: usize) -> (Partition, Goals) {
    let mut dice = Dice(side as u64);
    let share = if family == "merged" { 0.33 } else { 0.0 };
    let mut block: Vec<u32> = Vec::with_capacity(side * side);
    for k in 0..side * side {
        let merged = k % side > 0 && dice.roll() < share;
        block.push(block.last().map_or(0, |last| last + u32::from(!merged)));
    }
    let at = |x: usize, y: usize| match x < side && y < side {
        true => block[y * side + x],
        false => OUTSIDE,
    };
    let (mut curves, mut goals) = (Vec::new(), Goals::default());
    let mut street = |left: u32, right: u32, goal: f64| {
        if left != right {
            let edges = vec![curves.len() as u32];
            curves.push(Curve {
                nodes: vec![0, 1],
                edges,
                left,
                right,
                is_seam: false,
            });
            goals.goal.push(goal);
            goals.lower.push(1);
            goals.upper.push((2.5 * goal).ceil() as u32 + 3);
            goals.weight.push(1.0);
        }
    };
    let [east, north] = match family {
        "long" => [12.0, 1.5],
        "fine" => [200.0, 200.0],
        _ => [4.0, 4.0],
    };
    for y in 0..side {
        for x in 0..side {
            street(at(x, y), at(x + 1, y), north * (0.3 + 1.7 * dice.roll()));
            street(at(x, y), at(x, y + 1), east * (0.3 + 1.7 * dice.roll()));
            if x == 0 {
                street(OUTSIDE, at(x, y), north * (0.3 + 1.7 * dice.roll()));
            }
            if y == 0 {
                street(OUTSIDE, at(x, y), east * (0.3 + 1.7 * dice.roll()));
            }
        }
    }
    let subdomains = vec![Subdomain::default(); block[side * side - 1] as usize + 1];
    (Partition { curves, subdomains }, goals)
}
