//! Tests of `meshing`.

#[path = "meshing_cases.rs"]
mod cases;
#[path = "meshing_strip.rs"]
mod strip;

use polder::meshing::Options;
use polder::meshing::check::check;
use polder::meshing::mesh;
use polder::meshing::patch::Loops;
use polder::meshing::patch::Method;

fn options(methods: &[Method]) -> Options {
    Options {
        methods: methods.to_vec(),
        good_enough: 0.95,
    }
}

/// Meshes and checks every promise.
fn verify(name: &str, loops: &Loops, methods: &[Method]) -> f64 {
    let meshed = mesh(loops, &options(methods)).unwrap_or_else(|defect| {
        panic!("{name}: {defect:?}");
    });
    if let Err(defect) = check(loops, &meshed.patch) {
        panic!("{name}: {defect:?}");
    }
    meshed.score.least
}

#[test]
fn named_shapes_keep_all_promises() {
    for (name, loops) in cases::named() {
        verify(name, &loops, &[Method::Indirect]);
    }
}

#[test]
fn random_shapes_keep_all_promises() {
    for seed in 0..200 {
        verify(
            &format!("random {seed}"),
            &cases::cruel(seed),
            &[Method::Indirect],
        );
    }
}

#[test]
fn last_resort_alone_serves_everything() {
    for (name, loops) in cases::named() {
        verify(name, &loops, &[]);
    }
    for seed in 0..200 {
        verify(&format!("random {seed}"), &cases::cruel(seed), &[]);
    }
}
