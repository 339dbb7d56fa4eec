//! Settling: promises on random messy line work, and what it is for.

use crate::cleanup::cleaned;
use crate::cleanup::domain;
use crate::cleanup::messy_domain;
use crate::cleanup::noded;
use crate::cleanup::usual;
use polder::boundary;
use polder::boundary::walks::Site;
use polder::cleanup::Cleaned;
use polder::cleanup::shifts;
use polder::cleanup::shifts::retell;
use polder::cleanup::shifts::shift;
use polder::domain::line::Domain;
use polder::domain::size::SizeWish;
use polder::geometry::point::Point;
use polder::intervals;
use polder::noding::arrangement::Arrangement;
use polder::parity;
use polder::partition;
use polder::partition::subdomains::Partition;
use polder::pipeline::plan::parity_options;
use polder::settling::Settled;
use polder::settling::check::check;
use polder::settling::settle;
use polder::settling::trial;
use proptest::prelude::*;

/// One round on clean line work; all promises checked. None if parity refuses the counts.
fn round(domain: &Domain, cleaned: &Cleaned, size_m: f64) -> Option<(Arrangement, Settled)> {
    let sizes = SizeWish::uniform(size_m, domain.kinds.len());
    let before = &cleaned.arrangement;
    let options = partition::Options {
        corner_deg: 30.0,
        tile_cells: 1 << 20,
    };
    let partition: Partition = partition::partition(domain, before, &options).unwrap();
    let options = intervals::Options {
        corner_deg: 30.0,
        upper_ratio: 2.5,
        block_ratio: 2.2,
        least_edge: 0.25,
    };
    let goals = intervals::plan(domain, &sizes, before, &partition, &options);
    let counts = parity::balance(&partition, &goals, &parity_options(1.2))
        .ok()?
        .counts;
    let first = boundary::numbering(&partition, &counts, before.points.len());
    let width_m = boundary::widths_m(domain, before, &partition);
    let site = Site {
        domain,
        sizes: &sizes,
        arrangement: before,
        partition: &partition,
        counts: &counts,
        first: &first,
        width_m: &width_m,
    };
    let all = 0..partition.subdomains.len() as u32;
    let mut trials: Vec<_> = all.map(|subdomain| trial(&site, subdomain)).collect();
    let mut after = before.clone();
    let options = usual(domain);
    let settled = settle(domain, &sizes, &options, &mut after, &mut trials);
    let both = [before, &after];
    let verdict = check(domain, &sizes, &options, both, &partition, &settled);
    assert_eq!(verdict, Ok(()));
    let mut tally = cleaned.tally.clone();
    let left = retell(domain, &sizes, &options, &after, &mut tally);
    assert!(tally.displacement_max_m <= 0.5 * size_m + 0.01);
    if settled.moves() == 0 {
        assert_eq!(left, cleaned.findings);
        let off_m = tally.displacement_max_m - cleaned.tally.displacement_max_m;
        assert!(off_m.abs() < 1e-6, "{off_m}");
    }
    Some((after, settled))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn promises_hold_on_messy_line_work(domain in messy_domain(), size in 2.0..15.0_f64) {
        let cleaned = cleaned(&domain, size);
        let once = round(&domain, &cleaned, size);
        prop_assert_eq!(round(&domain, &cleaned, size), once, "same input, same bits");
    }
}

/// On a grid that fits the size nothing is poor, and nothing moves.
#[test]
fn what_is_good_stays() {
    let grid = domain(&[
        (
            "boundary",
            vec![(0, 0), (40_000, 0), (40_000, 30_000), (0, 30_000), (0, 0)],
        ),
        ("", vec![(0, 10_000), (40_000, 10_000)]),
        ("", vec![(20_000, 0), (20_000, 30_000)]),
    ]);
    let cleaned = cleaned(&grid, 5.0);
    let (after, settled) = round(&grid, &cleaned, 5.0).unwrap();
    assert_eq!(after, cleaned.arrangement);
    assert_eq!(settled.moves(), 0);
}

/// A square of 40 m, and in it a free line with one bend.
fn square() -> Domain {
    domain(&[
        (
            "boundary",
            vec![(0, 0), (40_000, 0), (40_000, 40_000), (0, 40_000), (0, 0)],
        ),
        (
            "",
            vec![(5_000, 20_000), (20_000, 20_000), (30_000, 25_000)],
        ),
    ])
}

/// A bug: clean-up leaves stretches that no edge carries, or one that is too far away, as another of the same line is
/// near. Settling went by what edges carry, and left such stretches behind: 20 m on liechtenstein-osm at 58.9 of the
/// first kind, more of the second where the tolerance is a tenth of the size.
#[test]
fn what_covers_a_stretch_for_another_edge_stays() {
    let square = square();
    let (sizes, options) = (SizeWish::uniform(10.0, 1), usual(&square));
    let carried = noded(&square);
    let is_begin = |p: &Point| *p == Point::new(5_000, 20_000);
    let begin = carried.points.iter().position(is_begin).unwrap();
    let may_move = |arrangement: &Arrangement| {
        let mut may_move = false;
        shift(
            &square,
            &sizes,
            &options,
            &mut arrangement.clone(),
            |shifts| may_move = shifts.may_move(begin as u32),
        );
        may_move
    };
    assert!(may_move(&carried));
    let mut gap = carried.clone();
    let first = gap
        .pieces
        .iter_mut()
        .find(|it| it.line == 1 && it.from_m == 0.0);
    first.unwrap().from_m = 4.0;
    assert!(!may_move(&gap));
    // 2 m from what its edge carries, 6 m from the begin of the line
    let mut left = gap.clone();
    left.points[begin] = Point::new(11_000, 20_000);
    let check = |after: &Arrangement| shifts::check(&square, &sizes, &options, [&gap, after]);
    assert!(check(&left).unwrap_err().contains("beyond tolerance"));
    assert_eq!(check(&gap), Ok(()));
    // its edge carries all of it, but from 6 m aside
    let mut aside = carried.clone();
    aside.points[begin] = Point::new(5_000, 26_000);
    assert!(!may_move(&aside));
}

/// No more than 1 % of the lines may be farther away than half of their tolerance, and what takes more of them there
/// says how much.
#[test]
fn what_is_far_away_is_counted() {
    let square = square();
    let (sizes, options) = (SizeWish::uniform(10.0, 1), usual(&square));
    let before = noded(&square);
    let is_begin = |p: &Point| *p == Point::new(5_000, 20_000);
    let begin = before.points.iter().position(is_begin).unwrap() as u32;
    let mut after = before.clone();
    shift(&square, &sizes, &options, &mut after, |shifts| {
        // .97 % of the outline and the line
        let length_m = 160.0 + 15.0 + 125.0_f64.sqrt();
        assert!((shifts.spare_m() - 0.0097 * length_m).abs() < 1e-9);
        let (aside, usual) = ([0.0, 3.0], shifts.limits(begin));
        assert!(!shifts.shift(begin, aside, &usual), "the tolerance is 5 m");
        // by a first quarter of 15 m, 2.6 m away in its middle
        let [less, enough] = [3.7, 3.8].map(|more_m| shifts.wide_limits(begin, more_m));
        assert!(!shifts.shift(begin, aside, &less));
        assert!(shifts.shift(begin, aside, &enough));
        assert!((shifts.beyond_m(begin) - 3.75).abs() < 1e-9);
        assert!(shifts.spare_m() < 0.0);
        // back again no one asks
        assert!(shifts.shift(begin, [0.0, -0.05], &shifts.limits(begin)));
    });
    let verdict = shifts::check(&square, &sizes, &options, [&before, &after]);
    assert!(verdict.unwrap_err().contains("farther away than half"));
    let mut wide = before.clone();
    wide.points[begin as usize] = Point::new(5_000, 24_100);
    let verdict = shifts::check(&square, &sizes, &options, [&before, &wide]);
    assert!(verdict.unwrap_err().contains("is allowed"));
}
