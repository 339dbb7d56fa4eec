//! The whole main job on synthetic cities, stage by stage: `cargo bench --bench city -- [LINES SIZE_M THREADS]...`.
//!
//! Prints a row a run: lines, quads, seconds by stage, quads a second, peak memory. `--smoke` runs
//! the smallest city alone.

use polder::pipeline::build;
use polder::pipeline::job::Job;
use std::path::Path;
use std::process::Command;

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Vec<f64> = words.iter().filter_map(|it| it.parse().ok()).collect();
    let runs: Vec<[f64; 3]> = if words.iter().any(|it| it == "--smoke") {
        vec![[100.0, 20.0, 0.0]]
    } else if numbers.len() >= 3 {
        numbers
            .chunks_exact(3)
            .map(|it| [it[0], it[1], it[2]])
            .collect()
    } else {
        vec![
            [1000.0, 10.0, 1.0],
            [1000.0, 10.0, 2.0],
            [10_000.0, 10.0, 2.0],
            [1000.0, 1.0, 2.0],
        ]
    };
    let folder = std::env::temp_dir().join(format!("polder-bench-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the temporary folder can be made");
    for [lines, size_m, threads] in runs {
        run(&folder, lines as usize, size_m, threads as usize);
    }
    std::fs::remove_dir_all(&folder).expect("the temporary folder can be removed");
}

fn run(folder: &Path, lines: usize, size_m: f64, threads: usize) {
    let input = folder.join("city.geojson");
    let made = Command::new(env!("CARGO_BIN_EXE_polder"))
        .args([
            "synth",
            "--quiet",
            "--force",
            "--lines",
            &lines.to_string(),
            "--out",
        ])
        .arg(&input)
        .status()
        .expect("the binary starts");
    assert!(made.success());
    let job = Job {
        threads,
        force: true,
        ..Job::usual(input, folder.join("city.polder"), size_m)
    };
    let outcome = build(&job, &|_| {}).expect("a city can be built");
    assert!(outcome.verdict.holds());
    let quads = outcome.verdict.quality.scaled_jacobian.count;
    let stages: Vec<String> = (outcome.stages.iter())
        .map(|it| format!("{} {:.2}", it.stage, it.seconds))
        .collect();
    println!(
        "{lines} lines, {size_m} m, {threads} threads: {quads} quads, {:.0} quads/s, {:.0} MB; {}",
        quads as f64 / outcome.seconds(),
        outcome.peak_memory_bytes as f64 / 1e6,
        stages.join(", ")
    );
}
