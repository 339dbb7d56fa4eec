//! Tests of `seams`.

use polder::domain::line::Domain;
use polder::domain::line::Line;
use polder::domain::line::Role;
use polder::domain::size::SizeWish;
use polder::geometry::grid::Grid;
use polder::geometry::point::Point;
use polder::noding;
use polder::noding::arrangement::Arrangement;
use polder::partition;
use polder::partition::partition;
use polder::partition::subdomains::Partition;
use polder::seams;
use polder::seams::Options;
use polder::seams::Seamed;
use polder::seams::cut;
use proptest::prelude::*;

/// Edge length and lattice pitch, cells.
const SIZE: i32 = 1000;
pub const SIZE_M: f64 = 10.0;

const CORNERS_AND_TILES: partition::Options = partition::Options {
    corner_deg: 30.0,
    tile_cells: 1 << 22,
};

/// Coordinates in sizes.
pub type At = (f64, f64);

/// Lines at their places.
pub fn domain(lines: &[(Role, Vec<At>)]) -> Domain {
    let cells = |v: f64| (v * f64::from(SIZE)).round() as i32;
    let line = |(source, (role, points)): (usize, &(Role, Vec<At>))| Line {
        source: source as u32,
        role: *role,
        kind: 0,
        name: String::new(),
        points: (points.iter())
            .map(|&(x, y)| Point::new(cells(x), cells(y)))
            .collect(),
    };
    Domain {
        grid: Grid {
            origin_m: [1000.0, 2000.0],
            cell_m: SIZE_M / f64::from(SIZE),
        },
        epsg: None,
        kinds: vec![String::new()],
        lines: lines.iter().enumerate().map(line).collect(),
        digest: 0,
    }
}

fn ring(points: &[At]) -> Vec<At> {
    points.iter().chain(&points[..1]).copied().collect()
}

fn boundary(points: &[At]) -> (Role, Vec<At>) {
    (Role::Boundary, ring(points))
}

fn hole(points: &[At]) -> (Role, Vec<At>) {
    (Role::Hole, ring(points))
}

fn slit(points: &[At]) -> (Role, Vec<At>) {
    (Role::Constraint, points.to_vec())
}

fn arrange(domain: &Domain) -> Arrangement {
    let options = noding::Options {
        tile_cells: 1 << 22,
    };
    noding::clip(domain, noding::node(domain, &options)).0
}

/// Length of each line in the arrangement, by its stations.
fn covered_m(domain: &Domain, arrangement: &Arrangement) -> Vec<f64> {
    let mut length = vec![0.0; domain.lines.len()];
    for piece in &arrangement.pieces {
        length[piece.line as usize] += (piece.to_m - piece.from_m).abs();
    }
    length
}

struct Cut {
    seamed: Seamed,
    /// Quads of the sub-domains, in budgets.
    sizes: Vec<f64>,
    before: Partition,
    after: Partition,
}

/// Cuts and verifies every promise.
fn cut_well(lines: &[(Role, Vec<At>)], budget_quads: f64) -> Cut {
    let domain = domain(lines);
    let sizes = SizeWish::uniform(SIZE_M, 1);
    let arrangement = arrange(&domain);
    let before = partition(&domain, &arrangement, &CORNERS_AND_TILES).unwrap();
    let options = Options { budget_quads };
    let seamed = cut(&domain, &sizes, &arrangement, &before, &options);
    assert_eq!(noding::check::check(&seamed.arrangement), Ok(()));
    assert_eq!(
        seams::check::check(&domain, &sizes, &seamed.arrangement),
        Ok(())
    );
    let after = partition(&domain, &seamed.arrangement, &CORNERS_AND_TILES).unwrap();
    let whole = partition::check::check(&domain, &seamed.arrangement, &after);
    assert_eq!(whole, Ok(()));
    let findings = seamed.findings.len();
    assert!(seams::check::check_sizes(
        &domain, &sizes, &after, findings, &options
    ));
    let area = |of: &Partition| -> f64 { of.subdomains.iter().map(|it| it.area_m2).sum() };
    assert!((area(&after) / area(&before) - 1.0).abs() < 1e-5);
    let lengths = [&arrangement, &seamed.arrangement].map(|it| covered_m(&domain, it));
    for (old, new) in lengths[0].iter().zip(&lengths[1]) {
        assert!((old - new).abs() < 1e-6);
    }
    let hanging = (after.curves.iter()).filter(|curve| curve.is_seam && curve.left == curve.right);
    assert_eq!(hanging.count(), 0);
    let quads = |area_m2: f64| area_m2 / SIZE_M / SIZE_M / budget_quads;
    Cut {
        sizes: (after.subdomains.iter())
            .map(|it| quads(it.area_m2))
            .collect(),
        seamed,
        before,
        after,
    }
}

#[test]
fn small_domain_is_left_alone() {
    let square = boundary(&[(0.0, 0.0), (11.8, 0.0), (11.8, 11.8), (0.0, 11.8)]);
    let made = cut_well(&[square], 100.0);
    assert_eq!(made.seamed.cuts, 0);
    assert_eq!(made.before, made.after);
}

#[test]
fn square_is_cut_into_even_parts() {
    let square = boundary(&[(0.3, 0.2), (200.4, 0.2), (200.4, 200.9), (0.3, 200.9)]);
    let made = cut_well(&[square], 2000.0);
    assert!(made.seamed.findings.is_empty());
    assert!((20..50).contains(&made.sizes.len()), "{}", made.sizes.len());
    assert!(made.sizes.iter().all(|size| (0.2..=1.5).contains(size)));
}

#[test]
fn slanted_square_is_cut() {
    let square = boundary(&[(0.0, 0.0), (170.3, 71.2), (99.1, 241.5), (-71.2, 170.3)]);
    let made = cut_well(&[square], 2000.0);
    assert!(made.seamed.findings.is_empty());
}

#[test]
fn letter_l_is_cut() {
    let l = boundary(&[
        (0.0, 0.0),
        (150.5, 0.0),
        (150.5, 40.2),
        (40.7, 40.2),
        (40.7, 150.0),
        (0.0, 150.0),
    ]);
    assert!(cut_well(&[l], 1000.0).seamed.findings.is_empty());
}

#[test]
fn ring_is_cut_though_each_seam_alone_does_not_divide_it() {
    let circle = |radius: f64, n: i32| -> Vec<At> {
        (0..n)
            .map(|k| std::f64::consts::TAU * f64::from(k) / f64::from(n))
            .map(|angle| (radius * angle.cos(), radius * angle.sin()))
            .collect()
    };
    let lines = [boundary(&circle(100.0, 90)), hole(&circle(70.0, 50))];
    let made = cut_well(&lines, 2000.0);
    assert!(made.seamed.findings.is_empty());
    assert!(made.after.subdomains.iter().all(|it| it.walks.len() == 1));
}

#[test]
fn comb_of_slits_is_cut() {
    let mut lines = vec![boundary(&[
        (0.0, 0.0),
        (200.0, 0.0),
        (200.0, 100.0),
        (0.0, 100.0),
    ])];
    for k in 1..25 {
        let x = 8.0 * f64::from(k) + 0.3;
        lines.push(slit(&[(x, 0.0), (x + 1.1, 60.0 + f64::from(k))]));
    }
    assert!(cut_well(&lines, 1500.0).seamed.findings.is_empty());
}

#[test]
fn slits_and_holes_are_no_obstacle() {
    let mut lines = vec![boundary(&[
        (0.0, 0.0),
        (300.0, 0.0),
        (300.0, 200.0),
        (0.0, 200.0),
    ])];
    for k in 0..60 {
        let (x, y) = (
            12.0 + f64::from(k * 37 % 270),
            10.0 + f64::from(k * 61 % 170),
        );
        if k % 3 == 0 {
            lines.push(hole(&[(x, y), (x + 4.0, y + 1.0), (x + 3.0, y + 6.0)]));
        } else {
            lines.push(slit(&[(x, y), (x + 5.5, y + 2.2), (x + 9.0, y - 1.0)]));
        }
    }
    assert!(cut_well(&lines, 2000.0).seamed.findings.is_empty());
}

#[test]
fn corridor_too_narrow_for_a_seam_is_a_finding_with_its_place() {
    let corridor = boundary(&[(0.0, 0.0), (900.0, 0.0), (900.0, 1.9), (0.0, 1.9)]);
    let made = cut_well(&[corridor], 1000.0);
    assert_eq!((made.seamed.cuts, made.seamed.findings.len()), (0, 1));
    assert_eq!(made.seamed.findings[0].what, "large-part");
    assert!(made.seamed.findings[0].at_m.is_some());
}

#[test]
fn several_faces_are_cut_and_small_ones_are_not() {
    let mut lines = vec![boundary(&[
        (0.0, 0.0),
        (200.0, 0.0),
        (200.0, 100.0),
        (0.0, 100.0),
    ])];
    lines.push(slit(&[(100.2, 0.0), (99.1, 100.0)]));
    lines.push(slit(&[
        (20.0, 20.0),
        (40.0, 20.0),
        (40.0, 40.0),
        (20.0, 40.0),
        (20.0, 20.0),
    ]));
    let made = cut_well(&lines, 2000.0);
    assert!(made.seamed.findings.is_empty());
    let small = (made.before.subdomains.iter()).find(|it| it.area_m2 == 40_000.0);
    assert!(small.is_some());
    assert!(
        made.after
            .subdomains
            .iter()
            .any(|it| it.area_m2 == 40_000.0)
    );
}

/// A star-shaped domain full of slits in all directions that cross each other as they like.
fn mess() -> impl Strategy<Value = Vec<(Role, Vec<At>)>> {
    let radii = prop::collection::vec(30.0..90.0, 5..40);
    let slits = prop::collection::vec((-80.0..80.0, -80.0..80.0, -20.0..20.0, -20.0..20.0), 0..50);
    (radii, slits).prop_map(|(radii, slits)| {
        let n = radii.len() as f64;
        let rim: Vec<At> = (radii.iter().enumerate())
            .map(|(k, radius)| (std::f64::consts::TAU * k as f64 / n, radius))
            .map(|(angle, radius)| (radius * angle.cos(), radius * angle.sin()))
            .collect();
        let mut lines = vec![boundary(&rim)];
        lines.extend(
            slits
                .iter()
                .map(|&(x, y, dx, dy)| slit(&[(x, y), (x + dx, y + dy)])),
        );
        lines
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(120))]

    #[test]
    fn promises_hold_in_any_mess(lines in mess(), budget in 300.0..3000.0) {
        cut_well(&lines, budget);
    }
}
