//! Sub-domains whose walks close on a lattice.

use super::cases::Draw;
use super::cases::L;
use super::cases::Random;
use super::verify;
use polder::geometry::point::Xy;
use polder::meshing::Meshed;
use polder::meshing::patch::Loops;
use polder::meshing::patch::Method;

const CITY_BLOCK: [Xy; 9] = [
    [0.0, 0.0],
    [12.0, 0.0],
    [12.0, 4.0],
    [15.0, 4.0],
    [15.0, 10.0],
    [7.0, 10.0],
    [7.0, 12.0],
    [5.0, 12.0],
    [0.0, 12.0],
];

/// The block with two houses (walked clockwise), a free line that hangs on its rim and one that does not.
fn block(move_to: impl Fn(Xy) -> Xy) -> Loops {
    let mut draw = Draw::default();
    let moved = |points: &[Xy]| points.iter().map(|&p| move_to(p)).collect::<Vec<Xy>>();
    draw.ring(&moved(&CITY_BLOCK), &|_| 1.0);
    for [x, y] in [[2.0, 3.0], [9.0, 6.0]] {
        let house = [[x, y], [x, y + 2.0], [x + 3.0, y + 2.0], [x + 3.0, y]];
        draw.ring(&moved(&house), &|_| 1.0);
    }
    draw.line(&moved(&[[5.0, 12.0], [5.0, 9.0]]), &|_| 1.0, true);
    draw.line(
        &moved(&[[8.0, 2.0], [10.0, 2.0], [10.0, 3.0]]),
        &|_| 1.0,
        true,
    );
    draw.loops(1.0)
}

fn mapped(name: &str, loops: &Loops) -> Meshed {
    let meshed = verify(name, loops, &[Method::Mapping]);
    assert_eq!(meshed.patch.method, Method::Mapping, "{name}");
    meshed
}

#[test]
fn houses_and_free_lines_on_a_lattice_need_no_irregular_node() {
    let loops = block(|p| p);
    assert_eq!(loops.walks.len(), 4);
    let meshed = mapped("block", &loops);
    assert_eq!(meshed.patch.quads.len(), 12 * 4 + 15 * 6 + 7 * 2 - 2 * 6);
    assert!(meshed.score.irregular == 0.0 && meshed.score.least > 0.99);
}

/// Streets bend and houses are askew: as long as the counts are the same, the cells are.
#[test]
fn bent_walks_have_the_cells_of_straight_ones() {
    let edges = |loops: &Loops| loops.walks.iter().map(Vec::len).sum::<usize>();
    let straight = edges(&block(|p| p));
    let mut tried = 0;
    for seed in 0..60 {
        let mut random = Random(seed);
        let (sin, cos) = f64::sin_cos(random.between(0.0, 6.3));
        let bend = random.between(-0.004, 0.004);
        let shear = random.between(-0.1, 0.1);
        let loops = block(|[x, y]| {
            let (x, y) = (x + shear * y + bend * y * y, y + bend * x * x);
            [100.0 + cos * x - sin * y, sin * x + cos * y]
        });
        if edges(&loops) == straight {
            let meshed = mapped(&format!("bent {seed}"), &loops);
            assert_eq!(meshed.patch.quads.len(), 140, "bent {seed}");
            assert!(meshed.score.least > 0.5, "bent {seed}: {:?}", meshed.score);
            tried += 1;
        }
    }
    assert!(tried > 20, "{tried}");
}

/// Eight intervals too many on one side: four rows would have to turn back.
#[test]
fn walks_that_do_not_close_are_left_to_others() {
    let mut draw = Draw::default();
    draw.ring(&L, &|p| if p[1] == 0.0 { 0.5 } else { 1.0 });
    let meshed = verify("not closed", &draw.loops(1.0), &[Method::Mapping]);
    assert_eq!(meshed.patch.method, Method::LastResort);
}

/// A house so near the rim that no cell fits between: its place on the lattice would touch.
#[test]
fn houses_without_room_on_the_lattice_are_left_to_others() {
    let mut draw = Draw::default();
    let spacing = |p: Xy| if p[1] > 0.5 && p[1] < 3.5 { 0.5 } else { 1.0 };
    draw.ring(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]], &|_| 1.0);
    draw.ring(&[[0.5, 0.5], [0.5, 3.5], [3.5, 3.5], [3.5, 0.5]], &spacing);
    let loops = draw.loops(1.0);
    let meshed = verify("no room", &loops, &[Method::Mapping]);
    assert_eq!(meshed.patch.method, Method::LastResort);
}
