//! The architecture, as a test: who may import whom, who may touch the world, who has which package.

use std::fs;
use std::path::Path;

/// A module of `src/`: its name, its side, the packages granted to it.
struct Layer(&'static str, Side, &'static [&'static str]);

#[derive(Clone, Copy, PartialEq)]
enum Side {
    /// Same input, same output; no files, clocks, threads or environment.
    Pure,
    /// Talks to disk, threads or the user.
    Door,
}
use Side::Door;
use Side::Pure;

/// The modules in the order of the data flow: each may import only those above it.
const LAYERS: &[Layer] = &[
    Layer("geometry", Pure, &[]),
    Layer("domain", Pure, &[]),
    Layer("synth", Pure, &[]),
    Layer("ingest", Door, &["geojson", "flate2"]),
    Layer("noding", Pure, &["rstar"]),
    Layer("cleanup", Pure, &[]),
    Layer("partition", Pure, &[]),
    Layer("seams", Pure, &[]),
    Layer("rungs", Pure, &[]),
    Layer("intervals", Pure, &[]),
    Layer("parity", Pure, &["highs"]),
    Layer("boundary", Pure, &[]),
    Layer("meshing", Pure, &["spade"]),
    Layer("settling", Pure, &[]),
    Layer("spill", Door, &["bincode", "memmap2"]),
    Layer("chunk", Door, &["flatbuffers", "memmap2"]),
    Layer("check", Door, &[]),
    Layer("export", Door, &[]),
    Layer("report", Pure, &["tiny_skia", "flate2"]),
    Layer("pipeline", Door, &["rayon", "crossbeam"]),
    Layer("cli", Door, &["clap", "indicatif", "toml"]),
];

/// What a pure module may not name.
const OUTSIDE: &[&str] = &[
    "std::fs",
    "std::io",
    "std::env",
    "std::net",
    "std::thread",
    "std::time",
    "println!",
];

#[test]
fn modules_only_look_upstream() {
    let mut faults = Vec::new();
    for (rank, layer) in LAYERS.iter().enumerate() {
        for (file, text) in sources(&Path::new("src").join(layer.0)) {
            if file.ends_with("generated.rs") {
                continue;
            }
            for (n, line) in text.lines().enumerate() {
                let code = line.split("//").next().unwrap();
                for fault in faults_in(code, rank, layer) {
                    faults.push(format!("{file}:{}: {fault}", n + 1));
                }
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn lib_rs_declares_modules_in_flow_order() {
    let lib = fs::read_to_string("src/lib.rs").unwrap();
    let declared: Vec<&str> = (lib.lines())
        .filter_map(|it| it.strip_prefix("pub mod ")?.strip_suffix(';'))
        .collect();
    let ranked: Vec<&str> = LAYERS.iter().map(|it| it.0).collect();
    assert_eq!(declared, ranked);
}

#[test]
fn the_map_in_src_readme_names_every_module_in_flow_order() {
    let map = fs::read_to_string("src/README.md").unwrap();
    let mut from = 0;
    for layer in LAYERS {
        let entry = format!("`{}`", layer.0);
        match map[from..].find(&entry) {
            Some(at) => from += at,
            None => panic!("src/README.md lacks {entry}, or has it out of order"),
        }
    }
}

#[test]
fn every_module_is_ranked_and_mirrored() {
    for entry in fs::read_dir("src").unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        if path.is_dir() {
            let ranked = LAYERS.iter().any(|it| it.0 == name);
            assert!(ranked, "src/{name} has no rank in LAYERS");
            let mirror = format!("tests/suite/{name}.rs");
            assert!(Path::new(&mirror).exists(), "no {mirror}");
        } else {
            let known = ["lib", "main", "README"].contains(&name);
            assert!(known, "{name} belongs in a module's folder");
        }
    }
}

#[test]
fn a_downstream_import_is_caught() {
    let noding = LAYERS.iter().position(|it| it.0 == "noding").unwrap();
    for bad in [
        "use crate::partition::subdomains::Curve;",
        "use crate::ingest::read;",
        "use crate::{domain, geometry};",
        "let n = rayon::current_num_threads();",
        "let t = std::time::Instant::now();",
    ] {
        assert!(!faults_in(bad, noding, &LAYERS[noding]).is_empty(), "{bad}");
    }
    let good = "use crate::domain::line::Domain;";
    assert!(faults_in(good, noding, &LAYERS[noding]).is_empty());
}

fn faults_in(code: &str, rank: usize, layer: &Layer) -> Vec<String> {
    let mut faults = Vec::new();
    let Layer(module, side, granted) = layer;
    if ["crate::{", "std::{", "super::super"]
        .iter()
        .any(|it| code.contains(it))
    {
        faults.push("one module a line: `use crate::module::Item`".to_string());
    }
    if *side == Pure && OUTSIDE.iter().any(|it| code.contains(it)) {
        faults.push(format!("{module} is pure and stays inside"));
    }
    for (other_rank, Layer(other, other_side, packages)) in LAYERS.iter().enumerate() {
        if names(code, &format!("crate::{other}")) {
            if rank < other_rank {
                faults.push(format!("{module} is upstream of {other}"));
            }
            if *side == Pure && *other_side == Door {
                faults.push(format!("{module} is pure, {other} is a door"));
            }
        }
        for package in packages.iter().filter(|it| !granted.contains(it)) {
            if names_start(code, &format!("{package}::")) {
                faults.push(format!("{package} is granted to {other}, not to {module}"));
            }
        }
    }
    faults
}

/// True if `path` occurs in `code` as a whole, not as the start of a longer name.
fn names(code: &str, path: &str) -> bool {
    code.match_indices(path).any(|(at, _)| {
        let next = code[at + path.len()..].chars().next();
        next.is_none_or(|it| it != '_' && !it.is_alphanumeric())
    })
}

/// True if `path` occurs in `code` and no longer name ends with it.
fn names_start(code: &str, path: &str) -> bool {
    code.match_indices(path).any(|(at, _)| {
        let before = code[..at].chars().next_back();
        before.is_none_or(|it| it != '_' && !it.is_alphanumeric())
    })
}

/// All Rust files below `folder`, sorted by path.
pub fn sources(folder: &Path) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|it| it == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            found.push((path.display().to_string(), text));
        }
    }
    found.sort();
    found
}
