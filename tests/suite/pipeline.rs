//! Tests of `pipeline`.

use polder::chunk::reader::Mesh;
use polder::export::Format;
use polder::export::export;
use polder::ingest::CrsChoice;
use polder::pipeline::build;
use polder::pipeline::job::CELL_M;
use polder::pipeline::job::CORNER_DEG;
use polder::pipeline::job::Job;
use polder::pipeline::job::MATCH_SIDES;
use polder::pipeline::ordered::IN_FLIGHT_PER_WORKER;
use polder::pipeline::ordered::in_order;
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

/// Builds a small city; the bytes of every file that must not depend on how it was built.
fn bytes_of(
    folder: &Path,
    name: &str,
    threads: usize,
    tile_m: Option<f64>,
) -> Vec<(String, Vec<u8>)> {
    let job = Job {
        input: folder.join("city.geojson"),
        output: folder.join(name),
        size_m: 14.0,
        sizes_m: Vec::new(),
        tolerance_m: None,
        rules: Vec::new(),
        crs: CrsChoice::FromFile,
        cell_m: CELL_M,
        tile_m,
        corner_deg: CORNER_DEG,
        // Small, so that seams are made.
        seam_budget_quads: 1500,
        match_sides: MATCH_SIDES,
        threads,
        force: false,
        resume: false,
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
