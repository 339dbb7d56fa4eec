//! A slow twin of clean-up: its promises again, over all pairs, in exact integers (millimetres).
//!
//! Two thousand small line works in each run; `POLDER_TWIN=20000` asks for more.

use crate::cleanup::cleaned;
use crate::cleanup::domain;
use crate::cleanup::messy_domain;
use crate::cleanup::noded;
use crate::cleanup::usual;
use polder::cleanup;
use polder::cleanup::Cleaned;
use polder::domain::line::Domain;
use polder::domain::line::Role;
use polder::domain::size::SizeWish;
use polder::geometry::point::Point;
use polder::geometry::point::Xy;
use polder::noding::arrangement::Arrangement;
use proptest::prelude::*;

type Segment = [Point; 2];

fn minus(a: Point, b: Point) -> [i128; 2] {
    [
        i128::from(a.x) - i128::from(b.x),
        i128::from(a.y) - i128::from(b.y),
    ]
}

fn dot(u: [i128; 2], v: [i128; 2]) -> i128 {
    u[0] * v[0] + u[1] * v[1]
}

fn cross(u: [i128; 2], v: [i128; 2]) -> i128 {
    u[0] * v[1] - u[1] * v[0]
}

/// Squared distance of `p` from a segment, numerator and denominator, and if its foot lies inside.
fn distance2(p: Point, [a, b]: Segment) -> (i128, i128, bool) {
    let (along, whole) = (dot(minus(p, a), minus(b, a)), dot(minus(b, a), minus(b, a)));
    if along <= 0 {
        (dot(minus(p, a), minus(p, a)), 1, false)
    } else if along >= whole {
        (dot(minus(p, b), minus(p, b)), 1, false)
    } else {
        let aside = cross(minus(p, a), minus(b, a));
        (aside * aside, whole, true)
    }
}

fn is_within(p: Point, segment: Segment, limit_mm: i128) -> bool {
    let (num, den, _) = distance2(p, segment);
    num <= limit_mm * limit_mm * den
}

/// True if two segments have a point in common.
fn touch([a, b]: Segment, [c, d]: Segment) -> bool {
    let side = |p, q, r| cross(minus(q, p), minus(r, p)).signum();
    let spans =
        |p: Point, q: Point, r: Point| dot(minus(r, p), minus(r, q)) <= 0 && side(p, q, r) == 0;
    (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0)
        || spans(a, b, c)
        || spans(a, b, d)
        || spans(c, d, a)
        || spans(c, d, b)
}

fn edges(arrangement: &Arrangement) -> Vec<Segment> {
    let at = |node: u32| arrangement.points[node as usize];
    arrangement.edges.iter().map(|it| it.map(at)).collect()
}

/// No two edges have more in common than a node of both.
fn is_planar(arrangement: &Arrangement) -> Result<(), String> {
    let edges = edges(arrangement);
    for (k, &e) in edges.iter().enumerate() {
        for &f in &edges[..k] {
            let shared = e.iter().find(|it| f.contains(it));
            let bad = match shared {
                None => touch(e, f),
                Some(&hub) => {
                    let arms =
                        [e, f].map(|it| minus(if it[0] == hub { it[1] } else { it[0] }, hub));
                    cross(arms[0], arms[1]) == 0 && dot(arms[0], arms[1]) > 0
                }
            };
            if bad {
                return Err(format!("{e:?} and {f:?}"));
            }
        }
    }
    Ok(())
}

/// Places of the findings of one kind, metres.
fn listed(cleaned: &Cleaned, what: &str) -> Vec<Xy> {
    let of_kind = cleaned.findings.iter().filter(|it| it.what == what);
    of_kind.filter_map(|it| it.at_m).collect()
}

fn is_listed(places: &[Xy], x_mm: f64, y_mm: f64) -> bool {
    (places.iter()).any(|it| (it[0] - x_mm / 1e3).hypot(it[1] - y_mm / 1e3) < 0.003)
}

/// Every short edge, every narrow gap beside a line and every sharp angle away from the rim is listed.
fn is_separated(domain: &Domain, cleaned: &Cleaned, limit_mm: i128) -> Result<(), String> {
    let arrangement = &cleaned.arrangement;
    let edges = edges(arrangement);
    let short = listed(cleaned, "short-edge");
    let gaps = listed(cleaned, "narrow-gap");
    let sharp = listed(cleaned, "sharp-angle");
    let is_rim = |edge: usize| {
        let pieces = arrangement.pieces_of(edge as u32).iter();
        pieces
            .into_iter()
            .any(|it| domain.lines[it.line as usize].role != Role::Constraint)
    };
    // A millimetre aside for what floats say of lengths that are exactly the limit.
    let limit2 = (limit_mm - 1) * (limit_mm - 1);
    for (edge, &[a, b]) in edges.iter().enumerate() {
        let middle = [a.x + b.x, a.y + b.y].map(|it| 0.5 * f64::from(it));
        if dot(minus(b, a), minus(b, a)) < limit2 && !is_listed(&short, middle[0], middle[1]) {
            return Err(format!("short edge {edge} {a:?} {b:?}"));
        }
        for &p in arrangement.points.iter().filter(|&&p| p != a && p != b) {
            let (num, den, is_inside) = distance2(p, [a, b]);
            if is_rim(edge) || !is_inside || num >= limit2 * den {
                continue;
            }
            let t = dot(minus(p, a), minus(b, a)) as f64 / den as f64;
            let foot = [
                f64::from(a.x) + t * f64::from(b.x - a.x),
                f64::from(a.y) + t * f64::from(b.y - a.y),
            ];
            let middle = [
                0.5 * (foot[0] + f64::from(p.x)),
                0.5 * (foot[1] + f64::from(p.y)),
            ];
            if !is_listed(&gaps, middle[0], middle[1]) {
                return Err(format!("gap between {p:?} and {a:?} {b:?}"));
            }
        }
    }
    for (node, &hub) in arrangement.points.iter().enumerate() {
        let star: Vec<usize> = (0..edges.len())
            .filter(|&it| arrangement.edges[it].contains(&(node as u32)))
            .collect();
        if star.iter().any(|&it| is_rim(it)) {
            continue;
        }
        let arms: Vec<[i128; 2]> = (star.iter())
            .map(|&it| {
                minus(
                    if edges[it][0] == hub {
                        edges[it][1]
                    } else {
                        edges[it][0]
                    },
                    hub,
                )
            })
            .collect();
        for (k, &u) in arms.iter().enumerate() {
            for &v in &arms[..k] {
                // tan 19.9 degrees is above .3619
                let is_sharp = dot(u, v) > 0 && 10_000 * cross(u, v).abs() < 3_619 * dot(u, v);
                if is_sharp && !is_listed(&sharp, f64::from(hub.x), f64::from(hub.y)) {
                    return Err(format!("sharp angle at {hub:?}"));
                }
            }
        }
    }
    Ok(())
}

/// Every vertex of a line within the domain is within the tolerance of an edge that carries the line,
/// or in a dropped stretch; and so is every vertex of the stretch that an edge says it represents.
fn is_within_tolerance(
    domain: &Domain,
    input: &Arrangement,
    cleaned: &Cleaned,
    limit_mm: i128,
) -> Result<(), String> {
    let edges = edges(&cleaned.arrangement);
    for (id, line) in (0..).zip(&domain.lines) {
        if line.role != Role::Constraint {
            continue;
        }
        let stations = domain.stations_m(id);
        let pieces_of = |edge: usize| cleaned.arrangement.pieces_of(edge as u32).iter();
        for (&p, &at_m) in line.points.iter().zip(&stations) {
            let spans =
                |from: f64, to: f64, by: f64| from.min(to) < at_m + by && at_m - by < from.max(to);
            let is_wanted =
                (input.pieces.iter()).any(|it| it.line == id && spans(it.from_m, it.to_m, -1e-6));
            let is_dropped = (cleaned.dropped.iter())
                .any(|it| it.line == id && spans(it.from_m, it.to_m, 0.005));
            let own = (0..edges.len()).filter(|&edge| pieces_of(edge).any(|it| it.line == id));
            let mut near = own.filter(|&edge| is_within(p, edges[edge], limit_mm + 3));
            if is_wanted && !is_dropped && near.next().is_none() {
                return Err(format!("line {id} lost at {p:?}"));
            }
            for edge in 0..edges.len() {
                let says =
                    pieces_of(edge).any(|it| it.line == id && spans(it.from_m, it.to_m, -1e-6));
                if says && !is_within(p, edges[edge], limit_mm + 3) {
                    return Err(format!("line {id} is far from edge {edge} at {p:?}"));
                }
            }
        }
    }
    Ok(())
}

/// Lines that are everywhere farther apart than twice the tolerance have no node in common.
fn far_lines_stay_apart(domain: &Domain, cleaned: &Cleaned, limit_mm: i128) -> Result<(), String> {
    let arrangement = &cleaned.arrangement;
    let mut lines_at: Vec<Vec<u32>> = vec![Vec::new(); arrangement.points.len()];
    for (edge, ends) in (0..).zip(&arrangement.edges) {
        for node in ends {
            lines_at[*node as usize].extend(arrangement.pieces_of(edge).iter().map(|it| it.line));
        }
    }
    let segments = |line: usize| {
        domain.lines[line]
            .points
            .windows(2)
            .map(|it| [it[0], it[1]])
    };
    for one in 0..domain.lines.len() {
        for other in 0..one {
            let is_near = |s: Segment, t: Segment| {
                touch(s, t)
                    || s.iter().any(|&p| is_within(p, t, 2 * limit_mm + 4))
                    || t.iter().any(|&p| is_within(p, s, 2 * limit_mm + 4))
            };
            let is_far = segments(one).all(|s| segments(other).all(|t| !is_near(s, t)));
            let both = |at: &Vec<u32>| at.contains(&(one as u32)) && at.contains(&(other as u32));
            if is_far && lines_at.iter().any(both) {
                return Err(format!("lines {one} and {other} meet"));
            }
        }
    }
    Ok(())
}

fn cases() -> u32 {
    let asked = std::env::var("POLDER_TWIN").ok();
    asked.and_then(|it| it.parse().ok()).unwrap_or(2000)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases()))]

    #[test]
    fn all_pairs_agree(domain in messy_domain(), half_metres in 4..30_i32) {
        let size_m = 0.5 * f64::from(half_metres);
        let tolerance_mm = i128::from(250 * half_metres);
        let cleaned = cleaned(&domain, size_m);
        prop_assert_eq!(is_planar(&cleaned.arrangement), Ok(()));
        prop_assert_eq!(is_separated(&domain, &cleaned, tolerance_mm / 2), Ok(()));
        prop_assert_eq!(is_within_tolerance(&domain, &noded(&domain), &cleaned, tolerance_mm), Ok(()));
        prop_assert_eq!(far_lines_stay_apart(&domain, &cleaned, tolerance_mm), Ok(()));
    }
}

/// The input without the edges that only line `line` runs on.
fn without(input: &Arrangement, line: u32) -> Arrangement {
    let parts = (0..input.edges.len() as u32).filter_map(|edge| {
        let pieces = input.pieces_of(edge).iter().copied();
        let pieces: Vec<_> = pieces.filter(|it| it.line != line).collect();
        (!pieces.is_empty()).then_some((input.edges[edge as usize], pieces))
    });
    Arrangement::from_parts(&input.points, parts.collect())
}

#[test]
fn a_room_that_is_lost_is_found() {
    let square =
        |from: i32, to: i32| vec![(from, from), (to, from), (to, to), (from, to), (from, from)];
    let wall = domain(&[
        ("boundary", square(0, 100_000)),
        ("", vec![(50_000, 0), (50_000, 100_000)]),
    ]);
    let loose = domain(&[
        ("boundary", square(0, 100_000)),
        ("", square(40_000, 60_000)),
    ]);
    let shed = domain(&[
        ("boundary", square(0, 100_000)),
        ("", square(40_000, 48_000)),
    ]);
    // the walk around it has no area: no face, and no room of its own
    let hook = domain(&[
        ("boundary", square(0, 100_000)),
        (
            "",
            vec![
                (50_000, 50_000),
                (57_025, 52_173),
                (60_274, 47_945),
                (58_757, 42_853),
            ],
        ),
    ]);
    for (work, size_m, lost) in [
        (&hook, 10.0, 0),
        (&wall, 10.0, 1),
        (&loose, 10.0, 1),
        (&shed, 10.0, 0),
        (&wall, 49.0, 1),
        (&wall, 51.0, 0),
    ] {
        let sizes = SizeWish::uniform(size_m, work.kinds.len());
        let input = noded(work);
        let look = |after: &Arrangement| {
            cleanup::rooms::lost(work, &sizes, &usual(work), &input, after).len()
        };
        assert_eq!(look(&input), 0);
        assert_eq!(look(&without(&input, 1)), lost, "{size_m}");
    }
}
