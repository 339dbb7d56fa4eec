//! Tests of `pipeline`.

use polder::chunk::reader::Mesh;
use polder::domain::line::Domain;
use polder::domain::line::Line;
use polder::domain::line::Role;
use polder::export::Format;
use polder::export::export;
use polder::geometry::grid::Grid;
use polder::geometry::point::Point;
use polder::noding::arrangement::Arrangement;
use polder::noding::arrangement::Piece;
use polder::parity;
use polder::partition::subdomains::Curve;
use polder::partition::subdomains::OUTSIDE;
use polder::partition::subdomains::Partition;
use polder::partition::subdomains::Subdomain;
use polder::pipeline::build;
use polder::pipeline::job::Job;
use polder::pipeline::ordered::IN_FLIGHT_PER_WORKER;
use polder::pipeline::ordered::in_order;
use polder::pipeline::refusal::explain;
use polder::settling;
use polder::synth::City;
use polder::synth::city;
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering;
use tempfile::TempDir;

/// Results come in order, each once, and never more than the bound exist.
#[test]
fn results_come_in_order_and_memory_is_bounded() {
    for workers in [1, 2, 5] {
        let alive = AtomicUsize::new(0);
        let most = AtomicUsize::new(0);
        let mut taken = Vec::new();
        let make = |n: u32| {
            let now = alive.fetch_add(1, Ordering::SeqCst) + 1;
            most.fetch_max(now, Ordering::SeqCst);
            // Uneven work: every 50th is slow.
            let spins = if n.is_multiple_of(50) { 200_000 } else { 50 };
            (0..spins).fold(u64::from(n), |a, b| a.wrapping_mul(31).wrapping_add(b))
        };
        let done = in_order(2000, workers, make, |n, _| {
            alive.fetch_sub(1, Ordering::SeqCst);
            taken.push(n);
            Ok::<(), ()>(())
        });
        assert_eq!(done, Ok(()));
        assert!(taken.iter().copied().eq(0..2000));
        assert!(most.into_inner() <= workers * IN_FLIGHT_PER_WORKER);
    }
}

#[test]
fn the_first_error_of_the_writer_ends_the_work() {
    let made = AtomicUsize::new(0);
    let make = |n: u32| {
        made.fetch_add(1, Ordering::SeqCst);
        n
    };
    let done = in_order(
        100_000,
        2,
        make,
        |n, _| if n == 7 { Err(n) } else { Ok(()) },
    );
    assert_eq!(done, Err(7));
    assert!(made.into_inner() < 1000);
}

#[test]
fn a_panic_of_a_worker_ends_the_work() {
    let make = |n: u32| if n == 40 { panic!("on purpose") } else { n };
    let run = || in_order(10_000, 2, make, |_, _| Ok::<(), ()>(()));
    assert!(std::panic::catch_unwind(run).is_err());
}

#[test]
fn no_work_is_done_at_once() {
    assert_eq!(in_order(0, 2, |n| n, |_, _| Err(())), Ok(()));
}

/// Parity knows numbers; what the user reads has the place, the lines, and what to do.
#[test]
fn what_parity_refuses_has_a_place_and_lines() {
    let ring = [[0, 0], [4000, 0], [0, 3000]].map(|[x, y]| Point::new(x, y));
    let line = |name: &str, source: u32, points: Vec<Point>| Line {
        source,
        role: Role::Constraint,
        kind: 0,
        name: name.to_string(),
        points,
    };
    let domain = Domain {
        grid: Grid {
            origin_m: [500_000.0, 4_000_000.0],
            cell_m: 0.001,
        },
        epsg: None,
        kinds: vec!["dyke".to_string()],
        lines: vec![
            line("North", 3, vec![ring[0], ring[1]]),
            line("", 7, vec![ring[1], ring[2], ring[0]]),
        ],
        digest: 0,
    };
    let piece = |line: u32| Piece {
        line,
        from_m: 0.0,
        to_m: 1.0,
    };
    let edges = vec![
        ([0, 1], vec![piece(0)]),
        ([1, 2], vec![piece(1)]),
        ([2, 0], vec![piece(1)]),
    ];
    let arrangement = Arrangement::from_parts(&ring, edges);
    let partition = Partition {
        curves: vec![Curve {
            nodes: vec![0, 1, 2, 0],
            edges: vec![0, 1, 2],
            left: 0,
            right: OUTSIDE,
            is_seam: false,
        }],
        subdomains: vec![Subdomain {
            walks: vec![vec![0]],
            area_m2: 6.0,
        }],
    };
    let refused = parity::error::Error::Infeasible {
        subdomains: vec![0],
        fixed: vec![0],
    };
    let said = explain(refused, &domain, &arrangement, &partition);
    assert_eq!(said.exit_code(), 2);
    let said = said.to_string();
    for part in [
        "(500000.000, 4000000.000)",
        "feature 3 (dyke \"North\")",
        "feature 7 (dyke)",
        "cannot all be even",
        "another size",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

/// Builds a small city; the bytes of every file that must not depend on how it was built.
fn bytes_of(
    folder: &Path,
    name: &str,
    threads: usize,
    tile_m: Option<f64>,
) -> Vec<(String, Vec<u8>)> {
    let job = Job {
        tile_m,
        // Small, so that seams are made.
        seam_budget_quads: 1500,
        threads,
        ..Job::usual(folder.join("city.geojson"), folder.join(name), 14.0)
    };
    let outcome = build(&job, &|_| {}).unwrap();
    let broken: Vec<_> = outcome.verdict.broken().collect();
    assert!(broken.is_empty(), "{broken:#?}");
    let mesh = Mesh::open(&job.output).unwrap();
    for (format, file) in [
        (Format::Ugrid, "x.nc"),
        (Format::Sms, "x.2dm"),
        (Format::Lines, "x.lines"),
        (Format::Changes, "x.changes"),
    ] {
        export(&mesh, format, &job.output.join(file)).unwrap();
    }
    drop(mesh);
    let mut files: Vec<(String, Vec<u8>)> = fs::read_dir(&job.output)
        .unwrap()
        .map(|it| it.unwrap())
        .map(|it| {
            (
                it.file_name().into_string().unwrap(),
                fs::read(it.path()).unwrap(),
            )
        })
        .filter(|(name, _)| name != "log.json")
        .collect();
    files.sort();
    files
}

#[test]
fn same_bytes_for_any_threads_tiles_and_run() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    write_city(&city(60, 5), &at.join("city.geojson"));
    let first = bytes_of(at, "a.polder", 1, None);
    assert!(
        first.len() >= 8,
        "{:?}",
        first.iter().map(|it| &it.0).collect::<Vec<_>>()
    );
    for (name, threads, tile_m) in [
        ("b.polder", 1, None),
        ("c.polder", 2, None),
        ("d.polder", 2, Some(90.0)),
        ("e.polder", 2, Some(333.0)),
        ("f.polder", 1, Some(1e6)),
    ] {
        let again = bytes_of(at, name, threads, tile_m);
        for (a, b) in first.iter().zip(&again) {
            assert_eq!(a.0, b.0);
            assert!(a.1 == b.1, "{name}: {} differs", a.0);
        }
        assert_eq!(first.len(), again.len());
    }
}

/// At a size as coarse as the blocks, the poorest quads are those that no interior node can help.
#[test]
fn settling_helps_the_poorest_cells() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    write_city(&city(120, 5), &at.join("city.geojson"));
    let [never, usual] = [0, settling::ROUNDS].map(|settle| {
        let job = Job {
            settle,
            force: true,
            ..Job::usual(at.join("city.geojson"), at.join("a.polder"), 40.0)
        };
        let outcome = build(&job, &|_| {}).unwrap();
        assert!(outcome.verdict.holds());
        let quality = outcome.verdict.quality;
        [
            quality.scaled_jacobian.quantile(0.01),
            quality.scaled_jacobian.mean(),
        ]
    });
    assert!(usual[0] > never[0] + 0.01, "{never:?} {usual:?}");
    assert!(usual[1] > never[1], "{never:?} {usual:?}");
}

#[test]
fn cells_beside_seams_are_shaped_as_well_as_others() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    write_city(&city(60, 5), &at.join("city.geojson"));
    let job = Job {
        seam_budget_quads: 1500,
        ..Job::usual(at.join("city.geojson"), at.join("a.polder"), 5.0)
    };
    let quality = build(&job, &|_| {}).unwrap().verdict.quality;
    let (near, others) = (
        quality.seam_scaled_jacobian,
        quality.off_seam_scaled_jacobian,
    );
    assert!(near.count > 500 && others.count > 5000, "{}", near.count);
    assert!(near.mean() > others.mean());
    for share in [0.01, 0.05, 0.5] {
        let both = [&near, &others].map(|it| it.quantile(share));
        assert!(both[0] > both[1] - 0.01, "{share}: {both:?}");
    }
}

fn write_city(city: &City, to: &Path) {
    let feature = |role: &str, kind: &str, shape: &str, points: String| {
        format!(
            r#"{{"type":"Feature","properties":{{"role":"{role}","kind":"{kind}"}},"geometry":{{"type":"{shape}","coordinates":{points}}}}}"#
        )
    };
    let mut features = vec![feature(
        "boundary",
        "",
        "Polygon",
        format!("[{:?}]", city.boundary),
    )];
    for it in &city.features {
        features.push(feature(
            "constraint",
            it.kind,
            "LineString",
            format!("{:?}", it.points),
        ));
    }
    let crs = r#""crs":{"type":"name","properties":{"name":"EPSG:32632"}}"#;
    let text = format!(
        r#"{{"type":"FeatureCollection",{crs},"features":[{}]}}"#,
        features.join(",")
    );
    fs::write(to, text).unwrap();
}
