//! Tests of the lattice core and its strip.

use polder::geometry::point::Xy;
use polder::geometry::quad::scaled_jacobian;
use polder::meshing::Meshed;
use polder::meshing::Options;
use polder::meshing::check::check;
use polder::meshing::mesh;
use polder::meshing::patch::Loops;
use polder::meshing::patch::Method;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// A polygon resampled at `spacing_m`, corners kept; counts per side rounded.
fn sides(corners: &[Xy], spacing_m: f64) -> Vec<Xy> {
    let mut out = Vec::new();
    for k in 0..corners.len() {
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        let n = ((b[0] - a[0]).hypot(b[1] - a[1]) / spacing_m)
            .round()
            .max(1.0) as usize;
        for s in 0..n {
            let t = s as f64 / n as f64;
            out.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
        }
    }
    out
}

fn circle(at: Xy, radius: f64, count: usize, clockwise: bool) -> Vec<Xy> {
    let sign = if clockwise { -1.0 } else { 1.0 };
    (0..count)
        .map(|k| {
            let a = sign * TAU * k as f64 / count as f64;
            [at[0] + radius * a.cos(), at[1] + radius * a.sin()]
        })
        .collect()
}

fn turned(points: Vec<Xy>, degrees: f64) -> Vec<Xy> {
    let (s, c) = degrees.to_radians().sin_cos();
    points
        .into_iter()
        .map(|p| [p[0] * c - p[1] * s, p[0] * s + p[1] * c])
        .collect()
}

/// Loops from positions; equal positions are one node.
fn loops_of(walks: Vec<Vec<Xy>>, size_m: f64) -> Loops {
    let mut nodes: Vec<Xy> = Vec::new();
    let mut index = BTreeMap::new();
    let mut out = Vec::new();
    for walk in &walks {
        let ids: Vec<u32> = walk
            .iter()
            .map(|p| {
                *index
                    .entry([p[0].to_bits(), p[1].to_bits()])
                    .or_insert_with(|| {
                        nodes.push(*p);
                        nodes.len() as u32 - 1
                    })
            })
            .collect();
        out.push(ids);
    }
    let on_seam = out.iter().map(|walk| vec![false; walk.len()]).collect();
    Loops {
        nodes,
        walks: out,
        size_m,
        lattice_origin: None,
        on_seam,
        across_m: Vec::new(),
    }
}

fn even(mut walk: Vec<Xy>, total: usize) -> Vec<Xy> {
    if (walk.len() + total) % 2 == 1 {
        let (a, b) = (walk[0], walk[1]);
        walk.insert(1, [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0]);
    }
    walk
}

/// A slit from the boundary node `walk[at]` along `ways`, both banks.
fn slit(walk: &mut Vec<Xy>, at: usize, way: &[Xy]) {
    let root = walk[at];
    let mut both: Vec<Xy> = way.to_vec();
    both.extend(way[..way.len() - 1].iter().rev());
    both.push(root);
    for (k, p) in both.into_iter().enumerate() {
        walk.insert(at + 1 + k, p);
    }
}

fn shapes() -> Vec<(&'static str, Loops)> {
    let h = 1.0;
    let mut list = Vec::new();
    list.push((
        "disc",
        loops_of(vec![circle([0.0; 2], 20.0, 126, false)], h),
    ));
    let w = [
        [0.0, 0.0],
        [60.0, 0.0],
        [60.0, 60.0 * 30f64.to_radians().tan()],
    ];
    list.push(("wedge", loops_of(vec![even(sides(&w, h), 0)], h)));
    let mut s = even(
        sides(&[[0.0, 0.0], [36.0, 3.0], [33.0, 30.0], [-4.0, 26.0]], h),
        0,
    );
    slit(
        &mut s,
        10,
        &[
            [11.0, 2.0],
            [11.6, 2.9],
            [12.1, 3.8],
            [12.6, 4.7],
            [13.1, 5.6],
            [13.6, 6.5],
            [14.1, 7.3],
        ],
    );
    let free: Vec<Xy> = (0..9)
        .map(|k| [6.0 + 0.98 * k as f64, 14.0 + 0.31 * k as f64])
        .collect();
    let mut ring = free.clone();
    ring.extend(free[1..8].iter().rev());
    list.push(("slits", loops_of(vec![s, ring], h)));
    list.push((
        "annulus",
        loops_of(
            vec![
                circle([0.0; 2], 20.0, 126, false),
                circle([5.0, 3.0], 7.0, 44, true),
            ],
            h,
        ),
    ));
    list.push((
        "odd island",
        loops_of(
            vec![
                circle([0.0; 2], 20.0, 125, false),
                circle([3.0, 2.0], 4.0, 25, true),
            ],
            h,
        ),
    ));
    list.push(("ring cut", ring_cut(40)));
    list.push(("seams", seams(0.0)));
    list.push(("seams odd", seams(0.5)));
    list
}

/// A ring, cut by one seam that the part has on both sides.
fn ring_cut(inner: usize) -> Loops {
    let mut walk = circle([0.0; 2], 24.0, 150, false);
    walk.push([24.0, 0.0]);
    walk.extend((7..24).rev().map(|x| [f64::from(x), 0.0]));
    let outer = 150;
    walk.extend(circle([0.0; 2], 6.0, inner, true));
    walk.push([6.0, 0.0]);
    walk.extend((7..24).map(|x| [f64::from(x), 0.0]));
    let seam = |k: usize| (outer..outer + 18).contains(&k) || k >= outer + 18 + inner;
    let on_seam = (0..walk.len()).map(seam).collect();
    let mut loops = loops_of(vec![walk], 1.0);
    loops.on_seam = vec![on_seam];
    loops.lattice_origin = Some([0.0; 2]);
    loops
}

/// A part between two seams that follow the lattice, slanted walls at the sides.
fn seams(shift: f64) -> Loops {
    let seam = |from: f64, to: f64, y: f64| {
        let inner = (from + 0.7).ceil() as i32..=(to - 0.7).floor() as i32;
        let mut row = vec![[from, y]];
        row.extend(inner.map(|x| [f64::from(x), y]));
        row
    };
    let wall = |a: Xy, b: Xy| {
        let n = (b[1] - a[1]).abs().round() as i32;
        (0..n).map(move |k| {
            let t = f64::from(k) / f64::from(n);
            [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
        })
    };
    let mut walk = seam(-0.4, 60.3, 0.0);
    let mut on_seam = vec![true; walk.len()];
    walk.extend(wall([60.3, 0.0], [57.2 + shift, 31.0]));
    on_seam.resize(walk.len(), false);
    let mut top = seam(2.7, 57.2 + shift, 31.0);
    top.remove(0);
    top.push([57.2 + shift, 31.0]);
    top.reverse();
    walk.extend(top);
    on_seam.resize(walk.len(), true);
    walk.extend(wall([2.7, 31.0], [-0.4, 0.0]));
    on_seam.resize(walk.len(), false);
    if walk.len() % 2 == 1 {
        let (a, b) = (walk[walk.len() - 1], walk[walk.len() - 2]);
        walk.insert(walk.len() - 1, [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0]);
        on_seam.push(false);
    }
    let mut loops = loops_of(vec![walk], 1.0);
    loops.on_seam = vec![on_seam];
    loops.lattice_origin = Some([-7.0, 4.0]);
    loops
}

/// Star-shaped outlines with rough radii and spacings, islands, some of them odd.
fn rough(seed: u64) -> Loops {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let radius = 1.5 + 25.0 * random() * random();
    let mut star = |at: Xy, radius: f64, count: usize, turn: f64| -> Vec<Xy> {
        (0..count)
            .map(|k| {
                let a = turn * TAU * (k as f64 + 0.4 * random()) / count as f64;
                let r = radius * (0.8 + 0.2 * random());
                [at[0] + r * a.cos(), at[1] + r * a.sin()]
            })
            .collect()
    };
    let count = 4 + (radius * 6.0) as usize + (seed % 3) as usize;
    let mut walks = vec![star([0.0; 2], radius, count, 1.0)];
    for k in 0..seed % 4 {
        let a = TAU * k as f64 / 4.0;
        let at = [0.45 * radius * a.cos(), 0.45 * radius * a.sin()];
        walks.push(star(
            at,
            0.2 * radius,
            3 + ((seed / 4 + k) % 9) as usize,
            -1.0,
        ));
    }
    let total: usize = walks.iter().map(Vec::len).sum();
    if total % 2 == 1 {
        let (a, b) = (walks[0][0], walks[0][1]);
        walks[0].insert(1, [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0]);
    }
    loops_of(walks, 1.0)
}

fn strip(name: &str, loops: &Loops) -> Meshed {
    let options = Options {
        methods: vec![Method::Strip],
        good_enough: 2.0,
        polish: true,
    };
    let meshed = mesh(loops, &options).unwrap_or_else(|defect| panic!("{name}: {defect:?}"));
    if let Err(defect) = check(loops, &meshed.patch) {
        panic!("{name}: {defect:?}");
    }
    meshed
}

#[test]
fn shapes_of_the_prototype_reach_its_quality() {
    for (name, loops) in shapes() {
        let meshed = strip(name, &loops);
        assert_eq!(meshed.patch.method, Method::Strip, "{name}");
        let score = &meshed.score;
        assert!(score.least >= 0.45, "{name}: least {}", score.least);
        assert!(score.mean >= 0.97, "{name}: mean {}", score.mean);
        assert!(
            score.irregular <= 0.035,
            "{name}: irregular {}",
            score.irregular
        );
    }
}

#[test]
fn aligned_walks_give_a_perfect_lattice() {
    let corners = [
        [0.0, 0.0],
        [40.0, 0.0],
        [40.0, 20.0],
        [20.0, 20.0],
        [20.0, 40.0],
        [0.0, 40.0],
    ];
    let loops = loops_of(vec![turned(sides(&corners, 1.0), 30.0)], 1.0);
    let meshed = strip("ell", &loops);
    assert_eq!(meshed.patch.quads.len(), 1200);
    assert!(meshed.score.least > 0.999999, "{}", meshed.score.least);
    assert_eq!(meshed.score.irregular, 0.0);
}

#[test]
fn seams_do_not_show() {
    for (name, loops) in [("seams", seams(0.0)), ("ring cut", ring_cut(40))] {
        let patch = strip(name, &loops).patch;
        let (mut perfect, mut at_seam) = (0, 0);
        for quad in &patch.quads {
            let corners = quad.map(|node| patch.nodes[node as usize]);
            let on_seam = |p: &&Xy| p[1] == 0.0 && (11.0..19.0).contains(&p[0]);
            if corners.iter().filter(on_seam).count() == 2 {
                at_seam += 1;
                perfect += usize::from(scaled_jacobian(&corners) > 0.999);
            }
        }
        assert!(
            at_seam >= 7 && perfect == at_seam,
            "{name}: {perfect} of {at_seam}"
        );
    }
}

#[test]
fn rough_walks_keep_all_promises() {
    let made = (1..150).filter(|&seed| {
        let meshed = strip(&format!("rough {seed}"), &rough(seed));
        meshed.patch.method != Method::LastResort
    });
    let made = made.count();
    assert!(made >= 140, "{made} of 149");
}
