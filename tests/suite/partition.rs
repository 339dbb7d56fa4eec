//! Tests of `partition`.

use polder::domain::line::Domain;
use polder::domain::line::Line;
use polder::domain::line::Role;
use polder::geometry::grid::Grid;
use polder::geometry::point::Point;
use polder::noding::arrangement::Arrangement;
use polder::noding::arrangement::Piece;
use polder::partition;
use polder::partition::Options;
use polder::partition::check::check;
use polder::partition::error::Error;
use polder::partition::subdomains::Curve;
use polder::partition::subdomains::OUTSIDE;
use polder::partition::subdomains::Partition;
use proptest::prelude::*;

const OPTIONS: Options = Options {
    corner_deg: 30.0,
    tile_cells: 1 << 20,
};

type At = (i32, i32);

/// A line as written in a test.
type Written<'a> = (Role, &'a [At]);

/// Lines that meet only at their points, as a domain on a grid of 1 m.
fn domain(lines: &[Written]) -> Domain {
    let line = |(source, (role, points)): (usize, &Written)| Line {
        source: source as u32,
        role: *role,
        kind: 0,
        name: String::new(),
        points: points.iter().map(|&(x, y)| Point::new(x, y)).collect(),
    };
    Domain {
        grid: Grid {
            origin_m: [0.0, 0.0],
            cell_m: 1.0,
        },
        epsg: None,
        kinds: vec![String::new()],
        lines: lines.iter().enumerate().map(line).collect(),
        digest: 0,
    }
}

/// Each segment of each line as an edge.
fn arrange(domain: &Domain) -> Arrangement {
    let mut points = Vec::new();
    let mut edges = Vec::new();
    for (id, line) in domain.lines.iter().enumerate() {
        let stations = domain.stations_m(id as u32);
        for k in 1..line.points.len() {
            let first = points.len() as u32;
            points.extend([line.points[k - 1], line.points[k]]);
            let piece = Piece {
                line: id as u32,
                from_m: stations[k - 1],
                to_m: stations[k],
            };
            edges.push(([first, first + 1], vec![piece]));
        }
    }
    Arrangement::from_parts(&points, edges)
}

fn partition_of(lines: &[Written]) -> (Domain, Arrangement, Partition) {
    let domain = domain(lines);
    let arrangement = arrange(&domain);
    let made = partition::partition(&domain, &arrangement, &OPTIONS).unwrap();
    assert_eq!(check(&domain, &arrangement, &made), Ok(()));
    for tile_cells in [1, 7, 30, 100] {
        let options = Options {
            tile_cells,
            ..OPTIONS
        };
        let tiled = partition::partition(&domain, &arrangement, &options);
        assert_eq!(tiled.as_ref(), Ok(&made));
    }
    (domain, arrangement, made)
}

const SQUARE: Written = (
    Role::Boundary,
    &[(0, 0), (100, 0), (100, 100), (0, 100), (0, 0)],
);

/// The square and some lines: number of curves, then of walks in each sub-domain, by area.
fn shape(lines: &[&[At]]) -> (usize, Vec<(usize, f64)>) {
    let mut all = vec![SQUARE];
    all.extend(lines.iter().map(|&line| (Role::Constraint, line)));
    let (_, _, made) = partition_of(&all);
    let mut faces: Vec<(usize, f64)> = made
        .subdomains
        .iter()
        .map(|it| (it.walks.len(), it.area_m2))
        .collect();
    faces.sort_by(|a, b| a.1.total_cmp(&b.1));
    (made.curves.len(), faces)
}

#[test]
fn square_is_one_subdomain_of_four_curves() {
    assert_eq!(shape(&[]), (4, vec![(1, 10_000.0)]));
}

#[test]
fn free_line_isolated_is_a_walk_of_its_own() {
    assert_eq!(
        shape(&[&[(20, 20), (40, 22), (60, 20)]]),
        (5, vec![(2, 10_000.0)])
    );
}

#[test]
fn free_line_with_a_corner_is_two_curves() {
    assert_eq!(
        shape(&[&[(20, 20), (40, 20), (40, 60)]]),
        (6, vec![(2, 10_000.0)])
    );
}

#[test]
fn antenna_at_a_corner_joins_the_outer_walk() {
    assert_eq!(shape(&[&[(0, 0), (40, 30)]]), (5, vec![(1, 10_000.0)]));
}

#[test]
fn line_from_corner_to_corner_cuts_the_square() {
    assert_eq!(
        shape(&[&[(0, 0), (100, 100)]]),
        (5, vec![(1, 5_000.0), (1, 5_000.0)])
    );
}

#[test]
fn tree_is_one_walk() {
    assert_eq!(
        shape(&[
            &[(50, 20), (50, 40)],
            &[(50, 40), (30, 60)],
            &[(50, 40), (70, 60)],
            &[(30, 60), (20, 60)],
            &[(30, 60), (30, 80)],
        ]),
        (9, vec![(2, 10_000.0)])
    );
}

#[test]
fn island_is_a_subdomain_and_a_walk_of_its_neighbour() {
    assert_eq!(
        shape(&[&[(40, 40), (60, 40), (60, 60), (40, 60), (40, 40)]]),
        (8, vec![(1, 400.0), (2, 9_600.0)])
    );
}

#[test]
fn nested_loops_lie_in_the_next_larger_one() {
    assert_eq!(
        shape(&[
            &[(10, 10), (90, 10), (90, 90), (10, 90), (10, 10)],
            &[(20, 20), (80, 20), (80, 80), (20, 80), (20, 20)],
            &[(30, 30), (70, 30), (70, 70), (30, 70), (30, 30)],
        ]),
        (16, vec![(1, 1600.0), (2, 2000.0), (2, 2800.0), (2, 3600.0)])
    );
}

#[test]
fn bridge_between_nested_loops_makes_one_walk() {
    assert_eq!(
        shape(&[
            &[(10, 10), (90, 10), (90, 90), (10, 90), (10, 10)],
            &[(20, 20), (80, 20), (80, 80), (20, 80), (20, 20)],
            &[(10, 10), (20, 20)],
        ]),
        (13, vec![(1, 2800.0), (2, 3600.0), (1, 3600.0)])
    );
}

#[test]
fn loops_touching_in_a_point_from_outside_are_one_walk() {
    assert_eq!(
        shape(&[
            &[(20, 50), (35, 35), (50, 50), (35, 65), (20, 50)],
            &[(50, 50), (65, 35), (80, 50), (65, 65), (50, 50)],
        ]),
        (12, vec![(1, 450.0), (1, 450.0), (2, 9_100.0)])
    );
}

#[test]
fn loop_touching_another_from_inside_is_cut_off_its_outer_walk() {
    assert_eq!(
        shape(&[
            &[(20, 20), (80, 20), (80, 80), (20, 80), (20, 20)],
            &[(20, 20), (40, 30), (30, 40), (20, 20)],
        ]),
        (11, vec![(1, 150.0), (1, 3450.0), (2, 6400.0)])
    );
}

#[test]
fn islands_in_a_row_all_find_the_same_subdomain() {
    let islands: Vec<[At; 4]> = (0..20)
        .map(|k| {
            let (x, y) = (2 + 4 * k, 90 - 4 * k);
            [(x, y), (x + 2, y), (x + 1, y + 2), (x, y)]
        })
        .collect();
    let lines: Vec<&[At]> = islands.iter().map(|it| it.as_slice()).collect();
    let (curves, faces) = shape(&lines);
    assert_eq!((curves, faces.len()), (4 + 60, 21));
    assert_eq!(faces[20], (21, 10_000.0 - 40.0));
}

#[test]
fn hole_is_outside_and_a_line_may_join_it_to_the_rim() {
    let hole = (
        Role::Hole,
        &[(40, 40), (60, 40), (60, 60), (40, 60), (40, 40)][..],
    );
    let (_, _, made) = partition_of(&[SQUARE, hole]);
    assert_eq!(made.subdomains[0].walks.len(), 2);
    assert_eq!(made.subdomains[0].area_m2, 9_600.0);
    let outside = |curve: &Curve| [curve.left, curve.right].contains(&OUTSIDE);
    assert!(made.curves.len() == 8 && made.curves.iter().all(outside));
    let bridge = (Role::Constraint, &[(0, 0), (40, 40)][..]);
    let (_, _, made) = partition_of(&[SQUARE, hole, bridge]);
    assert_eq!(made.subdomains[0].walks.len(), 1);
}

#[test]
fn domain_in_two_parts_has_two_subdomains() {
    let other = (
        Role::Boundary,
        &[(200, 0), (210, 0), (200, 10), (200, 0)][..],
    );
    let (_, _, made) = partition_of(&[SQUARE, other]);
    assert_eq!(made.subdomains.len(), 2);
}

#[test]
fn closed_chain_without_junction_begins_at_its_least_node() {
    let ring: Vec<At> = (0..=24)
        .map(|k| {
            let angle = f64::from((k + 7) % 24) / 24.0 * std::f64::consts::TAU;
            let radius = 1000.0;
            (
                (radius * angle.cos()).round() as i32,
                (radius * angle.sin()).round() as i32,
            )
        })
        .collect();
    let (_, _, made) = partition_of(&[(Role::Boundary, &ring)]);
    assert_eq!(made.curves.len(), 1);
    let nodes = &made.curves[0].nodes;
    assert_eq!((nodes[0], nodes[24]), (0, 0));
}

#[test]
fn chain_ends_where_the_source_changes() {
    assert_eq!(
        shape(&[&[(20, 20), (40, 22)], &[(40, 22), (60, 20)]]),
        (6, vec![(2, 10_000.0)])
    );
}

#[test]
fn edges_without_pieces_are_seams() {
    let domain = domain(&[SQUARE]);
    let square = arrange(&domain);
    let mut edges: Vec<([u32; 2], Vec<Piece>)> = (0..4)
        .map(|e| (square.edges[e as usize], square.pieces_of(e).to_vec()))
        .collect();
    edges.push(([0, 3], Vec::new()));
    let arrangement = Arrangement::from_parts(&square.points, edges);
    let made = partition::partition(&domain, &arrangement, &OPTIONS).unwrap();
    assert_eq!(check(&domain, &arrangement, &made), Ok(()));
    assert_eq!(made.subdomains.len(), 2);
    let seams: Vec<bool> = made.curves.iter().map(|curve| curve.is_seam).collect();
    assert_eq!(seams.iter().filter(|&&it| it).count(), 1);
}

#[test]
fn every_node_of_a_seam_is_a_junction() {
    let domain = domain(&[SQUARE]);
    let square = arrange(&domain);
    let mut points = square.points.clone();
    points.extend([Point::new(30, 30), Point::new(60, 60)]);
    let mut edges: Vec<([u32; 2], Vec<Piece>)> = (0..4)
        .map(|e| (square.edges[e as usize], square.pieces_of(e).to_vec()))
        .collect();
    edges.extend([[0, 4], [4, 5], [5, 3]].map(|edge| (edge, Vec::new())));
    let arrangement = Arrangement::from_parts(&points, edges);
    let made = partition::partition(&domain, &arrangement, &OPTIONS).unwrap();
    assert_eq!(made.curves.iter().filter(|it| it.is_seam).count(), 3);
}

#[test]
fn no_inside_is_an_error_with_a_place() {
    let domain = domain(&[SQUARE]);
    let empty = Arrangement {
        piece_start: vec![0],
        ..Arrangement::default()
    };
    let made = partition::partition(&domain, &empty, &OPTIONS);
    assert_eq!(made, Err(Error::NoInside { at_m: [0.0, 0.0] }));
    assert!(made.unwrap_err().to_string().contains("0.000 0.000"));
}

#[test]
fn rim_with_a_gap_is_an_error_with_a_place() {
    let (domain, whole, _) = partition_of(&[SQUARE]);
    let edges = (1..4).map(|e| (whole.edges[e as usize], whole.pieces_of(e).to_vec()));
    let torn = Arrangement::from_parts(&whole.points, edges.collect());
    let made = partition::partition(&domain, &torn, &OPTIONS);
    assert!(matches!(made, Err(Error::TornRim { .. })), "{made:?}");
}

/// A lattice of cells, some inside the domain, with some of the edges between them as lines:
/// islands, trees, holes, pinches and disconnected parts of every kind. Faces are known by flood.
#[derive(Clone, Debug)]
struct Lattice {
    wide: usize,
    high: usize,
    inside: Vec<bool>,
    /// Line of the edge right of and above each cell; 0 for none.
    right: Vec<u8>,
    above: Vec<u8>,
    /// Images of the unit vectors.
    shear: [At; 2],
}

impl Lattice {
    /// Sub-domain of each cell by flood, numbered arbitrarily; `usize::MAX` outside.
    fn flood(&self) -> Vec<usize> {
        let mut label = vec![usize::MAX; self.wide * self.high];
        let mut labels = 0;
        for first in 0..label.len() {
            if !self.inside[first] || label[first] != usize::MAX {
                continue;
            }
            let mut todo = vec![first];
            while let Some(cell) = todo.pop() {
                if label[cell] != usize::MAX || !self.inside[cell] {
                    continue;
                }
                label[cell] = labels;
                let (x, y) = (cell % self.wide, cell / self.wide);
                if x + 1 < self.wide && self.right[cell] == 0 {
                    todo.push(cell + 1);
                }
                if x > 0 && self.right[cell - 1] == 0 {
                    todo.push(cell - 1);
                }
                if y + 1 < self.high && self.above[cell] == 0 {
                    todo.push(cell + self.wide);
                }
                if y > 0 && self.above[cell - self.wide] == 0 {
                    todo.push(cell - self.wide);
                }
            }
            labels += 1;
        }
        label
    }

    fn cell(&self, x: i32, y: i32) -> Option<usize> {
        let is_cell = (0..self.wide as i32).contains(&x) && (0..self.high as i32).contains(&y);
        is_cell.then(|| y as usize * self.wide + x as usize)
    }

    fn is_inside(&self, x: i32, y: i32) -> bool {
        self.cell(x, y).is_some_and(|cell| self.inside[cell])
    }

    /// Lattice edges: line, from, to, the cell on the left and that on the right.
    fn edges(&self) -> Vec<(u8, [At; 4])> {
        let mut edges = Vec::new();
        for y in -1..self.high as i32 {
            for x in -1..self.wide as i32 {
                let line = |edges: &[u8]| self.cell(x, y).map_or(1, |cell| edges[cell]);
                let right = [(x + 1, y), (x + 1, y + 1), (x, y), (x + 1, y)];
                edges.push((line(&self.right), right));
                let above = [(x, y + 1), (x + 1, y + 1), (x, y + 1), (x, y)];
                edges.push((line(&self.above), above));
            }
        }
        edges
    }

    fn at(&self, (x, y): At) -> Point {
        let [u, v] = self.shear;
        Point::new(x * u.0 + y * v.0, x * u.1 + y * v.1)
    }

    /// Lines 0 and 1 are rims, a boundary and a hole; the others are constraints.
    fn arrange(&self) -> (Domain, Arrangement) {
        let role = |line| match line {
            0 => Role::Boundary,
            1 => Role::Hole,
            _ => Role::Constraint,
        };
        let dummy: &[At] = &[(0, 0), (1, 0)];
        let domain = domain(&[0, 1, 2, 3, 4].map(|line| (role(line), dummy)));
        let mut points = Vec::new();
        let mut edges = Vec::new();
        for (line, [from, to, left, right]) in self.edges() {
            let sides = [
                self.is_inside(left.0, left.1),
                self.is_inside(right.0, right.1),
            ];
            let piece = match sides {
                [false, false] => continue,
                [true, true] if line == 0 => continue,
                [true, true] => (u32::from(line) + 1, true),
                [is_left, _] => (u32::from(line) % 2, is_left == (line % 2 == 0)),
            };
            let (from_m, to_m) = if piece.1 { (0.0, 1.0) } else { (1.0, 0.0) };
            let line = piece.0;
            let first = points.len() as u32;
            points.extend([self.at(from), self.at(to)]);
            edges.push(([first, first + 1], vec![Piece { line, from_m, to_m }]));
        }
        (domain, Arrangement::from_parts(&points, edges))
    }
}

fn lattice() -> impl Strategy<Value = Lattice> {
    let shears = prop_oneof![
        Just([(1, 0), (0, 1)]),
        Just([(3, 1), (-2, 5)]),
        Just([(-7, 2), (1, -6)]),
        Just([(1 << 20, 1), (1, 1 << 20)]),
    ];
    (1..9usize, 1..9usize, shears, 0..4u8, 2..7u8).prop_flat_map(
        |(wide, high, shear, out, open)| {
            let n = wide * high;
            // Dense and sparse mixtures of outside cells and lines.
            let inside = prop::collection::vec((0..10u8).prop_map(move |it| it >= out), n);
            let line = move || (0..10u8).prop_map(move |it| if it < open { 0 } else { 1 + it % 3 });
            let right = prop::collection::vec(line(), n);
            let above = prop::collection::vec(line(), n);
            (inside, right, above).prop_map(move |(inside, right, above)| Lattice {
                wide,
                high,
                inside,
                right,
                above,
                shear,
            })
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Slow twin: flood over cells. Sub-domains on both sides of each edge, areas, count.
    #[test]
    fn subdomains_are_those_of_a_flood(lattice in lattice(), tile_cells in 1..40u32) {
        let (domain, arrangement) = lattice.arrange();
        let made = partition::partition(&domain, &arrangement, &OPTIONS);
        let label = lattice.flood();
        let faces = label.iter().filter(|&&it| it != usize::MAX).max().map_or(0, |it| it + 1);
        if faces == 0 {
            let is_empty = matches!(made, Err(Error::NoInside { .. }));
            prop_assert!(is_empty);
            return Ok(());
        }
        let made = made.unwrap();
        prop_assert_eq!(check(&domain, &arrangement, &made), Ok(()));
        prop_assert_eq!(made.subdomains.len(), faces);
        let [u, v] = lattice.shear;
        let det = f64::from(u.0) * f64::from(v.1) - f64::from(u.1) * f64::from(v.0);
        let mut known = vec![None; faces];
        let mut sides = std::collections::BTreeMap::new();
        for curve in &made.curves {
            for pair in curve.nodes.windows(2) {
                let [a, b] = [0, 1].map(|k| arrangement.points[pair[k] as usize]);
                sides.insert((a, b), curve.left);
                sides.insert((b, a), curve.right);
            }
        }
        for (_, [from, to, left, right]) in lattice.edges() {
            let (a, b) = (lattice.at(from), lattice.at(to));
            let Some(&found) = sides.get(&(a, b)) else { continue };
            for (found, (x, y)) in [(found, left), (sides[&(b, a)], right)] {
                let want = lattice.cell(x, y).map_or(usize::MAX, |cell| label[cell]);
                if want == usize::MAX {
                    prop_assert_eq!(found, OUTSIDE);
                } else {
                    let area = label.iter().filter(|&&it| it == want).count() as f64 * det;
                    prop_assert_eq!(made.subdomains[found as usize].area_m2, area);
                    prop_assert_eq!(*known[want].get_or_insert(found), found);
                }
            }
        }
        let options = Options { tile_cells, ..OPTIONS };
        let tiled = partition::partition(&domain, &arrangement, &options).unwrap();
        prop_assert_eq!(tiled, made);
    }

    /// Slow twin: a curve could go on only where there is no reason to end it.
    #[test]
    fn curves_are_maximal(lattice in lattice()) {
        let (domain, arrangement) = lattice.arrange();
        let Ok(made) = partition::partition(&domain, &arrangement, &OPTIONS) else { return Ok(()) };
        let mut ends: Vec<(u32, u32, u32)> = Vec::new();
        for curve in &made.curves {
            let last = curve.nodes.len() - 1;
            if curve.nodes[0] == curve.nodes[last] {
                continue;
            }
            ends.push((curve.nodes[0], curve.nodes[1], curve.edges[0]));
            ends.push((curve.nodes[last], curve.nodes[last - 1], curve.edges[last - 1]));
        }
        ends.sort_unstable();
        for at in ends.chunk_by(|a, b| a.0 == b.0).filter(|at| at.len() == 2) {
            let [p, a, b] = [at[0].0, at[0].1, at[1].1].map(|it| arrangement.points[it as usize]);
            let straight = i64::from(a.x) + i64::from(b.x) == 2 * i64::from(p.x)
                && i64::from(a.y) + i64::from(b.y) == 2 * i64::from(p.y);
            let lines = [0, 1].map(|k| arrangement.pieces_of(at[k].2)[0].line);
            prop_assert!(!straight || lines[0] != lines[1]);
        }
    }
}

#[test]
fn many_nested_rings_take_no_quadratic_time() {
    let n = 20_000;
    let rings: Vec<[At; 5]> = (0..n)
        .map(|k| {
            [
                (k, k),
                (3 * n - k, k),
                (3 * n - k, 3 * n - k),
                (k, 3 * n - k),
                (k, k),
            ]
        })
        .collect();
    let lines: Vec<Written> = rings
        .iter()
        .enumerate()
        .map(|(k, ring)| {
            (
                if k == 0 {
                    Role::Boundary
                } else {
                    Role::Constraint
                },
                &ring[..],
            )
        })
        .collect();
    let domain = domain(&lines);
    let arrangement = arrange(&domain);
    let made = partition::partition(&domain, &arrangement, &OPTIONS).unwrap();
    assert_eq!(check(&domain, &arrangement, &made), Ok(()));
    let two = made.subdomains.iter().filter(|it| it.walks.len() == 2);
    assert_eq!(two.count(), n as usize - 1);
}
