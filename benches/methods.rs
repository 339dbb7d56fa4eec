//! What each method of meshing costs, alone: the work that `tools/instructions` counts.
//!
//! `cargo bench --bench methods [-- METHOD [SEED...]]`: meshes random sub-domains (those of `stress` that are
//! fair) with one method and prints its name, the quads and the seeds; without seeds, the first 40 that the
//! method can mesh at all. `--smoke`: two. Everything counted is in [`counted`].

#[path = "../tests/suite/meshing_cases.rs"]
#[allow(dead_code)]
mod cases;

use polder::meshing::Meshed;
use polder::meshing::Options;
use polder::meshing::mesh;
use polder::meshing::patch::Loops;
use polder::meshing::patch::Method;

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

const METHODS: [Method; 5] = [
    Method::Mapping,
    Method::Looping,
    Method::Strip,
    Method::Indirect,
    Method::LastResort,
];

/// Sub-domains a method.
const MANY: usize = 40;

/// Seeds that are tried for them.
const SEEDS: u64 = 20_000;

/// The mesh of one method; `tools/instructions` counts by this function's name.
#[inline(never)]
fn counted(loops: &Loops, options: &Options) -> Option<Meshed> {
    mesh(loops, options).ok()
}

fn name(method: Method) -> &'static str {
    Method::NAMES[method as usize]
}

fn quads(method: Method, seed: u64) -> Option<usize> {
    let options = Options {
        methods: vec![method],
        ..Options::all()
    };
    let meshed = counted(&cases::fair(seed), &options)?;
    (meshed.patch.method == method).then_some(meshed.patch.quads.len())
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let is_smoke = words.iter().any(|word| word == "--smoke");
    let many = if is_smoke { 2 } else { MANY };
    let seeds: Vec<u64> = words.iter().filter_map(|word| word.parse().ok()).collect();
    let asked: Vec<Method> = (METHODS.into_iter())
        .filter(|&it| words.iter().any(|word| word == name(it)))
        .collect();
    let methods = if asked.is_empty() {
        METHODS.to_vec()
    } else {
        asked
    };
    for method in methods {
        let candidates = match seeds.is_empty() {
            true => (0..SEEDS).collect(),
            false => seeds.clone(),
        };
        let made: Vec<(u64, usize)> = (candidates.into_iter())
            .filter_map(|seed| Some((seed, quads(method, seed)?)))
            .take(many)
            .collect();
        let all: usize = made.iter().map(|it| it.1).sum();
        let seeds: Vec<String> = made.iter().map(|it| it.0.to_string()).collect();
        println!("{} {all} {}", name(method), seeds.join(" "));
    }
}
