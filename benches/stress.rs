//! Random sub-domains by the hundred thousand: does any break the mesher?
//!
//! `cargo bench --bench stress [-- COUNT [FIRST_SEED]]` (default 100 000) meshes that many of 4 to
//! 400 edges, half of them cruel (concave, holes, slits, trees, features far below an edge, edges
//! graded up to 1:20) and half fair, on two threads, then the named shapes; every patch is checked against all promises of
//! `meshing`. Exits with 1 if one is broken. `--smoke` runs 200.

#[path = "../tests/suite/meshing_cases.rs"]
#[allow(dead_code)]
mod cases;

use polder::meshing::Options;
use polder::meshing::check::check;
use polder::meshing::mesh;
use polder::meshing::patch::Loops;
use polder::meshing::patch::Method;
use std::panic::catch_unwind;
use std::process::ExitCode;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering;
use std::thread;
use std::time::Duration;
use std::time::Instant;

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// What became of many sub-domains.
#[derive(Default)]
struct Tally {
    subdomains: u64,
    edges: [usize; 2],
    quads: u64,
    /// Patches by the method that made them.
    by_method: [u64; 5],
    /// Quads that the last resort put into holes of other patches.
    refilled: u64,
    panics: u64,
    refused: u64,
    broken: u64,
    /// Sums of the least Jacobian as a share of what the sharpest corner allows, and of the mean.
    least: f64,
    mean: f64,
    /// Time in the mesher, and that of the slowest sub-domain with its name.
    seconds: f64,
    slowest: (f64, String),
}

impl Tally {
    fn add(&mut self, name: &str, loops: &Loops) {
        self.subdomains += 1;
        let edges = edges(loops);
        self.edges = match self.subdomains {
            1 => [edges; 2],
            _ => [self.edges[0].min(edges), self.edges[1].max(edges)],
        };
        let start = Instant::now();
        let Ok(meshed) = catch_unwind(|| mesh(loops, &Options::all())) else {
            self.panics += 1;
            eprintln!("{name}: panic");
            return;
        };
        let seconds = start.elapsed().as_secs_f64();
        self.seconds += seconds;
        if seconds > self.slowest.0 {
            self.slowest = (seconds, format!("{name}, {edges} edges"));
        }
        let meshed = match meshed {
            Ok(meshed) => meshed,
            Err(defect) => {
                self.refused += 1;
                eprintln!("{name}: {defect:?}");
                return;
            }
        };
        if let Err(defect) = check(loops, &meshed.patch) {
            self.broken += 1;
            eprintln!("{name}: {defect:?}");
        }
        self.by_method[meshed.patch.method as usize] += 1;
        if meshed.patch.method != Method::LastResort {
            self.refilled += u64::from(meshed.patch.last_resort_quads);
        }
        self.quads += meshed.patch.quads.len() as u64;
        self.least += meshed.score.least / meshed.score.bound.min(0.6);
        self.mean += meshed.score.mean;
    }

    fn join(&mut self, other: &Tally) {
        if other.subdomains == 0 {
            return;
        }
        let merge = |a: usize, b: usize| if self.subdomains == 0 { b } else { a };
        self.edges = [
            merge(self.edges[0], other.edges[0]).min(other.edges[0]),
            merge(self.edges[1], other.edges[1]).max(other.edges[1]),
        ];
        self.subdomains += other.subdomains;
        self.quads += other.quads;
        self.refilled += other.refilled;
        self.panics += other.panics;
        self.refused += other.refused;
        self.broken += other.broken;
        self.least += other.least;
        self.mean += other.mean;
        self.seconds += other.seconds;
        if other.slowest.0 > self.slowest.0 {
            self.slowest = other.slowest.clone();
        }
        for (sum, &count) in self.by_method.iter_mut().zip(&other.by_method) {
            *sum += count;
        }
    }

    fn print(&self, name: &str) {
        let each = |sum: f64| sum / self.subdomains as f64;
        let share = |count: u64| 100.0 * count as f64 / self.subdomains as f64;
        println!(
            "{name}: {} sub-domains of {} to {} edges, {} quads; broken {}, panics {}, refused {}",
            self.subdomains,
            self.edges[0],
            self.edges[1],
            self.quads,
            self.broken,
            self.panics,
            self.refused,
        );
        let methods = Method::NAMES.iter().zip(self.by_method);
        let shares = methods.map(|(method, count)| format!("{method} {:.2} %", share(count)));
        println!(
            "  {}; quads in refilled holes {}; least (share of the bound) {:.3}, mean {:.3}",
            shares.collect::<Vec<_>>().join(", "),
            self.refilled,
            each(self.least),
            each(self.mean),
        );
        println!(
            "  {:.0} s in the mesher; the slowest {:.2} s ({})",
            self.seconds, self.slowest.0, self.slowest.1,
        );
    }

    fn holds(&self) -> bool {
        self.broken + self.panics + self.refused == 0
    }
}

/// Sub-domains with more edges are drawn again: longer ones are what `seams` is for.
const MOST_EDGES: usize = 400;

fn edges(loops: &Loops) -> usize {
    loops.walks.iter().map(Vec::len).sum()
}

/// Seconds after which a sub-domain is taken for one without an end.
const ENDLESS_S: u64 = 120;

/// Meshes `count` cases of `draw` on two threads, one with the even seeds from `first` on, one with
/// the odd ones. Ends the process if one of them finds no end.
fn run(draw: fn(u64) -> Loops, name: &str, first: u64, count: u64) -> bool {
    static AT_HAND: [AtomicU64; 2] = [AtomicU64::new(0), AtomicU64::new(0)];
    let half = |parity: u64| {
        move || {
            let mut tally = Tally::default();
            let mut seeds = (first + parity..).step_by(2);
            while tally.subdomains < (count + 1 - parity) / 2 {
                let seed = seeds.next().expect("seeds do not end");
                let loops = draw(seed);
                if edges(&loops) <= MOST_EDGES {
                    AT_HAND[parity as usize].store(seed, Ordering::Relaxed);
                    tally.add(&format!("seed {seed}"), &loops);
                }
            }
            tally
        }
    };
    let threads = [0, 1].map(|parity| thread::spawn(half(parity)));
    let mut since = [(0, Instant::now()); 2];
    while threads.iter().any(|thread| !thread.is_finished()) {
        thread::sleep(Duration::from_millis(20));
        for (k, (seed, start)) in since.iter_mut().enumerate() {
            let now = AT_HAND[k].load(Ordering::Relaxed);
            if now != *seed {
                (*seed, *start) = (now, Instant::now());
            } else if !threads[k].is_finished() && start.elapsed().as_secs() > ENDLESS_S {
                eprintln!("{name}, seed {seed}: no end after {ENDLESS_S} s");
                std::process::exit(1);
            }
        }
    }
    let mut all = Tally::default();
    for thread in threads {
        all.join(&thread.join().expect("panics are caught"));
    }
    all.print(name);
    all.holds()
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Vec<u64> = words.iter().filter_map(|word| word.parse().ok()).collect();
    let is_smoke = words.iter().any(|word| word == "--smoke");
    let count = numbers
        .first()
        .copied()
        .unwrap_or(if is_smoke { 200 } else { 100_000 });
    let first = numbers.get(1).copied().unwrap_or(0);
    let mut holds = run(cases::cruel, "cruel", first, count / 2);
    holds &= run(cases::fair, "fair", first, count - count / 2);
    println!(
        "| shape | edges | quads | method | SJ mean | SJ least | bound | irregular % | s least / h |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (name, loops) in cases::named() {
        let edges = edges(&loops);
        let Ok(meshed) = mesh(&loops, &Options::all()) else {
            println!("| {name} | {edges} | refused |");
            holds = false;
            continue;
        };
        holds &= check(&loops, &meshed.patch).is_ok();
        println!(
            "| {name} | {edges} | {} | {} | {:.3} | {:.3} | {:.3} | {:.1} | {:.3} |",
            meshed.patch.quads.len(),
            Method::NAMES[meshed.patch.method as usize],
            meshed.score.mean,
            meshed.score.least,
            meshed.score.bound,
            100.0 * meshed.score.irregular,
            meshed.score.size,
        );
    }
    ExitCode::from(u8::from(!holds))
}
