//! Tests of `noding`.

use polder::domain::line::Domain;
use polder::domain::line::Line;
use polder::domain::line::Role;
use polder::geometry::crossing::along;
use polder::geometry::crossing::crossing;
use polder::geometry::crossing::passes_pixel;
use polder::geometry::grid::Grid;
use polder::geometry::point::Point;
use polder::ingest::CrsChoice;
use polder::noding::Options;
use polder::noding::arrangement::Arrangement;
use polder::noding::arrangement::Piece;
use polder::noding::check::check;
use polder::noding::clip;
use polder::noding::node;
use polder::noding::rim::rim_side;
use proptest::collection::vec;
use proptest::prelude::*;
use std::path::Path;
use std::time::Instant;

// ------------------------------------------------------------------------------------ making

fn domain(lines: Vec<(Role, Vec<(i32, i32)>)>) -> Domain {
    let lines = lines
        .into_iter()
        .enumerate()
        .filter_map(|(source, (role, points))| {
            let mut points: Vec<Point> = points.iter().map(|&(x, y)| Point::new(x, y)).collect();
            points.dedup();
            (points.len() > 1).then(|| Line {
                source: source as u32,
                role,
                kind: 0,
                name: String::new(),
                points,
            })
        })
        .collect();
    Domain {
        grid: Grid {
            origin_m: [0.0, 0.0],
            cell_m: 0.001,
        },
        epsg: None,
        kinds: vec![String::new()],
        lines,
        digest: 0,
    }
}

fn constraints(lines: Vec<Vec<(i32, i32)>>) -> Domain {
    domain(
        lines
            .into_iter()
            .map(|line| (Role::Constraint, line))
            .collect(),
    )
}

/// A ring through the points, with the polygon on its left.
fn ring(mut points: Vec<(i32, i32)>) -> Vec<(i32, i32)> {
    points.push(points[0]);
    let doubled: i32 = points
        .windows(2)
        .map(|p| p[0].0 * p[1].1 - p[1].0 * p[0].1)
        .sum();
    if doubled < 0 {
        points.reverse();
    }
    points
}

fn line_work(size: i32, lines: usize) -> impl Strategy<Value = Vec<Vec<(i32, i32)>>> {
    vec(vec((0..size, 0..size), 2..5), 1..lines)
}

// ------------------------------------------------------------------------------------- twins

/// All pairs, all pixels, no tree, no tiles.
fn node_twin(domain: &Domain) -> Arrangement {
    let segments: Vec<(u32, usize, Point, Point)> = (domain.lines.iter().enumerate())
        .flat_map(|(line, of)| {
            let pairs = of.points.windows(2).enumerate();
            pairs.map(move |(at, pair)| (line as u32, at, pair[0], pair[1]))
        })
        .collect();
    let mut hot: Vec<Point> = segments.iter().flat_map(|s| [s.2, s.3]).collect();
    for s in &segments {
        for t in &segments {
            hot.extend(crossing(s.2, s.3, t.2, t.3));
        }
    }
    hot.sort_unstable();
    hot.dedup();
    let mut edges = Vec::new();
    for &(line, at, a, b) in &segments {
        let mut stops: Vec<u32> = (0..hot.len() as u32)
            .filter(|&node| passes_pixel(a, b, hot[node as usize]))
            .collect();
        stops.sort_by_key(|&node| along(a, b, hot[node as usize]));
        let stations = domain.stations_m(line);
        let station = |node: u32| {
            let share = along(a, b, hot[node as usize]) as f64 / a.distance2(b) as f64;
            stations[at] + share * (stations[at + 1] - stations[at])
        };
        for pair in stops.windows(2) {
            let (from_m, to_m) = (station(pair[0]), station(pair[1]));
            edges.push(([pair[0], pair[1]], vec![Piece { line, from_m, to_m }]));
        }
    }
    Arrangement::from_parts(&hot, edges)
}

/// Equal, but for the last bits of stations.
fn assert_same(made: &Arrangement, twin: &Arrangement) {
    assert_eq!(made.points, twin.points);
    assert_eq!(made.edges, twin.edges);
    assert_eq!(made.piece_start, twin.piece_start);
    for (p, q) in made.pieces.iter().zip(&twin.pieces) {
        assert_eq!(p.line, q.line);
        assert!((p.from_m - q.from_m).abs() <= 1e-12 * p.from_m.max(1.0));
        assert!((p.to_m - q.to_m).abs() <= 1e-12 * p.to_m.max(1.0));
    }
}

/// Every line is covered from 0 to its length, end to end, by a chain of edges.
fn assert_covered(domain: &Domain, arrangement: &Arrangement) {
    let mut pieces: Vec<(u32, f64, f64, u32, u32)> = Vec::new();
    for (edge, &[a, b]) in arrangement.edges.iter().enumerate() {
        for piece in arrangement.pieces_of(edge as u32) {
            pieces.push(if piece.from_m < piece.to_m {
                (piece.line, piece.from_m, piece.to_m, a, b)
            } else {
                (piece.line, piece.to_m, piece.from_m, b, a)
            });
        }
    }
    pieces.sort_by(|s, t| s.partial_cmp(t).unwrap());
    let mut rest = pieces.as_slice();
    for (id, line) in domain.lines.iter().enumerate() {
        let count = rest.iter().take_while(|piece| piece.0 == id as u32).count();
        let (of_line, others) = rest.split_at(count);
        rest = others;
        let (first, last) = (of_line.first().unwrap(), of_line.last().unwrap());
        assert_eq!(
            (first.1, last.2),
            (0.0, *domain.stations_m(id as u32).last().unwrap())
        );
        assert_eq!(arrangement.points[first.3 as usize], line.points[0]);
        assert_eq!(
            arrangement.points[last.4 as usize],
            *line.points.last().unwrap()
        );
        for pair in of_line.windows(2) {
            assert_eq!(
                (pair[0].2, pair[0].4),
                (pair[1].1, pair[1].3),
                "line {id} has a gap"
            );
        }
    }
    assert!(rest.is_empty());
}

/// Each node is within half a pixel's diagonal of each position of a line that it stands for.
fn assert_near(domain: &Domain, arrangement: &Arrangement) {
    for (edge, ends) in arrangement.edges.iter().enumerate() {
        for piece in arrangement.pieces_of(edge as u32) {
            for (node, at_m) in [(ends[0], piece.from_m), (ends[1], piece.to_m)] {
                let (x, y) = position(domain, piece.line, at_m);
                let p = arrangement.points[node as usize];
                let moved = (f64::from(p.x) - x).hypot(f64::from(p.y) - y);
                assert!(
                    moved < 0.5_f64.sqrt() + 1e-6,
                    "line {} moved {moved}",
                    piece.line
                );
            }
        }
    }
}

/// The position of a line at a station, cells.
fn position(domain: &Domain, line: u32, at_m: f64) -> (f64, f64) {
    let stations = domain.stations_m(line);
    let at = stations
        .partition_point(|&s| s <= at_m)
        .clamp(1, stations.len() - 1)
        - 1;
    let share = (at_m - stations[at]) / (stations[at + 1] - stations[at]);
    let (a, b) = (
        domain.lines[line as usize].points[at],
        domain.lines[line as usize].points[at + 1],
    );
    (
        f64::from(a.x) + share * f64::from(b.x - a.x),
        f64::from(a.y) + share * f64::from(b.y - a.y),
    )
}

fn assert_noded(domain: &Domain, tile_cells: &[i32]) -> Arrangement {
    let one = node(
        domain,
        &Options {
            tile_cells: 1 << 29,
        },
    );
    check(&one).unwrap();
    assert_covered(domain, &one);
    assert_near(domain, &one);
    for &tile_cells in tile_cells {
        assert_eq!(
            one,
            node(domain, &Options { tile_cells }),
            "tile of {tile_cells}"
        );
    }
    one
}

/// How often rings of `role` wind around a place (in half cells, on no ring), by the angle-free
/// crossing rule on the arrangement's own edges.
fn winding_twin(domain: &Domain, arrangement: &Arrangement, role: Role, at: (f64, f64)) -> i32 {
    let mut winding = 0;
    for (edge, &[a, b]) in arrangement.edges.iter().enumerate() {
        let (a, b) = (
            arrangement.points[a as usize],
            arrangement.points[b as usize],
        );
        let (ax, ay, bx, by) = (
            f64::from(a.x),
            f64::from(a.y),
            f64::from(b.x),
            f64::from(b.y),
        );
        if (ay <= at.1) == (by <= at.1) || ax + (at.1 - ay) / (by - ay) * (bx - ax) < at.0 {
            continue;
        }
        let upward = if by > ay { 1 } else { -1 };
        for piece in arrangement.pieces_of(edge as u32) {
            if domain.lines[piece.line as usize].role == role {
                winding += if piece.from_m < piece.to_m {
                    upward
                } else {
                    -upward
                };
            }
        }
    }
    winding
}

/// Both sides of each edge by stepping off its middle by far less than the arrangement's detail.
fn sides_twin(domain: &Domain, arrangement: &Arrangement, [a, b]: [u32; 2]) -> [bool; 2] {
    let (a, b) = (
        arrangement.points[a as usize],
        arrangement.points[b as usize],
    );
    let (dx, dy) = (f64::from(b.x - a.x), f64::from(b.y - a.y));
    [1.0, -1.0].map(|side| {
        let step = side * 1e-5 / dx.hypot(dy);
        let at = (
            f64::from(a.x) + dx / 2.0 - dy * step,
            f64::from(a.y) + dy / 2.0 + dx * step,
        );
        winding_twin(domain, arrangement, Role::Boundary, at) > 0
            && winding_twin(domain, arrangement, Role::Hole, at) <= 0
    })
}

fn assert_clipped(domain: &Domain) {
    let whole = node(
        domain,
        &Options {
            tile_cells: 1 << 29,
        },
    );
    let (clipped, outside) = clip(domain, whole.clone());
    check(&clipped).unwrap();
    let mut left_m = 0.0;
    let length_m = |pieces: &[Piece]| -> f64 {
        let constraint = |p: &&Piece| domain.lines[p.line as usize].role == Role::Constraint;
        pieces
            .iter()
            .filter(constraint)
            .map(|p| (p.to_m - p.from_m).abs())
            .sum()
    };
    let find = |edge: [u32; 2]| {
        let ends = edge.map(|node| whole.points[node as usize]);
        let [a, b] = ends.map(|p| clipped.points.binary_search(&p).ok());
        let edge = [a? as u32, b? as u32];
        clipped
            .edges
            .binary_search(&edge)
            .ok()
            .map(|edge| edge as u32)
    };
    for (edge, &ends) in whole.edges.iter().enumerate() {
        let sides = sides_twin(domain, &whole, ends);
        let length = length_m(whole.pieces_of(edge as u32));
        let kept = find(ends).map(|edge| clipped.pieces_of(edge));
        let expected_rim = i32::from(sides[0]) - i32::from(sides[1]);
        match kept {
            None => {
                assert!(sides[0] == sides[1], "an edge of the rim is gone");
                assert!(sides == [false; 2] || length == 0.0, "a line is gone");
                left_m += length;
            }
            Some(pieces) => {
                assert_ne!(sides, [false; 2], "an edge outside is left");
                assert_eq!(rim_side(domain, pieces), expected_rim);
                assert_eq!(length_m(pieces), length);
                let rings = pieces.iter().any(|p| rim_side(domain, &[*p]) != 0);
                assert_eq!(
                    rings,
                    expected_rim != 0,
                    "ring pieces on the rim and only there"
                );
            }
        }
    }
    let listed: f64 = outside.iter().map(|piece| piece.to_m - piece.from_m).sum();
    assert!(
        (listed - left_m).abs() < 1e-9,
        "{listed} listed, {left_m} left out"
    );
    for pair in outside.windows(2) {
        assert!(pair[0].line < pair[1].line || pair[0].to_m < pair[1].from_m);
    }
}

// ------------------------------------------------------------------------------------- tests

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn noding_is_its_twin_where_snapping_is_violent(lines in line_work(12, 9)) {
        let domain = constraints(lines);
        let made = assert_noded(&domain, &[1, 3, 8]);
        assert_same(&made, &node_twin(&domain));
    }

    #[test]
    fn noding_is_its_twin_on_a_wider_grid(lines in line_work(300, 12)) {
        let domain = constraints(lines);
        let made = assert_noded(&domain, &[7, 64, 200]);
        assert_same(&made, &node_twin(&domain));
    }

    #[test]
    fn clip_is_its_twin(
        boundaries in vec(vec((0..14, 0..14), 3..6), 1..4),
        holes in vec(vec((0..14, 0..14), 3..5), 0..4),
        lines in line_work(14, 5),
    ) {
        let rings = |rings: Vec<Vec<(i32, i32)>>, role| {
            rings.into_iter().map(move |points| (role, ring(points)))
        };
        let mut all: Vec<_> = rings(boundaries, Role::Boundary).collect();
        all.extend(rings(holes, Role::Hole));
        all.extend(lines.into_iter().map(|line| (Role::Constraint, line)));
        assert_clipped(&domain(all));
    }
}

/// Many segments in one place: crossing each other, side by side or equal, and from one point.
#[test]
fn heaps_bundles_and_stars_among_long_lines() {
    let mut lines = Vec::new();
    for k in 0..50 {
        let [a, b] = [(k * 131 % 400, k * 57 % 400), (k * 211 % 400, k * 89 % 400)];
        lines.push(vec![
            (900_000 + a.0, 700_000 + a.1),
            (900_000 + b.0, 700_000 + b.1),
        ]);
        lines.push(vec![(0, 0), (1_000_000, 777_777)]);
        lines.push(vec![(0, 4 * k), (1_000_000, 777_777 + 4 * k)]);
        lines.push(vec![
            (500_000, 200_000),
            (500_000 + 20 * k, 204_000 - 13 * k),
        ]);
    }
    lines.retain(|line| line[0] != line[1]);
    let domain = constraints(lines);
    let made = assert_noded(&domain, &[300, 90_000]);
    assert_same(&made, &node_twin(&domain));
}

#[test]
fn long_segments_at_the_limit_of_the_grid() {
    let e = 1 << 29;
    let domain = constraints(vec![
        vec![(-e, -e), (e, -e), (e, e), (-e, e), (-e, -e)],
        vec![(-e, -e), (e, e)],
        vec![(-e, e), (e, -e + 1)],
        vec![(-7, -e), (8, e)],
    ]);
    let made = assert_noded(&domain, &[1 << 20, 1 << 27, 100_000_007]);
    assert_same(&made, &node_twin(&domain));
}

#[test]
fn two_boundary_polygons_share_a_wall() {
    let domain = domain(vec![
        (
            Role::Boundary,
            ring(vec![(0, 0), (10, 0), (10, 10), (0, 10)]),
        ),
        (
            Role::Boundary,
            ring(vec![(10, 0), (20, 0), (20, 10), (10, 10)]),
        ),
        (Role::Hole, ring(vec![(2, 2), (4, 2), (4, 4), (2, 4)])),
        (Role::Hole, ring(vec![(4, 2), (6, 2), (6, 4), (4, 4)])),
        (Role::Constraint, vec![(-5, 3), (25, 3)]),
    ]);
    assert_clipped(&domain);
    let whole = node(&domain, &Options { tile_cells: 64 });
    let (clipped, outside) = clip(&domain, whole);
    let stretches: Vec<(f64, f64)> = (outside.iter())
        .map(|piece| {
            (
                (piece.from_m * 1000.0).round(),
                (piece.to_m * 1000.0).round(),
            )
        })
        .collect();
    assert_eq!(stretches, [(0.0, 5.0), (7.0, 11.0), (25.0, 30.0)]);
    let wall = [Point::new(10, 0), Point::new(10, 3)];
    let [a, b] = wall.map(|p| clipped.points.binary_search(&p).unwrap_or(9999) as u32);
    assert!(
        clipped.edges.binary_search(&[a, b]).is_err(),
        "the shared wall is no line"
    );
}

#[test]
fn nothing_at_all() {
    let domain = constraints(vec![]);
    let made = node(&domain, &Options { tile_cells: 64 });
    check(&made).unwrap();
    let (clipped, outside) = clip(&domain, made);
    assert!(clipped.edges.is_empty() && outside.is_empty());
}

/// Real cases, if they lie beside the repository or where `POLDER_CASES` says.
fn real_case(name: &str) -> Option<Domain> {
    let folder = std::env::var("POLDER_CASES").unwrap_or("../shared/cases".to_string());
    let path = Path::new(&folder).join(name);
    if !path.exists() {
        println!("skipped: no {}", path.display());
        return None;
    }
    let options = polder::ingest::Options {
        cell_m: 0.001,
        crs: CrsChoice::FromFile,
    };
    let start = Instant::now();
    let read = polder::ingest::read(&path, &options).unwrap_or_else(|error| panic!("{error}"));
    println!("{name}: read in {:.2} s", start.elapsed().as_secs_f64());
    Some(read.domain)
}

/// What the rim encloses: with the domain on its left, by the shoelace formula.
fn rim_area_m2(domain: &Domain, clipped: &Arrangement) -> f64 {
    let mut doubled = 0;
    for (edge, &[a, b]) in clipped.edges.iter().enumerate() {
        let (a, b) = (clipped.points[a as usize], clipped.points[b as usize]);
        let cross = i128::from(a.x) * i128::from(b.y) - i128::from(b.x) * i128::from(a.y);
        doubled += cross * i128::from(rim_side(domain, clipped.pieces_of(edge as u32)));
    }
    doubled as f64 / 2.0 * domain.grid.cell_m * domain.grid.cell_m
}

fn assert_real_case(name: &str, tile_cells: &[i32]) {
    let Some(domain) = real_case(name) else {
        return;
    };
    let options = Options {
        tile_cells: 4_000_000,
    };
    let start = Instant::now();
    let made = node(&domain, &options);
    let noded = start.elapsed().as_secs_f64();
    check(&made).unwrap_or_else(|defect| panic!("{name}: {defect}"));
    assert_covered(&domain, &made);
    for &tile_cells in tile_cells {
        assert_eq!(
            made,
            node(&domain, &Options { tile_cells }),
            "{name}, tile of {tile_cells}"
        );
    }
    let start = Instant::now();
    let (clipped, outside) = clip(&domain, made);
    let clipping = start.elapsed().as_secs_f64();
    println!(
        "{name}: area {} m², noding {noded:.2} s, clip {clipping:.2} s; {} nodes, {} edges, \
         {} pieces, {} outside",
        rim_area_m2(&domain, &clipped),
        clipped.points.len(),
        clipped.edges.len(),
        clipped.pieces.len(),
        outside.len()
    );
    check(&clipped).unwrap_or_else(|defect| panic!("{name}, clipped: {defect}"));
}

#[test]
fn small_real_cases() {
    for name in [
        "merewether-anuga.geojson",
        "muncie-hecras.geojson",
        "thames-estuary.geojson",
        "dongguan-towns.geojson",
        "prague-bubenec.geojson.gz",
        "towradgi-anuga.geojson.gz",
        "monaco-osm.geojson.gz",
        "tricky-free-lines.geojson",
        "tricky-loops.geojson",
        "tricky-slivers.geojson",
    ] {
        assert_real_case(name, &[50_000, 1 << 29]);
    }
}

#[test]
fn large_real_cases() {
    for name in [
        "pearl-river-delta.geojson.gz",
        "wuhan-roads.geojson.gz",
        "london-lsoa.geojson.gz",
        "malta-osm.geojson.gz",
        "nl-thoekje-polder.geojson.gz",
        "liechtenstein-osm.geojson.gz",
        "aleppo-roads.geojson.gz",
        "auckland-roads-coast.geojson.gz",
        "baltimore-harbour.geojson.gz",
        "coquimbo-roads-coast.geojson.gz",
        "liege-roads.geojson.gz",
    ] {
        assert_real_case(name, &[]);
    }
}
