//! Tests of `rungs`.

use crate::seams::At;
use crate::seams::SIZE_M;
use crate::seams::domain;
use polder::domain::line::Domain;
use polder::domain::line::Role;
use polder::domain::size::SizeWish;
use polder::geometry::point::Point;
use polder::intervals;
use polder::noding;
use polder::noding::arrangement::Arrangement;
use polder::partition;
use polder::partition::partition;
use polder::partition::subdomains::Partition;
use polder::rungs;
use polder::rungs::Options;
use polder::rungs::lay;
use proptest::prelude::*;
use std::collections::BTreeMap;

const OPTIONS: Options = Options {
    longest: 0.8,
    corner_deg: 30.0,
};

fn ring(role: Role, points: &[At]) -> (Role, Vec<At>) {
    (role, points.iter().chain(&points[..1]).copied().collect())
}

fn rectangle(width: f64, height: f64) -> (Role, Vec<At>) {
    let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)];
    ring(Role::Boundary, &corners)
}

fn line(points: &[At]) -> (Role, Vec<At>) {
    (Role::Constraint, points.to_vec())
}

struct Laid {
    rungs: u64,
    before: Partition,
    after: Partition,
    arrangement: Arrangement,
}

fn partitioned(domain: &Domain, arrangement: &Arrangement) -> Partition {
    let options = partition::Options {
        corner_deg: 30.0,
        tile_cells: 1 << 22,
    };
    let made = partition(domain, arrangement, &options).unwrap();
    let whole = partition::check::check(domain, arrangement, &made);
    assert_eq!(whole, Ok(()));
    made
}

/// Length of each line in the arrangement, by its stations.
fn covered_m(domain: &Domain, arrangement: &Arrangement) -> Vec<f64> {
    let mut length = vec![0.0; domain.lines.len()];
    for piece in &arrangement.pieces {
        length[piece.line as usize] += (piece.to_m - piece.from_m).abs();
    }
    length
}

/// Lays rungs and verifies every promise.
fn lay_well(lines: &[(Role, Vec<At>)]) -> Laid {
    let domain = domain(lines);
    let sizes = SizeWish::uniform(SIZE_M, 1);
    let options = noding::Options {
        tile_cells: 1 << 22,
    };
    let arrangement = noding::clip(&domain, noding::node(&domain, &options)).0;
    let before = partitioned(&domain, &arrangement);
    let runged = lay(&domain, &sizes, &arrangement, &before, &OPTIONS);
    assert_eq!(noding::check::check(&runged.arrangement), Ok(()));
    let checked = rungs::check::check(&domain, &sizes, &runged.arrangement, &OPTIONS);
    assert_eq!(checked, Ok(()));
    let after = partitioned(&domain, &runged.arrangement);
    check_blocks(&runged.arrangement, &after);
    check_feet(&arrangement, &runged.arrangement);
    check_small_rooms((&arrangement, &before), (&runged.arrangement, &after));
    let is_kept = |p: &Point| runged.arrangement.points.binary_search(p).is_ok();
    assert!(arrangement.points.iter().all(is_kept));
    let lengths = [&arrangement, &runged.arrangement].map(|it| covered_m(&domain, it));
    for (old, new) in lengths[0].iter().zip(&lengths[1]) {
        assert!((old - new).abs() < 1e-6);
    }
    let made = (runged.arrangement.piece_start.windows(2)).filter(|it| it[0] == it[1]);
    assert_eq!(made.count() as u64, runged.rungs);
    Laid {
        rungs: runged.rungs,
        before,
        after,
        arrangement: runged.arrangement,
    }
}

/// The last part of promise 1: of the rungs that meet at a foot one has made it, and the others are
/// no longer than those from foot to foot may be.
fn check_feet(given: &Arrangement, runged: &Arrangement) {
    let is_foot = |&node: &u32| {
        let p = &runged.points[node as usize];
        given.points.binary_search(p).is_err()
    };
    // in sizes
    let mut lengths: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
    for (edge, nodes) in runged.edges.iter().enumerate() {
        if runged.pieces_of(edge as u32).is_empty() {
            let [a, b] = nodes.map(|node| runged.points[node as usize]);
            for &foot in nodes.iter().filter(|it| is_foot(it)) {
                lengths
                    .entry(foot)
                    .or_default()
                    .push(a.distance(b) / 1000.0);
            }
        }
    }
    for (_, lengths) in lengths {
        let long = lengths.iter().filter(|&&it| it > rungs::RUN_ON + 0.01);
        assert!(long.count() <= 1, "rungs of {lengths:?} sizes at a foot");
    }
}

/// Promise 6, in sizes: there are not more small odd rooms than before. Feet are rounded to the grid, so that a
/// room may seem a little larger or smaller than it was when its rung was laid.
fn check_small_rooms(given: (&Arrangement, &Partition), runged: (&Arrangement, &Partition)) {
    let odd = |(arrangement, partition): (&Arrangement, &Partition), slack: f64| {
        let is_odd = |walk: &Vec<u32>| {
            let edges: Vec<u32> = (walk.iter())
                .flat_map(|half| &partition.curves[(half >> 1) as usize].edges)
                .copied()
                .collect();
            let around: f64 = (edges.iter())
                .map(|&edge| arrangement.edges[edge as usize])
                .map(|ends| ends.map(|node| arrangement.points[node as usize]))
                .map(|[a, b]| a.distance(b) / 1000.0)
                .sum();
            let is_small = around < rungs::AROUND + slack;
            is_small && edges.len() <= rungs::SMALL_WALK && edges.len() % 2 == 1
        };
        let walks = partition.subdomains.iter().flat_map(|it| &it.walks);
        walks.filter(|walk| is_odd(walk)).count()
    };
    assert!(odd(runged, -0.02) <= odd(given, 0.02));
}

/// Promise 4, from the partition alone: walks with a rung on them have four corners, or three and
/// two long sides, but if a rung has joined two walks, or if they are long.
fn check_blocks(arrangement: &Arrangement, partition: &Partition) {
    for subdomain in &partition.subdomains {
        for walk in &subdomain.walks {
            let curves = || {
                walk.iter()
                    .map(|half| &partition.curves[(half >> 1) as usize])
            };
            let divides = |side: u32| {
                curves()
                    .any(|it| it.is_seam && it.left != it.right && side == it.left.min(it.right))
            };
            let sides = curves()
                .map(|it| it.left.min(it.right))
                .filter(|&it| divides(it));
            let mut nodes: Vec<u32> = Vec::new();
            for half in walk {
                let chain = &partition.curves[(half >> 1) as usize].nodes;
                let mut chain = chain.clone();
                if half & 1 == 1 {
                    chain.reverse();
                }
                nodes.extend(&chain[..chain.len() - 1]);
            }
            if sides.count() == 0 || nodes.len() > rungs::LONGEST_WALK {
                continue;
            }
            let n = nodes.len();
            let at = |k: usize| arrangement.points[nodes[k % n] as usize];
            let corner = |k: &usize| {
                let (a, b, c) = (at(k + n - 1), at(*k), at(k + 1));
                let (ux, uy) = (f64::from(b.x - a.x), f64::from(b.y - a.y));
                let (vx, vy) = (f64::from(c.x - b.x), f64::from(c.y - b.y));
                let turn = (ux * vy - uy * vx).atan2(ux * vx + uy * vy).to_degrees();
                // A tip turns by half a circle, to the right as seen from inside.
                turn > 30.0 - 0.2 && a != c
            };
            let corners: Vec<usize> = (0..n).filter(corner).collect();
            if corners.len() == 3 {
                let mut sides = [0, 1, 2].map(|k| {
                    let last = if k == 2 {
                        corners[0] + n
                    } else {
                        corners[k + 1]
                    };
                    let edges = corners[k]..last;
                    edges.map(|it| at(it).distance(at(it + 1))).sum::<f64>() / 1000.0
                });
                sides.sort_by(f64::total_cmp);
                let is_tip = sides[0] < rungs::ONE_ROW + 0.01 && sides[1] > rungs::LONG - 0.01;
                assert!(is_tip, "a tip with sides of {sides:?}");
            }
            assert!(corners.len() >= 3, "a walk of {n} edges");
        }
    }
}

#[test]
fn open_country_has_no_rungs() {
    let made = lay_well(&[rectangle(9.0, 7.0), line(&[(2.0, 3.0), (6.0, 4.0)])]);
    assert_eq!(made.rungs, 0);
    assert_eq!(made.before, made.after);
}

/// A street of half a size: each junction on one side gets a rung to the other.
#[test]
fn junctions_get_rungs_across_a_corridor() {
    let mut lines = vec![rectangle(20.0, 10.5), line(&[(0.0, 5.0), (20.0, 5.0)])];
    lines.push(line(&[(0.0, 5.5), (20.0, 5.5)]));
    for x in [4.0, 9.0, 13.0] {
        lines.push(line(&[(x, 0.0), (x, 5.0)]));
    }
    let made = lay_well(&lines);
    assert_eq!(made.rungs, 3);
    assert_eq!(
        made.after.subdomains.len(),
        made.before.subdomains.len() + 3
    );
    let foot = Point::new(4000, 5500);
    assert!(made.arrangement.points.binary_search(&foot).is_ok());
}

/// Two rows if the kind wishes them, as far as they are not narrower than the least edge.
#[test]
fn rungs_have_as_many_intervals_as_rows_are_wished() {
    let mut lines = vec![rectangle(20.0, 10.5), line(&[(0.0, 5.0), (20.0, 5.0)])];
    lines.push(line(&[(0.0, 5.5), (20.0, 5.5)]));
    lines.push(line(&[(9.0, 0.0), (9.0, 5.0)]));
    let made = lay_well(&lines);
    let domain = domain(&lines);
    let lower = |rows: u32, least_edge: f64| {
        let mut sizes = SizeWish::uniform(SIZE_M, 1);
        sizes.rows_by_kind = vec![rows];
        let options = intervals::Options {
            corner_deg: 30.0,
            upper_ratio: 2.5,
            block_ratio: 1.25,
            least_edge,
        };
        let goals = intervals::plan(&domain, &sizes, &made.arrangement, &made.after, &options);
        assert_eq!(intervals::check::check(&made.after, &goals), Ok(()));
        let mut curves = made.after.curves.iter();
        let rung = curves.position(|it| it.is_seam && it.left != it.right);
        goals.lower[rung.unwrap()]
    };
    assert_eq!(lower(1, 0.25), 1);
    assert_eq!(lower(2, 0.25), 2);
    assert_eq!(lower(3, 0.25), 2);
    assert_eq!(lower(2, 0.3), 1);
}

/// Junctions that nearly face each other share a rung.
#[test]
fn a_rung_goes_to_a_node_that_is_near_its_foot() {
    let mut lines = vec![rectangle(20.0, 10.5), line(&[(0.0, 5.0), (20.0, 5.0)])];
    lines.push(line(&[(0.0, 5.5), (20.0, 5.5)]));
    lines.push(line(&[(8.0, 0.0), (8.0, 5.0)]));
    lines.push(line(&[(8.3, 10.5), (8.3, 5.5)]));
    assert_eq!(lay_well(&lines).rungs, 1);
}

/// The inner corner of a bend has a rung to each outer side, so that the bend is one square.
#[test]
fn a_bend_gets_two_rungs() {
    let outer = [
        (0.0, 0.0),
        (9.0, 0.0),
        (9.0, 9.0),
        (8.5, 9.0),
        (8.5, 0.5),
        (0.0, 0.5),
    ];
    let made = lay_well(&[ring(Role::Boundary, &outer)]);
    assert_eq!((made.rungs, made.after.subdomains.len()), (2, 3));
}

/// The court around a building is one walk after its first rung.
#[test]
fn rungs_cut_the_ring_around_a_building() {
    let wall = [(0.5, 0.5), (6.5, 0.5), (6.5, 4.5), (0.5, 4.5)];
    let made = lay_well(&[rectangle(7.0, 5.0), ring(Role::Hole, &wall)]);
    assert_eq!((made.rungs, made.after.subdomains.len()), (8, 8));
}

/// A rung closes a triangle with the tip: it must be short, and the tip long.
#[test]
fn a_wedge_has_rungs_far_from_its_tip_only() {
    let rungs = |height: f64| {
        let mut wedge = vec![(0.0, 0.0)];
        wedge.extend((1..6).map(|k| (f64::from(k) * 1.1, 0.0)));
        wedge.push((6.0, height));
        let mut lines = vec![ring(Role::Boundary, &wedge)];
        let stub = |k: i32| line(&[(f64::from(k) * 1.1, 0.0), (f64::from(k) * 1.1, -0.1)]);
        lines.extend((1..6).map(stub));
        lay_well(&lines).rungs
    };
    assert_eq!(rungs(1.2), 1);
    assert_eq!(rungs(1.5), 0);
}

/// The foot of a rung is a node that faces nothing across the next strip: it gets one of its own
/// where that is narrow, and the row runs on.
#[test]
fn feet_get_rungs_across_the_next_narrow_strip() {
    let rungs = |width: f64| {
        let mut lines = vec![rectangle(20.0, 10.5)];
        lines.extend([5.0, 5.5, 5.5 + width].map(|y| line(&[(0.0, y), (20.0, y)])));
        lines.push(line(&[(9.0, 0.0), (9.0, 5.0)]));
        lay_well(&lines).rungs
    };
    assert_eq!(rungs(0.6), 2);
    assert_eq!(rungs(0.7), 1);
}

/// A court of five short sides is odd; with the rung that its re-entrant side calls for it would be two
/// courts of which one is. Where the junction is a corner instead, both are even.
#[test]
fn no_rung_leaves_a_small_room_odd() {
    let rungs = |junction: bool| {
        let mut lines = vec![rectangle(8.0, 6.0)];
        let court = [(3.0, 3.0), (3.45, 3.0), (3.9, 3.0), (3.9, 3.6), (3.0, 3.6)];
        lines.push(line(&[&court[..], &court[..1]].concat()));
        lines.push(line(&[(3.45, 3.0), (3.45, 1.0)]));
        if junction {
            lines.push(line(&[(3.46, 3.6), (3.46, 5.0)]));
        }
        let made = lay_well(&lines);
        made.after.subdomains.len() - made.before.subdomains.len()
    };
    // from the junction to the foot in the middle of the other side, .45 from both corners
    assert_eq!(rungs(false), 1);
    assert_eq!(rungs(true), 1);
}

/// A slit that ends shortly before a wall is prolonged to it.
#[test]
fn a_slit_is_prolonged_to_a_near_wall() {
    let made = lay_well(&[rectangle(8.0, 6.0), line(&[(4.0, 0.0), (4.0, 5.4)])]);
    assert_eq!((made.rungs, made.after.subdomains.len()), (1, 2));
}

/// Streets with banks: polylines, each with a parallel at a random distance, and lines across.
fn streets() -> impl Strategy<Value = Vec<(Role, Vec<At>)>> {
    let street = (
        prop::collection::vec((-14.0..14.0, -14.0..14.0), 2..5),
        0.1..0.9,
    );
    let across = (-14.0..14.0, -14.0..14.0, -6.0..6.0, -6.0..6.0);
    let all = (
        prop::collection::vec(street, 1..5),
        prop::collection::vec(across, 0..12),
    );
    all.prop_map(|(streets, across)| {
        let square = [(-15.0, -15.0), (15.0, -15.0), (15.0, 15.0), (-15.0, 15.0)];
        let mut lines = vec![ring(Role::Boundary, &square)];
        for (way, width) in streets {
            let bank: Vec<At> = way
                .iter()
                .map(|&(x, y)| (x + width, y + 0.6 * width))
                .collect();
            lines.extend([line(&way), line(&bank)]);
        }
        lines.extend((across.iter()).map(|&(x, y, dx, dy)| line(&[(x, y), (x + dx, y + dy)])));
        lines
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn promises_hold_between_any_streets(lines in streets()) {
        lay_well(&lines);
    }
}
