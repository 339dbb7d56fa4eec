//! Tests of `ingest`: each `tests/data/ingest/*.geojson` reads as the `.expect` beside it says
//! (`POLDER_BLESS=1` writes what is read; look at it before you believe it).

use polder::domain::line::Role;
use polder::ingest::CrsChoice;
use polder::ingest::Ingested;
use polder::ingest::Options;
use polder::ingest::error::Error;
use polder::ingest::read;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::path::PathBuf;

const FROM_FILE: Options = Options {
    cell_m: 0.001,
    crs: CrsChoice::FromFile,
};

fn case(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/ingest")
        .join(name)
}

/// All that was read, as text: coordinates relative to the grid's origin, metres.
fn told(read: &Result<Ingested, Error>, folder: &Path) -> String {
    let mut text = String::new();
    match read {
        Err(error) => {
            let plain = error
                .to_string()
                .replace(&format!("{}/", folder.display()), "");
            writeln!(text, "error: {plain}").unwrap();
        }
        Ok(read) => {
            let domain = &read.domain;
            let [x, y] = domain.grid.origin_m;
            writeln!(
                text,
                "epsg {:?}, origin {x} {y}, kinds {:?}",
                domain.epsg, domain.kinds
            )
            .unwrap();
            writeln!(
                text,
                "{} features, {} points",
                read.features_read, read.points_read
            )
            .unwrap();
            for line in &domain.lines {
                let kind = &domain.kinds[usize::from(line.kind)];
                write!(
                    text,
                    "{:?} {} {kind:?} {:?}:",
                    line.role, line.source, line.name
                )
                .unwrap();
                for &p in &line.points {
                    let [x, y] = domain.grid.local_m(p);
                    write!(text, " {x:.3} {y:.3},").unwrap();
                }
                writeln!(text).unwrap();
            }
            for finding in &read.findings {
                let (what, feature) = (finding.what, finding.feature);
                writeln!(
                    text,
                    "{what} {feature:?} {:?}: {}",
                    finding.at_m, finding.text
                )
                .unwrap();
            }
        }
    }
    text
}

#[test]
fn cases_read_as_expected() {
    let folder = case("");
    let mut names: Vec<PathBuf> = (std::fs::read_dir(&folder).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|end| end == "geojson"))
        .collect();
    names.sort();
    assert!(names.len() > 30, "{} cases", names.len());
    let mut wrong = 0;
    for path in names {
        let told = told(&read(&path, &FROM_FILE), path.parent().unwrap());
        let expect = path.with_extension("expect");
        if std::env::var_os("POLDER_BLESS").is_some() {
            std::fs::write(&expect, &told).unwrap();
        }
        let expected = std::fs::read_to_string(&expect).unwrap_or_default();
        if told != expected {
            println!("{}:\n  expected\n{expected}  read\n{told}", path.display());
            wrong += 1;
        }
    }
    assert_eq!(wrong, 0, "cases read otherwise");
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn gzip_is_known_by_its_bytes_not_its_name() {
    let plain = case("0001_boundary_lines_hole.geojson");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lines.geojson");
    let bytes = packed(&std::fs::read(&plain).unwrap());
    std::fs::write(&path, &bytes).unwrap();
    let (from_packed, from_plain) = (read(&path, &FROM_FILE).unwrap(), read(&plain, &FROM_FILE));
    assert_eq!(from_packed.domain.lines, from_plain.unwrap().domain.lines);
    let fnv = bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
    });
    assert_eq!(
        from_packed.domain.digest, fnv,
        "the digest is that of the stored bytes"
    );
}

#[test]
fn damaged_gzip_is_bad_input() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lines.geojson.gz");
    let bytes = packed(&std::fs::read(case("0006_nothing_lost_in_silence.geojson")).unwrap());
    for cut in [11, bytes.len() / 2, bytes.len() - 3] {
        std::fs::write(&path, &bytes[..cut]).unwrap();
        let error = read(&path, &FROM_FILE).unwrap_err();
        assert!(
            matches!(error, Error::Damaged { .. }),
            "cut at {cut}: {error}"
        );
        assert!(!error.is_world());
    }
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 0x55;
    std::fs::write(&path, &flipped).unwrap();
    assert!(!read(&path, &FROM_FILE).unwrap_err().is_world());
}

#[test]
fn a_missing_file_is_a_mistake_of_the_user() {
    let error = read(Path::new("no/such/file.geojson"), &FROM_FILE).unwrap_err();
    assert!(!error.is_world());
    assert!(error.to_string().contains("no/such/file.geojson"));
    assert!(
        !read(&std::env::temp_dir(), &FROM_FILE)
            .unwrap_err()
            .is_world()
    );
}

#[test]
fn a_choice_overrides_what_the_file_says() {
    let with = |name: &str, crs| read(&case(name), &Options { crs, ..FROM_FILE });
    let local = with("0118_degrees_without_crs.geojson", CrsChoice::Local).unwrap();
    assert_eq!(local.domain.epsg, None);
    let named = with("0118_degrees_without_crs.geojson", CrsChoice::Epsg(2326)).unwrap();
    assert_eq!(named.domain.epsg, Some(2326));
    let refused = with("0001_boundary_lines_hole.geojson", CrsChoice::Epsg(4326));
    assert!(matches!(
        refused,
        Err(Error::Geographic { fitting: None, .. })
    ));
}

#[test]
fn the_cell_that_an_error_advises_is_enough() {
    let path = case("0117_too_wide.geojson");
    let Err(Error::TooWide { cell_needed_m, .. }) = read(&path, &FROM_FILE) else {
        panic!("should be too wide");
    };
    let options = Options {
        cell_m: cell_needed_m,
        ..FROM_FILE
    };
    assert!(read(&path, &options).is_ok());
}

#[test]
fn coordinates_move_by_half_a_cell_at_most() {
    let path = case("0001_boundary_lines_hole.geojson");
    for cell_m in [0.0001, 0.001, 0.25] {
        let domain = read(
            &path,
            &Options {
                cell_m,
                ..FROM_FILE
            },
        )
        .unwrap()
        .domain;
        let line = domain
            .lines
            .iter()
            .find(|line| line.role == Role::Constraint)
            .unwrap();
        let end = domain.grid.projected_m(line.points[1]);
        for (made, given) in end.iter().zip([500_020.000_4, 5_000_020.000_6]) {
            assert!((made - given).abs() <= cell_m / 2.0 + 1e-9);
        }
    }
}

#[test]
fn too_many_kinds_is_bad_input() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kinds.geojson");
    let features: Vec<String> = (0..65_536)
        .map(|kind| {
            format!(
                r#"{{"type":"Feature","properties":{{"kind":"{kind}"}},"geometry":
                {{"type":"LineString","coordinates":[[500000,5000000],[500001,5000001]]}}}}"#
            )
        })
        .collect();
    let text = format!(
        r#"{{"type":"FeatureCollection","features":[{}]}}"#,
        features.join(",")
    );
    std::fs::write(&path, text).unwrap();
    assert!(matches!(
        read(&path, &FROM_FILE),
        Err(Error::TooManyKinds { .. })
    ));
}
