//! Clean-up: promises on random messy line work, small cases as data.

use polder::cleanup;
use polder::cleanup::Cleaned;
use polder::cleanup::Options;
use polder::cleanup::Tolerance;
use polder::cleanup::rules::Rule;
use polder::cleanup::rules::SmallLoops;
use polder::domain::line::Domain;
use polder::domain::line::Line;
use polder::domain::line::Role;
use polder::domain::size::SizeWish;
use polder::geometry::grid::Grid;
use polder::geometry::point::Point;
use polder::geometry::point::Xy;
use polder::noding;
use polder::noding::arrangement::Arrangement;
use proptest::prelude::*;
use rayon::iter::IntoParallelRefIterator;
use rayon::iter::ParallelIterator;

/// Half the size, no rule for any kind.
pub fn usual(domain: &Domain) -> Options {
    Options {
        tolerance: Tolerance::ShareOfSize(0.5),
        by_kind: vec![Rule::FREE; domain.kinds.len()],
        min_edge: cleanup::SHORTEST,
        left: None,
        corner_deg: 30.0,
        without: Vec::new(),
    }
}

/// What a line is, and its points in millimetres.
type Drawn<'a> = (&'a str, Vec<(i32, i32)>);

/// Lines in millimetres; the first is the boundary, rings named "hole" are holes. What follows a
/// colon is a kind.
pub fn domain(lines: &[(&str, Vec<(i32, i32)>)]) -> Domain {
    let kind_of = |what: &str| {
        what.split_once(':')
            .map_or(String::new(), |it| it.1.to_string())
    };
    let mut kinds: Vec<String> = lines.iter().map(|it| kind_of(it.0)).collect();
    kinds.push(String::new());
    kinds.sort();
    kinds.dedup();
    let line = |(source, (what, points)): (usize, &Drawn)| Line {
        source: source as u32,
        role: match what.split(':').next().unwrap() {
            "boundary" => Role::Boundary,
            "hole" => Role::Hole,
            _ => Role::Constraint,
        },
        kind: kinds.binary_search(&kind_of(what)).unwrap() as u16,
        name: String::new(),
        points: points.iter().map(|&(x, y)| Point::new(x, y)).collect(),
    };
    let lines = lines.iter().enumerate().map(line).collect();
    Domain {
        grid: Grid {
            origin_m: [0.0, 0.0],
            cell_m: 0.001,
        },
        epsg: None,
        kinds,
        lines,
        digest: 0,
    }
}

pub fn noded(domain: &Domain) -> Arrangement {
    let tiles = noding::Options {
        tile_cells: 1 << 20,
    };
    noding::clip(domain, noding::node(domain, &tiles)).0
}

/// Cleans at `size_m` and checks all promises.
pub fn cleaned(domain: &Domain, size_m: f64) -> Cleaned {
    cleaned_by(domain, size_m, &usual(domain))
}

fn cleaned_by(domain: &Domain, size_m: f64, options: &Options) -> Cleaned {
    let sizes = SizeWish::uniform(size_m, domain.kinds.len());
    let input = noded(domain);
    let cleaned = cleanup::clean(domain, &sizes, input.clone(), options);
    let verdict = cleanup::check::check(domain, &sizes, options, &input, &cleaned);
    assert_eq!(verdict, Ok(()));
    cleaned
}

fn square(side_mm: i32) -> Vec<(i32, i32)> {
    vec![
        (0, 0),
        (side_mm, 0),
        (side_mm, side_mm),
        (0, side_mm),
        (0, 0),
    ]
}

/// A line in 100 m x 100 m: a walk with steps of all lengths, sometimes a near copy of another.
fn messy_line() -> impl Strategy<Value = Vec<(i32, i32)>> {
    let start = (0..100_000_i32, 0..100_000_i32);
    let step = prop_oneof![
        (-40_000..40_000_i32, -40_000..40_000_i32),
        (-3_000..3_000_i32, -3_000..3_000_i32),
        (-30..30_i32, -30..30_i32),
    ];
    (start, prop::collection::vec(step, 1..8)).prop_map(|(start, steps)| {
        let mut points = vec![start];
        for (dx, dy) in steps {
            let &(x, y) = points.last().unwrap();
            if (dx, dy) != (0, 0) {
                points.push((x + dx, y + dy));
            }
        }
        if points.len() < 2 {
            points.push((start.0 + 1_000, start.1));
        }
        points
    })
}

pub fn messy_domain() -> impl Strategy<Value = Domain> {
    let copies = prop::collection::vec((any::<prop::sample::Index>(), -900..900_i32), 0..4);
    (
        prop::collection::vec(messy_line(), 1..9),
        copies,
        0..3_usize,
    )
        .prop_map(|(walks, copies, holes)| {
            let mut lines = vec![("boundary", square(100_000))];
            for k in 0..holes as i32 {
                let (x, y, side) = (20_000 + 1_700 * k, 30_000 + 900 * k, 1_500 + 9_000 * k);
                let ring = square(side).iter().map(|&(u, v)| (x + u, y + v)).collect();
                lines.push(("hole", ring));
            }
            for (index, shift) in copies {
                let walk = index.get(&walks);
                lines.push((
                    "",
                    walk.iter()
                        .map(|&(x, y)| (x + shift, y - shift / 3))
                        .collect(),
                ));
            }
            lines.extend(walks.into_iter().map(|walk| ("", walk)));
            domain(&lines)
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn promises_hold_on_messy_line_work(domain in messy_domain(), size in 2.0..15.0_f64) {
        cleaned(&domain, size);
    }

    #[test]
    fn same_input_same_bits(domain in messy_domain()) {
        prop_assert_eq!(cleaned(&domain, 8.0), cleaned(&domain, 8.0));
    }

    #[test]
    fn no_tolerance_no_change(domain in messy_domain()) {
        let off = Options { tolerance: Tolerance::Metres(0.0), ..usual(&domain) };
        let input = noded(&domain);
        let result = cleanup::clean(&domain, &SizeWish::uniform(8.0, 1), input.clone(), &off);
        prop_assert_eq!(result.arrangement, input);
        prop_assert_eq!(&result.dropped, &Vec::new());
        prop_assert_eq!(&result.changes, &Vec::new());
    }

    #[test]
    fn a_second_run_finds_little_to_do(domain in messy_domain()) {
        let once = cleaned(&domain, 8.0).arrangement;
        let sizes = SizeWish::uniform(8.0, 1);
        let twice = cleanup::clean(&domain, &sizes, once.clone(), &usual(&domain)).arrangement;
        let (before, after) = (once.edges.len(), twice.edges.len());
        prop_assert!(before.abs_diff(after) <= 2 + before / 10, "{} {}", before, after);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// A second run that is told what the first one had to leave changes nothing at all.
    #[test]
    fn clean_line_work_is_left_alone(domain in messy_domain(), size in 2.0..15.0_f64) {
        let once = cleaned(&domain, size);
        let places = (once.findings.iter()).map(|it| it.at_m.unwrap()).collect();
        let told = Options { left: Some(places), ..usual(&domain) };
        let sizes = SizeWish::uniform(size, 1);
        let twice = cleanup::clean(&domain, &sizes, once.arrangement.clone(), &told);
        prop_assert_eq!(&twice.arrangement, &once.arrangement);
        prop_assert!(twice.tally.rows.is_empty() && twice.changes.is_empty());
        // A place that is not told is a reason to clean.
        if !once.findings.is_empty() && once.findings[0].what == "short-edge" {
            let told = Options { left: Some(Vec::new()), ..usual(&domain) };
            let again = cleanup::clean(&domain, &sizes, once.arrangement.clone(), &told);
            let untold = cleanup::clean(&domain, &sizes, once.arrangement.clone(), &usual(&domain));
            prop_assert_eq!(again.arrangement, untold.arrangement);
        }
    }
}

/// A walk from the middle of 100 m x 100 m, all segments longer than half of 10 m.
fn zigzag() -> impl Strategy<Value = Vec<(i32, i32)>> {
    let step = (5.2..16.0_f64, prop_oneof![-70.0..-5.0_f64, 5.0..70.0_f64]);
    prop::collection::vec(step, 2..7).prop_map(|steps| {
        let (mut points, mut way) = (vec![(50_000, 50_000)], 0.3_f64);
        for (length_m, turn_deg) in steps {
            let &(x, y) = points.last().unwrap();
            let by = [way.cos(), way.sin()].map(|it| (1000.0 * length_m * it).round() as i32);
            points.push((x + by[0], y + by[1]));
            way += turn_deg.to_radians();
        }
        points
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// A line that is nowhere near itself keeps each of its corners as a node, near where it was.
    #[test]
    fn corners_of_a_lone_line_stay(walk in zigzag()) {
        let size = 10.0;
        let at: Vec<Xy> = walk.iter().map(|&(x, y)| [f64::from(x), f64::from(y)].map(|it| it / 1000.0)).collect();
        let segments: Vec<[Xy; 2]> = at.windows(2).map(|it| [it[0], it[1]]).collect();
        let is_lone = (0..at.len()).all(|k| {
            let others = segments.iter().enumerate().filter(|&(i, _)| i != k && i + 1 != k);
            let others: Vec<_> = others.map(|it| *it.1).collect();
            nearest_m(at[k], &others) > 0.5 * size
        });
        let is_inside = at.iter().flatten().all(|it| (10.0..90.0).contains(it));
        prop_assume!(is_lone && is_inside);
        let result = cleaned(&domain(&[("boundary", square(100_000)), ("", walk)]), size);
        let nodes = result.arrangement.points.iter().map(|p| [p.x, p.y].map(|it| f64::from(it) / 1000.0));
        let nodes: Vec<Xy> = nodes.collect();
        for k in 1..at.len() - 1 {
            if turn_deg([at[k - 1], at[k], at[k + 1]]) > 30.1 {
                let near = nodes.iter().filter(|it| (it[0] - at[k][0]).hypot(it[1] - at[k][1]) < 0.25 * size);
                prop_assert_eq!(near.count(), 1, "corner {} of {:?}", k, at);
            }
        }
    }
}

fn turn_deg([a, o, b]: [Xy; 3]) -> f64 {
    let (u, v) = ([o[0] - a[0], o[1] - a[1]], [b[0] - o[0], b[1] - o[1]]);
    (u[0] * v[1] - u[1] * v[0])
        .atan2(u[0] * v[0] + u[1] * v[1])
        .abs()
        .to_degrees()
}

/// Districts of a few edges each: all that happens at their borders happens all the time.
const TINY: cleanup::Grain = cleanup::Grain {
    edges_max: 12,
    side_min: 3.0,
};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn promises_hold_over_many_districts(domain in messy_domain(), size in 1.0..5.0_f64) {
        let input = noded(&domain);
        let sizes = SizeWish::uniform(size, 1);
        let site = site(&domain, &sizes, input.clone(), &TINY);
        let made = site.districts().iter().map(|it| cleanup::clean_district(&site, it)).collect();
        let met = cleanup::meet(&site, made);
        let bands = site.bands().iter().map(|it| cleanup::clean_band(&site, &met, it)).collect();
        let result = cleanup::finish(cleanup::join(&site, met, bands));
        let verdict = cleanup::check::check(&domain, &sizes, &usual(&domain), &input, &result);
        prop_assert_eq!(verdict, Ok(()));
    }

    #[test]
    fn districts_at_once_or_one_by_one_are_the_same(domain in messy_domain()) {
        let sizes = SizeWish::uniform(3.0, 1);
        let site = || site(&domain, &sizes, noded(&domain), &TINY);
        prop_assert_eq!(joined_backwards(site()), joined_at_once(site()));
    }
}

fn site<'a>(
    domain: &'a Domain,
    sizes: &SizeWish,
    arrangement: Arrangement,
    grain: &cleanup::Grain,
) -> cleanup::Site<'a> {
    let options = usual(domain);
    let measure = cleanup::Measure::new(domain, sizes, &options);
    let layout = cleanup::layout(domain, sizes, &arrangement, grain);
    cleanup::site(measure, layout, arrangement, &options)
}

/// All districts, then all bands, each from the last to the first.
fn joined_backwards(site: cleanup::Site) -> cleanup::Cleaned {
    let districts = site.districts().iter().rev();
    let mut made: Vec<_> = districts
        .map(|it| cleanup::clean_district(&site, it))
        .collect();
    made.reverse();
    let met = cleanup::meet(&site, made);
    let bands = site.bands().iter().rev();
    let mut bands: Vec<_> = bands
        .map(|it| cleanup::clean_band(&site, &met, it))
        .collect();
    bands.reverse();
    cleanup::finish(cleanup::join(&site, met, bands))
}

/// The same on all cores.
fn joined_at_once(site: cleanup::Site) -> cleanup::Cleaned {
    let districts = site.districts().par_iter();
    let made = districts
        .map(|it| cleanup::clean_district(&site, it))
        .collect();
    let met = cleanup::meet(&site, made);
    let bands = site.bands().par_iter();
    let bands = bands
        .map(|it| cleanup::clean_band(&site, &met, it))
        .collect();
    cleanup::finish(cleanup::join(&site, met, bands))
}

/// A grid of streets, each drawn twice, over 3 km: enough for districts of the usual grain.
#[test]
fn a_town_is_cleaned_by_districts() {
    let mut lines = vec![("boundary", square(3_000_000))];
    for k in 1..100 {
        let at = 30_000 * k + 7 * (k * k % 1000);
        for shift in [0, 900 + 11 * k] {
            lines.push(("", vec![(at + shift, 1_000), (at - shift, 2_990_000)]));
            lines.push(("", vec![(1_000, at - shift), (2_990_000, at + shift)]));
        }
    }
    let town = domain(&lines);
    let sizes = SizeWish::uniform(12.0, 1);
    let site = site(&town, &sizes, noded(&town), &cleanup::GRAIN);
    assert!(site.districts().len() > 3, "{}", site.districts().len());
    assert_eq!(site.bands().len(), site.districts().len() - 1);
    assert_eq!(joined_at_once(site), cleaned(&town, 12.0));
}

/// One file a case: `size`, `min_edge` metres, `corner` degrees, then lines `what[:kind] x y x y ...` in metres; `rule KIND KEY
/// VALUE ...` for a kind. The expectation counts, and says how far each line of a kind moved.
#[test]
fn small_cases() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/cleanup");
    let mut cases: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|it| it.unwrap().path())
        .collect();
    cases.retain(|path| path.extension().is_some_and(|it| it == "in"));
    cases.sort();
    assert!(!cases.is_empty());
    for case in cases {
        let text = std::fs::read_to_string(&case).unwrap();
        if std::env::var_os("POLDER_BLESS").is_some() {
            std::fs::write(case.with_extension("expect"), outcome(&text) + "\n").unwrap();
        }
        let expected = std::fs::read_to_string(case.with_extension("expect")).unwrap();
        assert_eq!(outcome(&text).trim(), expected.trim(), "{}", case.display());
    }
}

/// The line work, the size in metres and the options of a case.
fn read_case(text: &str) -> (Domain, f64, Options) {
    let mut size_m = 0.0;
    let mut lines = Vec::new();
    let mut rules = Vec::new();
    let (mut min_edge_m, mut corner_deg) = (None, 30.0);
    for row in text
        .lines()
        .filter(|row| !row.is_empty() && !row.starts_with('#'))
    {
        let mut words = row.split_whitespace();
        let what = words.next().unwrap();
        if what == "rule" {
            rules.push(words.collect::<Vec<_>>());
            continue;
        }
        let values: Vec<f64> = words.map(|word| word.parse().unwrap()).collect();
        match what {
            "size" => size_m = values[0],
            "min_edge" => min_edge_m = Some(values[0]),
            "corner" => corner_deg = values[0],
            _ => {}
        }
        if ["size", "min_edge", "corner"].contains(&what) {
            continue;
        }
        let mm = |metres: f64| (metres * 1000.0).round() as i32;
        lines.push((
            what,
            values.chunks(2).map(|xy| (mm(xy[0]), mm(xy[1]))).collect(),
        ));
    }
    let domain = domain(&lines);
    let mut options = usual(&domain);
    options.min_edge = min_edge_m.map_or(cleanup::SHORTEST, |it| it / size_m);
    options.corner_deg = corner_deg;
    for words in rules {
        let kind = domain.kinds.iter().position(|it| it == words[0]).unwrap();
        options.by_kind[kind] = rule(&words[1..]);
    }
    (domain, size_m, options)
}

fn outcome(text: &str) -> String {
    let (domain, size_m, options) = read_case(text);
    let result = cleaned_by(&domain, size_m, &options);
    let mut rows = vec![format!(
        "nodes {} edges {}",
        result.arrangement.points.len(),
        result.arrangement.edges.len()
    )];
    rows.extend(result.dropped.iter().map(|it| {
        format!(
            "dropped {} {:?} {:.1}..{:.1}",
            it.line, it.reason, it.from_m, it.to_m
        )
    }));
    rows.extend(
        result
            .tally
            .rows
            .iter()
            .map(|(what, count, _)| format!("{what} {count}")),
    );
    rows.extend(
        result
            .findings
            .iter()
            .map(|it| format!("finding {}", it.what)),
    );
    let of_kind = (0..domain.lines.len()).filter(|&line| domain.lines[line].kind != 0);
    rows.extend(of_kind.map(|line| {
        let kind = &domain.kinds[usize::from(domain.lines[line].kind)];
        let moved_m = moved_m(&domain, &result.arrangement, line);
        format!("line {line} {kind} moved {moved_m:.2}")
    }));
    rows.join("\n")
}

fn rule(words: &[&str]) -> Rule {
    let mut rule = Rule::FREE;
    for pair in words.chunks(2) {
        let number = || pair[1].parse().unwrap();
        match pair[0] {
            "tolerance_m" => rule.tolerance_m = Some(number()),
            "priority" => rule.priority = number() as i32,
            "hold_m" => rule.hold_m = Some(number()),
            "small_loops" => rule.small_loops = SmallLoops::Keep,
            other => panic!("no such key: {other}"),
        }
    }
    rule
}

/// Largest distance between a line and the edges that carry it, both ways, metres; infinite if none
/// does.
fn moved_m(domain: &Domain, arrangement: &Arrangement, line: usize) -> f64 {
    let local = |p: Point| domain.grid.local_m(p);
    let points: Vec<Xy> = domain.lines[line]
        .points
        .iter()
        .map(|&p| local(p))
        .collect();
    let segments: Vec<[Xy; 2]> = points.windows(2).map(|it| [it[0], it[1]]).collect();
    let carries = |edge: &usize| {
        let pieces = arrangement.pieces_of(*edge as u32);
        pieces.iter().any(|piece| piece.line as usize == line)
    };
    let edges: Vec<[Xy; 2]> = (0..arrangement.edges.len())
        .filter(carries)
        .map(|edge| arrangement.edges[edge].map(|node| local(arrangement.points[node as usize])))
        .collect();
    let from_to = |from: &[[Xy; 2]], to: &[[Xy; 2]]| {
        let samples = from.iter().flat_map(|[a, b]| {
            (0..=100).map(move |k| {
                let t = f64::from(k) / 100.0;
                [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
            })
        });
        samples.map(|p| nearest_m(p, to)).fold(0.0, f64::max)
    };
    from_to(&segments, &edges).max(from_to(&edges, &segments))
}

fn nearest_m(p: Xy, segments: &[[Xy; 2]]) -> f64 {
    let away = |[a, b]: &[Xy; 2]| {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let along = (p[0] - a[0]) * dx + (p[1] - a[1]) * dy;
        let t = (along / (dx * dx + dy * dy)).clamp(0.0, 1.0);
        (p[0] - a[0] - t * dx).hypot(p[1] - a[1] - t * dy)
    };
    segments.iter().map(away).fold(f64::INFINITY, f64::min)
}
