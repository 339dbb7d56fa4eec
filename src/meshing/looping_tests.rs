use crate::geometry::point::Xy;
use crate::geometry::quad::scaled_jacobian;
use crate::meshing::draft::Draft;
use crate::meshing::looping;
use crate::meshing::mapping;
use crate::meshing::patch::Loops;
use crate::meshing::visits::Visits;
use std::f64::consts::TAU;

/// Repeatable draws from [0, 1).
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn loops_of(walks: &[Vec<Xy>], size_m: f64) -> Loops {
    let mut nodes: Vec<Xy> = Vec::new();
    let mut number = |p: &Xy| {
        let known = nodes.iter().position(|q| q == p);
        known.unwrap_or_else(|| {
            nodes.push(*p);
            nodes.len() - 1
        }) as u32
    };
    let walks: Vec<Vec<u32>> = walks
        .iter()
        .map(|walk| walk.iter().map(&mut number).collect())
        .collect();
    Loops {
        on_seam: walks.iter().map(|walk| vec![false; walk.len()]).collect(),
        nodes,
        walks,
        size_m,
        lattice_origin: None,
    }
}

/// `count` equal edges from each corner to the next.
fn sides(corners: &[Xy], counts: &[usize]) -> Vec<Xy> {
    let mut walk = Vec::new();
    for (k, &count) in counts.iter().enumerate() {
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        for step in 0..count {
            let t = step as f64 / count as f64;
            walk.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
        }
    }
    walk
}

/// A star of `n` visits, from round to jagged, with a slit from its first node inwards or an island
/// or a free line, or none of them.
fn star(draws: &mut Draws, n: usize) -> Loops {
    let roughness = 0.7 * draws.next();
    let radius = n as f64 / TAU;
    let ray = |k: usize, r: f64| {
        let angle = TAU * k as f64 / n as f64;
        [r * angle.cos(), r * angle.sin()]
    };
    let mut walk: Vec<Xy> = (0..n)
        .map(|k| ray(k, radius * (1.0 - roughness * draws.next())))
        .collect();
    let free = radius * (1.0 - roughness);
    let mut walks = Vec::new();
    match (draws.next() * 5.0) as usize {
        0 if free > 2.0 => {
            let root = walk[0];
            let steps = (root[0] / 1.3) as usize;
            let bank: Vec<Xy> = (1..=steps).map(|k| [root[0] - k as f64, 0.0]).collect();
            walk.splice(1..1, bank.iter().chain(bank.iter().rev().skip(1)).copied());
            walk.insert(2 * steps, root);
        }
        1 if free > 2.5 => walks.push(sides(&[[0.9, 0.0], [-0.9, 0.0]], &[2, 2])),
        2 if free > 3.0 => {
            let island: Vec<Xy> = (0..6)
                .map(|k| {
                    [
                        (-TAU * f64::from(k) / 6.0).cos(),
                        (-TAU * f64::from(k) / 6.0).sin(),
                    ]
                })
                .collect();
            walks.push(island);
        }
        3 if free > 2.0 => walks.push(vec![[0.5, 0.1], [-0.5, 0.1]]),
        _ => {}
    }
    walks.insert(0, walk);
    loops_of(&walks, 1.0)
}

/// What a draft promises: edges used once are those of the walks, all others twice, once each way.
fn assert_sound(draft: &Draft, visits: &Visits) {
    let mut edges = std::collections::BTreeMap::new();
    for quad in &draft.quads {
        for k in 0..4 {
            let edge = (quad[k], quad[(k + 1) % 4]);
            assert_ne!(edge.0, edge.1);
            assert!(edges.insert(edge, ()).is_none(), "{edge:?} twice one way");
        }
    }
    let on_walk = |a: u32, b: u32| (a as usize) < visits.len() && visits.next(a) == b;
    for &(a, b) in edges.keys() {
        // A free line of one edge is walked there and back between the same two visits.
        let inside = edges.contains_key(&(b, a)) && (!on_walk(a, b) || on_walk(b, a));
        assert!(
            inside || on_walk(a, b),
            "{a} -> {b} is neither inside nor a walk's"
        );
    }
    for a in 0..visits.len() as u32 {
        assert!(edges.contains_key(&(a, visits.next(a))), "walk edge at {a}");
    }
}

fn least(draft: &Draft) -> f64 {
    let corners = |quad: &[u32; 4]| quad.map(|node| draft.nodes[node as usize]);
    let shapes = draft
        .quads
        .iter()
        .map(|quad| scaled_jacobian(&corners(quad)));
    shapes.fold(1.0, f64::min)
}

#[test]
fn drafts_of_random_loops_are_sound_and_mostly_valid() {
    let draws = &mut Draws(88_172_645_463_325_252);
    let (mut none, mut valid, mut all) = (0, 0, 0);
    for round in 0..150 {
        let loops = star(draws, 4 + 2 * (round * 7 % 59));
        let visits = Visits::of(&loops);
        if let Some(draft) = mapping::mesh(&visits, &loops) {
            assert_sound(&draft, &visits);
            assert!(least(&draft) > 0.0);
        }
        all += 1;
        if let Some(draft) = looping::mesh(&visits, loops.size_m) {
            assert_sound(&draft, &visits);
            valid += usize::from(least(&draft) > 0.0);
        } else {
            none += 1;
        }
    }
    assert!(100 * none <= all, "{none} of {all} without a draft");
    assert!(10 * valid >= 6 * all, "{valid} of {all} valid as they are");
}

#[test]
fn any_counts_of_a_quadrilateral_have_a_pattern() {
    for code in 0..7_usize.pow(4) {
        let counts = [0, 1, 2, 3].map(|k| 4 + code / 7_usize.pow(k) % 7);
        let twisted = counts[0]
            .abs_diff(counts[2])
            .max(counts[1].abs_diff(counts[3]))
            > 3;
        if counts.iter().sum::<usize>() % 2 == 1 || twisted {
            continue;
        }
        let corners = [[0.0, 0.0], [7.0, 0.0], [7.0, 7.0], [0.0, 7.0]];
        let loops = loops_of(&[sides(&corners, &counts)], 1.0);
        let visits = Visits::of(&loops);
        let draft = mapping::mesh(&visits, &loops).unwrap_or_else(|| panic!("{counts:?}"));
        assert_sound(&draft, &visits);
        assert!(least(&draft) > 0.0, "{counts:?}");
        let mut valence = vec![0; draft.nodes.len()];
        draft
            .quads
            .iter()
            .flatten()
            .for_each(|&node| valence[node as usize] += 1);
        let irregular = valence[draft.visits..]
            .iter()
            .filter(|&&count| count != 4)
            .count();
        let matched = counts[0] == counts[2] && counts[1] == counts[3];
        assert_eq!(irregular, if matched { 0 } else { 2 }, "{counts:?}");
    }
}

#[test]
fn triangles_and_pentagons_have_one_irregular_node() {
    for (n, counts) in [
        (3, vec![4, 5, 5]),
        (5, vec![4, 4, 5, 4, 5]),
        (5, vec![3; 5]),
    ] {
        let corner = |k: usize| {
            let angle = TAU * k as f64 / n as f64;
            [4.0 * angle.cos(), 4.0 * angle.sin()]
        };
        let corners: Vec<Xy> = (0..n).map(corner).collect();
        if counts.iter().sum::<usize>() % 2 == 1 {
            continue;
        }
        let loops = loops_of(&[sides(&corners, &counts)], 1.0);
        let draft = mapping::mesh(&Visits::of(&loops), &loops).expect("the counts fit");
        assert!(least(&draft) > 0.4);
    }
}
