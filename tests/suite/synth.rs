//! Tests of `synth`.

use polder::synth::LEAST_LINES;
use polder::synth::city;

#[test]
fn a_city_has_as_many_lines_as_asked_for() {
    for lines in [LEAST_LINES, 100, 1000, 10_000] {
        assert_eq!(city(lines, 1).features.len(), lines);
    }
}

#[test]
fn same_seed_same_city_other_seed_other_city() {
    assert_eq!(city(300, 7), city(300, 7));
    assert_ne!(city(300, 7), city(300, 8));
}

#[test]
fn a_city_has_every_ingredient_inside_its_boundary() {
    let made = city(1000, 3);
    for kind in ["road", "avenue", "river", "wall", "building"] {
        assert!(made.features.iter().any(|it| it.kind == kind), "no {kind}");
    }
    let half = made.boundary[1][0];
    for feature in &made.features {
        assert!(feature.points.len() >= 2, "{}", feature.name);
        for p in &feature.points {
            assert!(
                p[0].abs() <= half && p[1].abs() <= half,
                "{}: {p:?}",
                feature.name
            );
        }
    }
}
