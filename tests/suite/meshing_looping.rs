//! Tests of mapping, its patterns, and Looping.

use crate::meshing::cases;
use polder::geometry::point::Xy;
use polder::meshing::Meshed;
use polder::meshing::Options;
use polder::meshing::check::check;
use polder::meshing::mesh;
use polder::meshing::patch::Loops;
use polder::meshing::patch::Method;
use std::f64::consts::TAU;

/// Meshes by one method, checks every promise.
fn by(method: Method, name: &str, loops: &Loops) -> Meshed {
    let options = Options {
        methods: vec![method],
        good_enough: 2.0,
        polish: true,
    };
    let meshed = mesh(loops, &options).unwrap_or_else(|defect| panic!("{name}: {defect:?}"));
    if let Err(defect) = check(loops, &meshed.patch) {
        panic!("{name}: {defect:?}");
    }
    meshed
}

/// A polygon with so many equal edges from each corner to the next.
fn polygon(corners: &[Xy], counts: &[usize], size_m: f64) -> Loops {
    let mut nodes = Vec::new();
    for (k, &count) in counts.iter().enumerate() {
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        for step in 0..count {
            let t = step as f64 / count as f64;
            nodes.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
        }
    }
    Loops {
        walks: vec![(0..nodes.len() as u32).collect()],
        on_seam: vec![vec![false; nodes.len()]],
        across_m: Vec::new(),
        nodes,
        size_m,
        lattice_origin: None,
    }
}

/// Corners of a regular polygon.
fn regular(n: usize, radius_m: f64) -> Vec<Xy> {
    let corner = |k: usize| {
        let angle = TAU * k as f64 / n as f64;
        [radius_m * angle.cos(), radius_m * angle.sin()]
    };
    (0..n).map(corner).collect()
}

fn irregular(meshed: &Meshed, loops: &Loops) -> usize {
    let mut valence = vec![0; meshed.patch.nodes.len()];
    for quad in &meshed.patch.quads {
        quad.iter().for_each(|&node| valence[node as usize] += 1);
    }
    let inside = &valence[loops.nodes.len()..];
    inside.iter().filter(|&&count| count != 4).count()
}

#[test]
fn looping_serves_shapes_with_slits_trees_and_holes() {
    let served = |seed| {
        let loops = cases::fair(seed);
        by(Method::Looping, &format!("fair {seed}"), &loops)
            .patch
            .method
            == Method::Looping
    };
    let failed: Vec<u64> = (0..100).filter(|&seed| !served(seed)).collect();
    assert!(failed.len() <= 1, "{failed:?} fell to the last resort");
}

#[test]
fn looping_takes_whatever_can_be_joined() {
    let served = |seed| {
        let loops = cases::cruel(seed);
        by(Method::Looping, &format!("cruel {seed}"), &loops)
            .patch
            .method
            == Method::Looping
    };
    let failed = (0..100).filter(|&seed| !served(seed)).count();
    assert!(failed <= 30, "{failed} fell to the last resort");
}

#[test]
fn equal_opposite_counts_give_a_grid() {
    let corners = [[0.0, 0.0], [9.0, 1.0], [8.0, 7.0], [1.0, 6.0]];
    for (m, n) in [(1, 1), (2, 1), (9, 6), (5, 11)] {
        let loops = polygon(&corners, &[m, n, m, n], 1.0);
        let meshed = by(Method::Mapping, "grid", &loops);
        assert_eq!(meshed.patch.method, Method::Mapping);
        assert_eq!(meshed.patch.quads.len(), m * n);
        assert_eq!(irregular(&meshed, &loops), 0);
    }
}

#[test]
fn any_even_counts_of_a_square_have_a_pair() {
    let corners = [[0.0, 0.0], [7.0, 0.0], [7.0, 7.0], [0.0, 7.0]];
    for code in 0..4_usize.pow(4) {
        let counts = [0, 1, 2, 3].map(|k| 6 + code / 4_usize.pow(k) % 4);
        let matched = counts[0] == counts[2] && counts[1] == counts[3];
        if matched || counts.iter().sum::<usize>() % 2 == 1 {
            continue;
        }
        let loops = polygon(&corners, &counts, 1.0);
        let meshed = by(Method::Mapping, &format!("{counts:?}"), &loops);
        assert_eq!(meshed.patch.method, Method::Mapping, "{counts:?}");
        assert!(irregular(&meshed, &loops) <= 2, "{counts:?}");
        assert!(meshed.score.least > 0.5, "{counts:?}");
    }
}

/// One node of valence 3 or 5; the clean-up may part a node of valence 6 into two of valence 5.
#[test]
fn other_few_sided_loops_are_as_regular_as_their_corners_allow() {
    for counts in [
        vec![4, 6, 6],
        vec![5, 5, 4],
        vec![4, 4, 4, 4, 4],
        vec![5, 4, 5, 4, 4],
        vec![4; 6],
        vec![3, 4, 4, 4, 3, 4],
    ] {
        let loops = polygon(&regular(counts.len(), 4.0), &counts, 1.0);
        let meshed = by(Method::Mapping, &format!("{counts:?}"), &loops);
        assert_eq!(meshed.patch.method, Method::Mapping, "{counts:?}");
        let steps = counts.len().abs_diff(4);
        assert!(
            (1..=steps).contains(&irregular(&meshed, &loops)),
            "{counts:?}"
        );
    }
}

/// Two grids meet along each spoke, so every other side of a hexagon must sum to an even number.
#[test]
fn a_hexagon_whose_spokes_would_be_halves_has_no_pattern() {
    let loops = polygon(&regular(6, 4.0), &[3; 6], 1.0);
    let meshed = by(Method::Mapping, "hexagon", &loops);
    assert_eq!(meshed.patch.method, Method::LastResort);
}
