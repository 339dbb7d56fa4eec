//! Tests of `boundary`.

use crate::intervals::walked;
use polder::boundary;
use polder::boundary::check::check;
use polder::boundary::walks::Site;
use polder::boundary::walks::curve_nodes;
use polder::boundary::walks::walks;
use polder::domain::size::SizeWish;
use polder::geometry::grid::Grid;
use polder::geometry::point::Point;
use polder::intervals;
use polder::intervals::apportion::apportion;
use polder::intervals::apportion::next_cost;
use polder::intervals::wish::EdgeWish;
use polder::parity;
use proptest::prelude::*;

fn free(goal: f64) -> EdgeWish {
    EdgeWish {
        goal,
        lower: 1,
        upper: u32::MAX,
    }
}

fn fixed(count: u32) -> EdgeWish {
    EdgeWish {
        goal: f64::from(count),
        lower: count,
        upper: count,
    }
}

const GRID: Grid = Grid {
    origin_m: [500_000.0, 0.0],
    cell_m: 0.001,
};

#[test]
fn a_straight_edge_is_divided_equally() {
    let ends = [Point::new(0, 0), Point::new(3000, 4000)];
    let nodes = boundary::place(&GRID, &ends, &[free(5.0)], 5);
    assert_eq!(nodes.len(), 6);
    assert_eq!(
        (nodes[0], nodes[5]),
        (GRID.local_m(ends[0]), GRID.local_m(ends[1]))
    );
    for pair in nodes.windows(2) {
        let length = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
        assert!((length - 1.0).abs() < 1e-9, "{length}");
    }
}

#[test]
fn every_point_of_a_chain_is_a_node() {
    let points = [
        Point::new(0, 0),
        Point::new(10, 7),
        Point::new(5000, 0),
        Point::new(5001, 9),
    ];
    let nodes = boundary::place(&GRID, &points, &[free(0.1), free(5.0), free(0.1)], 9);
    for point in points {
        assert!(nodes.contains(&GRID.local_m(point)), "{point:?}");
    }
    assert_eq!(nodes.len(), 10);
}

/// Two lines across a square of 100 m, 3 m apart, at 10 m: both fields beside the strip know how deep it is, which
/// knows nothing of them.
#[test]
fn a_walk_knows_how_narrow_a_strip_across_is() {
    let square = [(0, 0), (100, 0), (100, 100), (0, 100), (0, 0)];
    let lines = [50, 53].map(|y| vec![(0, y), (100, y)]);
    let (domain, arrangement, partition) = walked(&square, &lines);
    let width_m = boundary::widths_m(&domain, &arrangement, &partition);
    let depth_m = 600.0 / 206.0;
    let counts: Vec<u32> = partition
        .curves
        .iter()
        .map(|it| it.edges.len() as u32)
        .collect();
    let first = boundary::numbering(&partition, &counts, arrangement.points.len());
    let sizes = SizeWish::uniform(10.0, 2);
    let across = |width_m: &[f64], subdomain: usize| {
        let site = Site {
            domain: &domain,
            sizes: &sizes,
            arrangement: &arrangement,
            partition: &partition,
            counts: &counts,
            first: &first,
            width_m,
        };
        walks(&site, subdomain as u32).across_m.concat()
    };
    for (id, subdomain) in partition.subdomains.iter().enumerate() {
        let known: Vec<f64> = (across(&width_m, id).into_iter())
            .filter(|&it| it > 0.0)
            .collect();
        match subdomain.area_m2 == 300.0 {
            true => assert!(known.is_empty(), "{known:?}"),
            false => assert!(
                known.len() == 1 && (known[0] - depth_m).abs() < 1e-9,
                "{known:?}"
            ),
        }
        assert!(
            across(&[], id).iter().all(|&it| it == 0.0),
            "nothing is known"
        );
    }
}

#[test]
fn lattice_seams_have_lattice_nodes() {
    let points = [
        Point::new(-7, 3),
        Point::new(20_000, 40_000),
        Point::new(20_000, 80_000),
    ];
    let nodes = boundary::place(&GRID, &points, &[free(4.4), fixed(4)], 9);
    for k in 0..=4 {
        let lattice = GRID.local_m(Point::new(20_000, 40_000 + k * 10_000));
        assert!(nodes.contains(&lattice), "{lattice:?}");
    }
}

/// The slow twin of the greedy rule.
fn least_cost(edges: &[EdgeWish], count: u32) -> f64 {
    let Some((first, rest)) = edges.split_first() else {
        return if count == 0 { 0.0 } else { f64::INFINITY };
    };
    (first.lower..=count.min(first.upper))
        .map(|n| cost(first, n) + least_cost(rest, count - n))
        .fold(f64::INFINITY, f64::min)
}

fn cost(edge: &EdgeWish, n: u32) -> f64 {
    match f64::from(n) / edge.goal {
        times if times < 1.0 => 1.0 / times.powi(2),
        times if times < 1.8 => times.powi(2),
        times => times.powi(4) / 1.8_f64.powi(2),
    }
}

/// Parity changes seven edges of the size before it halves one of two fifths.
#[test]
fn to_halve_a_short_edge_costs_more_than_a_long_way_around() {
    let price = |goal: f64| next_cost(&[free(goal)], 1).unwrap();
    assert!(price(0.4) > 7.0 * price(1.0));
    assert!(price(0.4) > 3.0 * price(0.6));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn shares_are_the_cheapest(
        goals in prop::collection::vec((0.05_f64..6.0, 0_u32..5), 1..5),
        more in 0_u32..12,
    ) {
        let edges: Vec<EdgeWish> = (goals.iter())
            .map(|&(goal, kind)| if kind == 0 { fixed(2) } else { free(goal) })
            .collect();
        prop_assume!(goals.iter().any(|it| it.1 > 0));
        let count = edges.iter().map(|edge| edge.lower).sum::<u32>() + more;
        let shares = apportion(&edges, count);
        prop_assert_eq!(shares.iter().sum::<u32>(), count);
        let made: f64 = edges.iter().zip(&shares).map(|(edge, &n)| cost(edge, n)).sum();
        prop_assert!(made <= least_cost(&edges, count) * (1.0 + 1e-12));
    }

    #[test]
    fn walks_of_random_lines_are_sound(
        lines in prop::collection::vec(
            prop::collection::vec((-20_i32..120, -20_i32..120), 2..5), 0..8),
        size in 2.0_f64..60.0,
    ) {
        let square = [(0, 0), (100, 0), (100, 100), (0, 100), (0, 0)];
        let (domain, arrangement, partition) = walked(&square, &lines);
        let sizes = SizeWish::uniform(size, 2);
        let options = intervals::Options { corner_deg: 30.0, upper_ratio: 2.5, block_ratio: 1.25, least_edge: 0.25 };
        let goals = intervals::plan(&domain, &sizes, &arrangement, &partition, &options);
        let limits = parity::Options { events_max: u64::MAX, nodes_max: 100, rows_max: 1000, worth: 0.0, rounds_max: 20, climb_max: 60,
        gap_enough: 5e-4, neighbourhoods_max: 20 };
        let balance = parity::balance(&partition, &goals, &limits).unwrap();
        parity::check::check(&partition, &goals, &balance).unwrap();
        let counts = &balance.counts;
        let first = boundary::numbering(&partition, counts, arrangement.points.len());
        let width_m = boundary::widths_m(&domain, &arrangement, &partition);
        let site = Site {
            domain: &domain,
            sizes: &sizes,
            arrangement: &arrangement,
            partition: &partition,
            counts,
            first: &first,
            width_m: &width_m,
        };
        for id in 0..partition.subdomains.len() as u32 {
            let made = walks(&site, id);
            prop_assert_eq!(check(&site, id, &made), Ok(()));
            prop_assert!(made.ids.iter().all(|&id| id < first[counts.len()]));
        }
        for curve in 0..partition.curves.len() as u32 {
            let chain = &partition.curves[curve as usize];
            let points: Vec<Point> = (chain.nodes.iter())
                .map(|&node| arrangement.points[node as usize])
                .collect();
            let wishes: Vec<EdgeWish> = (chain.edges.iter())
                .map(|&edge| intervals::wish::edge_wish(&domain, &sizes, &arrangement, edge))
                .collect();
            let count = counts[curve as usize];
            let nodes = boundary::place(&domain.grid, &points, &wishes, count);
            prop_assert_eq!(nodes, curve_nodes(&site, curve).1);
        }
    }
}
