//! Tests of `meshing`.

#[path = "meshing_cases.rs"]
mod cases;
#[path = "meshing_looping.rs"]
mod looping;
#[path = "meshing_strip.rs"]
mod strip;
#[path = "meshing_submap.rs"]
mod submap;
#[path = "meshing_turned_rows.rs"]
mod turned_rows;

use polder::meshing::Meshed;
use polder::meshing::Options;
use polder::meshing::check::check;
use polder::meshing::mesh;
use polder::meshing::patch::Loops;
use polder::meshing::patch::Method;
use polder::meshing::patch::Patch;
use polder::meshing::score::Score;

const ALL: [Method; 4] = [
    Method::Mapping,
    Method::Looping,
    Method::Strip,
    Method::Indirect,
];

/// Meshes and checks every promise.
fn verify(name: &str, loops: &Loops, methods: &[Method]) -> Meshed {
    let options = Options {
        methods: methods.to_vec(),
        good_enough: 0.95,
        polish: true,
    };
    let meshed = mesh(loops, &options).unwrap_or_else(|defect| panic!("{name}: {defect:?}"));
    if let Err(defect) = check(loops, &meshed.patch) {
        panic!("{name}: {defect:?}");
    }
    meshed
}

#[test]
fn named_shapes_keep_all_promises() {
    for (name, loops) in cases::named() {
        verify(name, &loops, &ALL);
        verify(name, &loops, &[Method::Indirect]);
    }
}

/// The least scaled Jacobian, as a share of what the sharpest corner allows (or of .6).
fn share(meshed: &Meshed) -> f64 {
    meshed.score.least / meshed.score.bound.min(0.6)
}

#[test]
fn fair_shapes_are_meshed_well() {
    let (mut sum, mut quads) = (0.0, 0);
    for seed in 0..60 {
        let meshed = verify(&format!("fair {seed}"), &cases::fair(seed), &ALL);
        assert!(share(&meshed) > 0.6, "fair {seed}: {:?}", meshed.score);
        assert_ne!(meshed.patch.method, Method::LastResort, "fair {seed}");
        sum += meshed.score.mean * meshed.patch.quads.len() as f64;
        quads += meshed.patch.quads.len();
    }
    assert!(sum / quads as f64 > 0.93, "mean {}", sum / quads as f64);
}

/// A hole around a bad quad that has an odd number of triangles cannot be paired: it stays as it is.
#[test]
fn an_odd_hole_is_not_filled() {
    verify("fair 2636", &cases::fair(2636), &ALL);
}

/// An edit may join two nodes that an edge joins already; read again, the sides of the two were
/// twins of each other in a ring without an outline, and the walk around a node found no end.
#[test]
fn several_edges_between_two_nodes_are_no_ring() {
    verify("cruel 22502", &cases::cruel(22502), &ALL);
}

#[test]
fn cruel_shapes_keep_all_promises() {
    let mut with_holes = 0;
    for seed in 0..50 {
        let patch = verify(&format!("cruel {seed}"), &cases::cruel(seed), &ALL).patch;
        let (made, all) = (patch.last_resort_quads as usize, patch.quads.len());
        if patch.method == Method::LastResort {
            assert_eq!(made, all, "cruel {seed}");
        } else {
            assert!(made < all, "cruel {seed}");
            with_holes += usize::from(made > 0);
        }
    }
    assert!(with_holes > 0, "no case fills a hole");
}

#[test]
fn last_resort_alone_serves_everything() {
    for (name, loops) in cases::named() {
        verify(name, &loops, &[]);
    }
    for seed in 0..50 {
        verify(&format!("fair {seed}"), &cases::fair(seed), &[]);
        verify(&format!("cruel {seed}"), &cases::cruel(seed), &[]);
    }
}

/// Loops of six to twelve nodes, which have a catalogue.
#[test]
fn small_loops_are_meshed_better_than_by_looping() {
    let random = &mut cases::Random(1);
    let (mut gained, mut poor) = (0.0, [0, 0]);
    for k in 0..120 {
        let count = [6, 8, 10, 12][k % 4];
        let ring: Vec<[f64; 2]> = (0..count)
            .map(|k| {
                let angle = std::f64::consts::TAU * (f64::from(k) + random.between(-0.3, 0.3))
                    / f64::from(count);
                let reach = f64::from(count) * random.between(1.0, 2.0);
                [reach * angle.cos(), reach * angle.sin()]
            })
            .collect();
        let mut draw = cases::Draw::default();
        draw.ring(&ring, &|_| 1000.0);
        let loops = draw.loops(10.0);
        let name = format!("loop {k}");
        let listed = verify(&name, &loops, &[Method::Mapping]);
        let split = verify(&name, &loops, &[Method::Looping]);
        assert_ne!(listed.patch.method, Method::LastResort, "{name}");
        gained += listed.score.rank() - split.score.rank();
        for (poor, meshed) in poor.iter_mut().zip([&listed, &split]) {
            *poor += u32::from(share(meshed) < 0.5);
        }
    }
    assert!(gained > 0.0, "{gained}");
    assert!(poor[0] <= poor[1], "{poor:?}");
}

/// Where sides of a wedge are mapped to each other, cells shrink with it.
#[test]
fn wedges_are_not_filled_with_small_cells() {
    let (length, angle) = (520.0, 14.0_f64.to_radians());
    let ring = [
        [0.0, 0.0],
        [length, 0.0],
        [length * angle.cos(), length * angle.sin()],
    ];
    let mut draw = cases::Draw::default();
    draw.ring(&ring, &|_| 10.0);
    let meshed = verify("wedge", &draw.loops(10.0), &ALL);
    assert!(meshed.score.crowding < 1.2, "{:?}", meshed.score);
    assert!(meshed.score.mean > 0.97, "{:?}", meshed.score);
}

/// Two quads with poor corners are better than four small ones; not at the price of a sliver.
#[test]
fn small_cells_lose_unless_the_larger_ones_are_slivers() {
    let score = |least: f64, size: f64| Score {
        least,
        mean: 0.7,
        irregular: 0.2,
        size,
        crowding: 1.0,
        bound: 1.0,
        worst_quad: 0,
    };
    assert!(score(0.42, 0.34).rank() > score(0.55, 0.18).rank());
    assert!(score(0.28, 0.34).rank() < score(0.32, 0.18).rank());
    // where no cell is small, shape decides
    assert!(score(0.42, 0.7).rank() < score(0.55, 0.4).rank());
}

#[test]
fn same_loops_give_the_same_bits() {
    for seed in 0..10 {
        let loops = cases::fair(seed);
        assert_eq!(verify("first", &loops, &ALL), verify("again", &loops, &ALL));
    }
}

#[test]
fn square_becomes_a_lattice() {
    let side = |k: usize| [[0.0, 0.0], [80.0, 0.0], [80.0, 80.0], [0.0, 80.0]][k];
    let mut draw = cases::Draw::default();
    draw.ring(&[side(0), side(1), side(2), side(3)], &|_| 10.0);
    let meshed = verify("square", &draw.loops(10.0), &[Method::Indirect]);
    assert_eq!(meshed.patch.quads.len(), 64);
    assert!(meshed.score.least > 0.999 && meshed.score.irregular == 0.0);
}

/// Two unit squares side by side, and what the check says to each way of spoiling them.
#[test]
fn check_sees_every_broken_promise() {
    let mut draw = cases::Draw::default();
    let rectangle = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
    draw.ring(&rectangle, &|_| 1.0);
    let loops = draw.loops(1.0);
    let good = verify("two squares", &loops, &[Method::Indirect]).patch;
    let says = |spoil: &dyn Fn(&mut Patch)| {
        let mut patch = good.clone();
        spoil(&mut patch);
        check(&loops, &patch).expect_err("spoilt").what
    };
    assert!(says(&|patch| patch.nodes[0][0] -= 0.1).contains("moved"));
    assert!(says(&|patch| patch.quads[0].reverse()).contains("Jacobian"));
    assert!(says(&|patch| patch.quads[0][0] = 99).contains("not there"));
    assert!(says(&|patch| patch.quads.truncate(1)).contains("on its left"));
    assert!(says(&|patch| patch.quads.push(patch.quads[0])).contains("same side"));
    // A quad beyond the walk.
    assert!(
        says(&|patch| {
            let first = patch.nodes.len() as u32;
            let [a, b] = [loops.walks[0][0], loops.walks[0][1]];
            let low = |node: u32| {
                let p = loops.nodes[node as usize];
                let inner = [1.0, 0.5];
                [2.0 * p[0] - inner[0], 2.0 * p[1] - inner[1]]
            };
            patch.nodes.extend([low(a), low(b)]);
            patch.quads.push([first, first + 1, b, a]);
        })
        .contains("on the right")
    );
}
