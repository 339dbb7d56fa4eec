//! Sub-domains whose outer walk nearly closes on a lattice: rows that turn.

use super::cases::Draw;
use super::cases::L;
use super::cases::Random;
use super::verify;
use polder::geometry::point::Xy;
use polder::meshing::Meshed;
use polder::meshing::patch::Loops;
use polder::meshing::patch::Method;

fn ring(corners: &[Xy], spacing: &dyn Fn(Xy) -> f64) -> Loops {
    let mut draw = Draw::default();
    draw.ring(corners, spacing);
    draw.loops(1.0)
}

/// The numbers of quads of inner nodes that are not four, with the nodes.
fn irregular(loops: &Loops, meshed: &Meshed) -> Vec<(usize, Xy)> {
    let patch = &meshed.patch;
    let mut quads = vec![0; patch.nodes.len()];
    for &node in patch.quads.iter().flatten() {
        quads[node as usize] += 1;
    }
    let inner = loops.nodes.len()..patch.nodes.len();
    let mut found: Vec<(usize, Xy)> = inner
        .filter(|&node| quads[node] != 4)
        .map(|node| (quads[node], patch.nodes[node]))
        .collect();
    found.sort_by_key(|it| it.0);
    found
}

fn pair(name: &str, loops: &Loops) -> [Xy; 2] {
    let meshed = verify(name, loops, &[Method::Mapping]);
    assert_eq!(meshed.patch.method, Method::Mapping, "{name}");
    assert!(meshed.score.least > 0.4, "{name}: {:?}", meshed.score);
    match irregular(loops, &meshed)[..] {
        [(3, three), (5, five)] => [three, five],
        ref other => panic!("{name}: {other:?}"),
    }
}

/// One edge too many to the east and one to the north.
#[test]
fn a_row_turns_from_one_side_to_the_next() {
    let spacing = |p: Xy| match p {
        [_, 0.0] => 8.0 / 9.0,
        [8.0, _] => 0.8,
        _ => 1.0,
    };
    pair("turns", &ring(&L, &spacing));
}

/// Two edges too many to the east, side by side: the row goes in there and comes back.
#[test]
fn a_row_turns_back_where_the_edges_are_short() {
    let short = [[2.0, 0.0], [4.0, 0.0]];
    let corners = [&L[..1], &short, &L[1..]].concat();
    let spacing = |p: Xy| if p == [3.0, 0.0] { 0.5 } else { 1.0 };
    let [three, five] = pair("turns back", &ring(&corners, &spacing));
    let is_above = |[x, _]: Xy| (1.5..4.5).contains(&x);
    assert!(is_above(three) && is_above(five), "{three:?} {five:?}");
}

/// As many rows as edges lack, and no more irregular nodes than two a row, whatever the walk's bends, with a house and
/// a free line in the way.
#[test]
fn rows_have_two_irregular_nodes_each() {
    let (mut mapped, mut open) = (0, 0);
    for seed in 0..200 {
        let mut random = Random(seed);
        let bend = random.between(-0.004, 0.004);
        let dense = [0; 6].map(|_| random.between(0.85, 1.15));
        let place = |[x, y]: Xy| [x + bend * y * y, y + bend * x * x];
        let side = |p: Xy| (p[0] + 2.0 * p[1]) as usize % 6;
        let mut draw = Draw::default();
        draw.ring(&L.map(|[x, y]| place([2.0 * x, 2.0 * y])), &|p| {
            dense[side(p)]
        });
        draw.ring(
            &[[2.0, 9.0], [2.0, 12.0], [5.0, 12.0], [5.0, 9.0]].map(place),
            &|_| 1.0,
        );
        draw.line(&[[9.0, 3.0], [12.0, 3.0]].map(place), &|_| 1.0, true);
        let loops = draw.loops(1.0);
        if loops.walks.iter().map(Vec::len).sum::<usize>() % 2 != 0 {
            continue;
        }
        let meshed = verify(&format!("rows {seed}"), &loops, &[Method::Mapping]);
        if meshed.patch.method != Method::Mapping {
            continue;
        }
        let irregular = irregular(&loops, &meshed);
        assert!(irregular.len() <= 6, "rows {seed}: {irregular:?}");
        mapped += 1;
        open += usize::from(!irregular.is_empty());
    }
    assert!(mapped > 30 && open > 20, "{mapped} {open}");
}
