//! Tests of `intervals`.

use polder::domain::line::Domain;
use polder::domain::line::Line;
use polder::domain::line::Role;
use polder::domain::size::SizeWish;
use polder::geometry::grid::Grid;
use polder::geometry::point::Point;
use polder::intervals;
use polder::intervals::Options;
use polder::intervals::check::check;
use polder::intervals::goals::Goals;
use polder::noding;
use polder::noding::arrangement::Arrangement;
use polder::partition;
use polder::partition::subdomains::Partition;
use proptest::prelude::*;

const OPTIONS: Options = Options {
    corner_deg: 30.0,
    upper_ratio: 2.5,
    block_ratio: 1.25,
    least_edge: 0.25,
};

/// A boundary ring and lines of kind 1 (`fine`) on a grid of 1 m, noded and walked.
pub fn walked(ring: &[(i32, i32)], lines: &[Vec<(i32, i32)>]) -> (Domain, Arrangement, Partition) {
    let line = |source: usize, points: &[(i32, i32)]| Line {
        source: source as u32,
        role: if source == 0 {
            Role::Boundary
        } else {
            Role::Constraint
        },
        kind: u16::from(source > 0),
        name: String::new(),
        points: points.iter().map(|&(x, y)| Point::new(x, y)).collect(),
    };
    let all = std::iter::once(ring).chain(lines.iter().map(Vec::as_slice));
    let domain = Domain {
        grid: Grid {
            origin_m: [0.0, 0.0],
            cell_m: 1.0,
        },
        epsg: None,
        kinds: vec![String::new(), "fine".into()],
        lines: all
            .enumerate()
            .map(|(source, points)| line(source, points))
            .collect(),
        digest: 0,
    };
    let noded = noding::node(
        &domain,
        &noding::Options {
            tile_cells: 1 << 20,
        },
    );
    let (arrangement, _) = noding::clip(&domain, noded);
    let options = partition::Options {
        corner_deg: 30.0,
        tile_cells: 1 << 20,
    };
    let partition = partition::partition(&domain, &arrangement, &options).unwrap();
    (domain, arrangement, partition)
}

fn planned(ring: &[(i32, i32)], lines: &[Vec<(i32, i32)>], sizes: [f64; 2]) -> (Partition, Goals) {
    let (domain, arrangement, partition) = walked(ring, lines);
    let sizes = SizeWish {
        default_m: sizes[0],
        by_kind_m: sizes.to_vec(),
        rows_by_kind: vec![1; 2],
    };
    let goals = intervals::plan(&domain, &sizes, &arrangement, &partition, &OPTIONS);
    check(&partition, &goals).unwrap();
    (partition, goals)
}

const SQUARE: [(i32, i32); 5] = [(0, 0), (100, 0), (100, 100), (0, 100), (0, 0)];

#[test]
fn a_goal_is_length_over_size() {
    let (_, goals) = planned(&SQUARE, &[], [10.0, 10.0]);
    let all: f64 = goals.goal.iter().sum();
    assert_eq!(all, 40.0);
}

#[test]
fn the_smallest_size_of_an_edge_counts() {
    let (_, goals) = planned(&SQUARE, &[vec![(0, 0), (100, 0)]], [10.0, 4.0]);
    let all: f64 = goals.goal.iter().sum();
    assert_eq!(all, 25.0 + 30.0);
}

#[test]
fn each_edge_of_a_chain_needs_an_interval() {
    let bend = vec![(0, 50), (40, 50), (50, 51), (60, 50), (100, 50)];
    let (partition, goals) = planned(&SQUARE, &[bend], [1000.0, 1000.0]);
    let chain = partition
        .curves
        .iter()
        .position(|curve| curve.edges.len() == 4);
    assert_eq!(goals.lower[chain.unwrap()], 4);
}

#[test]
fn triangles_get_two_on_each_side() {
    let (partition, goals) = planned(&SQUARE, &[vec![(0, 0), (100, 100)]], [1000.0, 1000.0]);
    assert_eq!(partition.subdomains.len(), 2);
    let total: u32 = goals.lower.iter().sum();
    // Each of the five sides, unless curves pass a corner of the square.
    assert_eq!(total, 10);
}

/// The wide end of a long tip has room for one row only.
#[test]
fn the_wide_end_of_a_long_tip_keeps_one() {
    let wedge = [(0, 0), (100, 0), (100, 20), (0, 0)];
    let total = |size: f64| {
        planned(&wedge, &[], [size, size])
            .1
            .lower
            .iter()
            .sum::<u32>()
    };
    assert_eq!(total(30.0), 5);
    // The sides are too short for it, or the end is not.
    assert_eq!(total(40.0), 6);
    assert_eq!(total(20.0), 6);
}

#[test]
fn small_squares_keep_one_on_each_side() {
    let (_, goals) = planned(&SQUARE, &[], [1000.0, 1000.0]);
    assert_eq!(goals.lower.iter().sum::<u32>(), 4);
}

/// Two lines across the square: halved, an edge of the strip between them makes quads that are small both
/// ways if it is narrow; and so does a turn of a row there.
#[test]
fn along_a_narrow_strip_an_interval_is_dearer() {
    let strip = |gap: i32| {
        let lines = [50, 50 + gap].map(|y| vec![(0, y), (100, y)]);
        let (partition, goals) = planned(&SQUARE, &lines, [10.0, 10.0]);
        let mut areas = partition.subdomains.iter().map(|it| it.area_m2);
        let strip = areas.position(|it| it == f64::from(100 * gap)).unwrap() as u32;
        let least = |is_beside: bool| {
            let curves = partition.curves.iter().zip(&goals.weight);
            let of = curves.filter(|(it, _)| [it.left, it.right].contains(&strip) == is_beside);
            of.map(|it| *it.1).fold(f64::INFINITY, f64::min)
        };
        let block = goals.blocks.iter().find(|it| it.subdomain == strip);
        (
            least(true),
            least(false),
            goals.block_weight(block.unwrap()),
        )
    };
    let (narrow, wide) = (strip(3), strip(9));
    assert_eq!((wide.0, wide.1, narrow.1), (1.0, 1.0, 1.0));
    // .35 of a size beside 2 x 300 / 206 m
    assert!((narrow.0 - 3.5 * 206.0 / 600.0).abs() < 1e-9, "{narrow:?}");
    assert!(
        narrow.2 > (5.0_f64 / 3.0).powf(1.5) * wide.2,
        "{narrow:?} {wide:?}"
    );
}

/// Two lines a metre apart at size 10 km: sums of weights in whole units have room for millions of blocks.
#[test]
fn no_strip_is_too_narrow_for_its_price() {
    let lines = [50, 51].map(|y| vec![(0, y), (100, y)]);
    let (_, goals) = planned(&SQUARE, &lines, [1e4, 1e4]);
    let blocks = goals.blocks.iter().map(|it| goals.block_weight(it));
    let all = blocks.chain(goals.weight.iter().copied());
    assert_eq!(all.fold(0.0, f64::max), 1e3);
}

/// An L with a house and a free line: its sides are the directions, all of its curves are on one, and
/// what goes east is as long as what goes west.
#[test]
fn rooms_with_reflex_corners_and_houses_are_blocks_by_direction() {
    let l = [
        (0, 0),
        (100, 0),
        (100, 50),
        (60, 50),
        (60, 100),
        (0, 100),
        (0, 0),
    ];
    let house = vec![(20, 20), (40, 20), (40, 40), (20, 40), (20, 20)];
    let free = vec![(70, 50), (70, 30)];
    let (partition, goals) = planned(&l, &[house, free], [10.0, 10.0]);
    let room = (partition.subdomains.iter())
        .position(|it| it.walks.len() == 2)
        .expect("the room around the house") as u32;
    let block = (goals.blocks.iter())
        .find(|block| block.subdomain == room)
        .expect("it closes");
    let totals = block.totals(|curve| goals.goal[curve]);
    assert_eq!(totals[0], totals[2]);
    assert_eq!(totals[1], totals[3]);
    assert_eq!(totals.iter().sum::<f64>(), 40.0 + 8.0);
    let is_free = |&curve: &u32| {
        let curve = &partition.curves[curve as usize];
        curve.left == curve.right
    };
    assert!(!block.sides.iter().flatten().any(is_free));
    // By direction, a block's curves may lie anywhere around it, and the count is found all the same.
    let balance = polder::parity::balance(
        &partition,
        &goals,
        &polder::pipeline::plan::parity_options(1.2),
    );
    let counts = balance.expect("even").counts;
    let totals = block.totals(|curve| f64::from(counts[curve]));
    assert!(totals[0] == totals[2] && totals[1] == totals[3]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn goals_are_sound_on_random_lines(
        lines in prop::collection::vec(
            prop::collection::vec((-20_i32..120, -20_i32..120), 2..5), 0..8),
        size in 1.0_f64..200.0,
    ) {
        planned(&SQUARE, &lines, [size, 0.5 * size]);
    }
}
