//! Tests of `cli`: the binary from outside. Exit codes, bad input, nothing left behind.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::process::Output;
use tempfile::TempDir;

fn polder(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_polder"))
        .args(words)
        .current_dir(folder)
        .output()
        .expect("the binary starts")
}

/// Runs `words`, which must end with `code` and say all of `says` on standard error.
fn refused(folder: &Path, words: &[&str], code: i32, says: &[&str]) {
    let done = polder(folder, words);
    let error = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(code), "{words:?}: {error}");
    for part in says {
        assert!(error.contains(part), "{words:?}: no `{part}` in: {error}");
    }
    let left: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|it| it.unwrap().file_name())
        .collect();
    assert!(
        !left
            .iter()
            .any(|it| it.to_string_lossy().contains("out.polder")),
        "{words:?} left {left:?}"
    );
}

fn city(folder: &Path) {
    let made = polder(folder, &["synth", "--lines", "40", "--out", "city.geojson"]);
    assert!(made.status.success());
}

const SQUARE: &str = r#"{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:32632"}},"features":[
{"type":"Feature","properties":{"role":"boundary"},"geometry":{"type":"Polygon","coordinates":[[[500000,5000000],[500100,5000000],[500100,5000100],[500000,5000100],[500000,5000000]]]}}LINES]}"#;

fn square(lines: &str) -> String {
    SQUARE.replace("LINES", lines)
}

#[test]
fn the_way_through_on_a_small_city() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    city(at);
    let built = polder(
        at,
        &[
            "build",
            "city.geojson",
            "--size",
            "20",
            "--out",
            "m.polder",
            "--json",
        ],
    );
    assert_eq!(
        built.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&built.stderr)
    );
    let facts: serde_json::Value = serde_json::from_slice(&built.stdout).unwrap();
    assert_eq!(facts["holds"], true);
    assert!(facts["quads"].as_u64().unwrap() > 500);
    // where nothing was given up it said -0.0
    assert!(!String::from_utf8_lossy(&built.stdout).contains("-0.0"));
    for words in [
        &["check", "m.polder"][..],
        &["info", "m.polder", "--json"],
        &["report", "m.polder", "--out", "r.html"],
        &["export", "m.polder", "--format", "ugrid", "--out", "m.nc"],
        &["export", "m.polder", "--format", "2dm", "--out", "m.2dm"],
        &[
            "export",
            "m.polder",
            "--format",
            "lines",
            "--out",
            "m.lines.geojson",
        ],
        &[
            "export",
            "m.polder",
            "--format",
            "lines",
            "--cleaned",
            "--out",
            "m.cleaned.geojson",
        ],
        &[
            "export",
            "m.polder",
            "--format",
            "changes",
            "--out",
            "m.changes.geojson",
        ],
        &["plan", "city.geojson", "--size", "20", "--out", "n.polder"],
    ] {
        let done = polder(at, words);
        let error = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(0), "{words:?}: {error}");
    }
    let page = fs::read_to_string(at.join("r.html")).unwrap();
    for part in ["data:image/png", "gap of cost and price", "parity alone: "] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!at.join("n.polder").exists(), "a plan makes nothing");
}

#[test]
fn an_earlier_mesh_keeps_its_counts() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    city(at);
    let build = |out: &str, more: &[&str]| {
        let words = [
            &[
                "build",
                "city.geojson",
                // ladders of equal counts, and patterns, leave nothing to choose
                "--longest-rung",
                "0",
                "--match-sides",
                "0",
                "--quiet",
                "--force",
                "--out",
                out,
            ],
            more,
        ]
        .concat();
        let built = polder(at, &words);
        assert!(
            built.status.success(),
            "{}",
            String::from_utf8_lossy(&built.stderr)
        );
        fs::read(at.join(out).join("frame")).unwrap()
    };
    let usual = ["--size", "20"];
    let kept = ["--previous", "first.polder"];
    let first = build("first.polder", &usual);
    assert_eq!(build("again.polder", &[usual, kept].concat()), first);
    // A little finer, at some size other counts are best, but these are hardly worse.
    let keeps = |size: &&str| {
        let finer = ["--size", size];
        let alone = build("alone.polder", &finer);
        build("near.polder", &[finer, kept].concat()) != alone
    };
    assert!(
        ["19.9", "19.8", "19.7", "19.6", "19.5"].iter().any(keeps),
        "the same counts with and without an earlier mesh"
    );
    let words = ["build", "city.geojson", "--size", "20", "--out", "n.polder"];
    refused(
        at,
        &[&words[..], &["--previous", "no.polder"]].concat(),
        2,
        &["no.polder"],
    );
}

#[test]
fn a_job_file_does_the_same_as_flags_and_unknown_keys_are_refused() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    city(at);
    let job = "input = \"city.geojson\"\noutput = \"j.polder\"\nsize = 20\ntolerance = 8\n[sizes]\nriver = 15\n";
    fs::write(at.join("job.toml"), job).unwrap();
    let built = polder(at, &["build", "job.toml", "--quiet"]);
    assert_eq!(
        built.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&built.stderr)
    );
    fs::write(at.join("bad.toml"), format!("tolerence = 3\n{job}")).unwrap();
    refused(at, &["build", "bad.toml"], 2, &["bad.toml", "tolerence"]);
    fs::write(
        at.join("kind.toml"),
        job.replace("river", "canal").replace("j.p", "out.p"),
    )
    .unwrap();
    refused(at, &["build", "kind.toml"], 2, &["sizes.canal", "river"]);
}

/// Builds `input`, writes its cleaned lines, builds from them and writes those again: nothing was
/// changed the second time, and what is written is the same. Returns what it found otherwise.
fn second_build(at: &Path, input: &str, size: &str) -> Result<(), String> {
    let done = |words: &[&str]| {
        let run = polder(at, words);
        let error = String::from_utf8_lossy(&run.stderr).into_owned();
        match run.status.code() {
            Some(0) => Ok(()),
            code => Err(format!("{words:?}: exit {code:?} {error}")),
        }
    };
    for (from, mesh, to) in [
        (input, "1.polder", "1.geojson"),
        ("1.geojson", "2.polder", "2.geojson"),
    ] {
        done(&[
            "build", from, "--size", size, "--out", mesh, "--quiet", "--force",
        ])?;
        done(&[
            "export",
            mesh,
            "--format",
            "lines",
            "--cleaned",
            "--out",
            to,
            "--force",
        ])?;
    }
    let mesh = polder::chunk::reader::Mesh::open(&at.join("2.polder")).unwrap();
    let changes: Vec<_> = mesh.lines().tally().collect();
    if !changes.is_empty() || mesh.lines().displacement_max_m > 0.002 {
        let moved_m = mesh.lines().displacement_max_m;
        return Err(format!(
            "{input} {size}: changed {changes:?}, moved {moved_m} m"
        ));
    }
    let coordinates = |file: &str| {
        let text = fs::read_to_string(at.join(file)).unwrap();
        let made: serde_json::Value = serde_json::from_str(&text).unwrap();
        let features = made["features"].as_array().unwrap().iter();
        let lines = features.filter(|it| it["geometry"]["type"] == "LineString");
        let mut lines: Vec<String> = lines.map(|it| it["geometry"].to_string()).collect();
        lines.sort();
        lines
    };
    match coordinates("1.geojson") == coordinates("2.geojson") {
        true => Ok(()),
        false => Err(format!("{input} {size}: other lines")),
    }
}

#[test]
fn cleaned_lines_are_line_work_that_is_left_alone() {
    let folder = TempDir::new().unwrap();
    city(folder.path());
    second_build(folder.path(), "city.geojson", "20").unwrap();
    let shared = std::env::var("POLDER_CASES").unwrap_or("../shared/cases".to_string());
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join(shared);
    for (case, size) in [
        ("muncie-hecras.geojson", "28.1"),
        ("prague-bubenec.geojson", "8.94"),
        ("tricky-loops.geojson", "10"),
    ] {
        let input = shared.join(case);
        match input.exists() {
            true => second_build(folder.path(), input.to_str().unwrap(), size).unwrap(),
            false => println!("skipped: no {case} here (POLDER_CASES names the folder)"),
        }
    }
}

#[test]
fn rules_by_kind_are_taken_and_what_they_cannot_mean_is_refused() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    city(at);
    let job = "input = \"city.geojson\"\noutput = \"out.polder\"\nsize = 20\n[kinds.river]\n";
    for (rule, says) in [
        (
            "tolerence_m = 1",
            &["tolerence_m", "`tolerance_m`", "`hold_m`"][..],
        ),
        ("tolerance_m = -1", &["kinds.river.tolerance_m", "-1"]),
        ("priority = 1000", &["kinds.river.priority", "100"]),
        ("rows = 0", &["kinds.river.rows", "1..4"]),
        ("small_loops = \"drop\"", &["drop", "`keep`", "`collapse`"]),
        ("hold = false\nhold_m = 0.1", &["kinds.river", "hold_m"]),
        ("[kinds.canal]\nhold = true", &["kinds.canal", "river"]),
    ] {
        fs::write(at.join("job.toml"), format!("{job}{rule}\n")).unwrap();
        refused(at, &["build", "job.toml"], 2, says);
    }
    let rule = "hold = true\npriority = 3\nsmall_loops = \"keep\"\n";
    fs::write(at.join("job.toml"), format!("{job}{rule}")).unwrap();
    let built = polder(at, &["build", "job.toml", "--quiet"]);
    let error = String::from_utf8_lossy(&built.stderr);
    assert_eq!(built.status.code(), Some(0), "{error}");
    let told = polder(at, &["info", "out.polder", "--json"]);
    let facts: serde_json::Value = serde_json::from_slice(&told.stdout).unwrap();
    let echo: serde_json::Value = serde_json::from_str(facts["job"].as_str().unwrap()).unwrap();
    assert_eq!(echo["kinds"]["river"]["hold_m"], 0.05);
    assert_eq!(echo["kinds"]["river"]["small_loops"], "keep");
}

#[test]
fn bad_input_is_refused_with_its_place_and_leaves_nothing() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let line = |coordinates: &str| {
        square(&format!(
            r#",{{"type":"Feature","properties":{{}},"geometry":{{"type":"LineString","coordinates":{coordinates}}}}}"#
        ))
    };
    let bow = r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"role":"boundary"},"geometry":{"type":"Polygon","coordinates":[[[0,0],[1000,1000],[1000,0],[0,1000],[0,0]]]}}]}"#;
    let point = r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[500000,5000000]}}]}"#;
    let degrees = square("").replace("EPSG:32632", "EPSG:4326");
    let files = [
        ("empty.geojson", String::new(), "empty.geojson"),
        ("text.geojson", "hello".into(), "text.geojson"),
        ("cut.geojson", square("")[..180].to_string(), "cut.geojson"),
        (
            "nan.geojson",
            line("[[500001,5000001],[NaN,5000002]]"),
            "nan.geojson",
        ),
        ("bow.geojson", bow.into(), "feature 0"),
        ("point.geojson", point.into(), "point.geojson"),
        ("degrees.geojson", degrees, "degrees.geojson"),
    ];
    for (name, text, says) in files {
        fs::write(at.join(name), text).unwrap();
        refused(
            at,
            &["build", name, "--size", "10", "--out", "out.polder"],
            2,
            &[says],
        );
    }
    refused(
        at,
        &[
            "build",
            "none.geojson",
            "--size",
            "10",
            "--out",
            "out.polder",
        ],
        2,
        &["none.geojson"],
    );
}

#[test]
fn a_cut_gzip_is_refused() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    // The first bytes of a gzip stream of a large text; the rest is missing.
    let head = [
        0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3, 0xed, 0xbd, 7, 0x60, 0x1c,
    ];
    fs::write(at.join("cut.geojson.gz"), head).unwrap();
    refused(
        at,
        &[
            "build",
            "cut.geojson.gz",
            "--size",
            "10",
            "--out",
            "out.polder",
        ],
        2,
        &["cut.geojson.gz"],
    );
}

#[test]
fn senseless_sizes_are_refused() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("square.geojson"), square("")).unwrap();
    for (size, says) in [
        ("0", "size"),
        ("-3", "size"),
        ("nan", "size"),
        ("80", "too large"),
        ("0.001", "cell"),
    ] {
        let size = format!("--size={size}");
        refused(
            at,
            &["build", "square.geojson", &size, "--out", "out.polder"],
            2,
            &[says],
        );
    }
    refused(
        at,
        &["build", "square.geojson", "--out", "out.polder"],
        2,
        &["--size"],
    );
}

#[test]
fn an_existing_output_is_kept_unless_forced() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("square.geojson"), square("")).unwrap();
    fs::create_dir(at.join("kept.polder")).unwrap();
    fs::write(at.join("kept.polder/note"), "mine").unwrap();
    let words = [
        "build",
        "square.geojson",
        "--size",
        "10",
        "--out",
        "kept.polder",
        "--quiet",
    ];
    let done = polder(at, &words);
    assert_eq!(done.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&done.stderr).contains("--force"));
    assert_eq!(
        fs::read_to_string(at.join("kept.polder/note")).unwrap(),
        "mine"
    );
    let forced = polder(at, &[&words[..], &["--force"]].concat());
    assert_eq!(forced.status.code(), Some(0));
    assert!(at.join("kept.polder/index").exists());
}

#[test]
fn a_place_that_cannot_be_written_is_exit_3() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("square.geojson"), square("")).unwrap();
    fs::write(at.join("file"), "not a folder").unwrap();
    refused(
        at,
        &[
            "build",
            "square.geojson",
            "--size",
            "10",
            "--out",
            "file/out.polder",
        ],
        3,
        &["file/out.polder"],
    );
}

/// A file-size limit stands for a full disk: the first write beyond it fails. Nothing that looks
/// whole is left, and with room again the run goes on.
#[test]
fn a_full_disk_is_exit_3_and_can_be_resumed() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("square.geojson"), square("")).unwrap();
    let words = "build square.geojson --size 1 --out out.polder";
    let polder_path = env!("CARGO_BIN_EXE_polder");
    let script = format!("trap '' XFSZ; ulimit -f 16; exec {polder_path} {words}");
    let done = Command::new("bash")
        .args(["-c", &script])
        .current_dir(at)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(3), "{error}");
    assert!(error.contains("out.polder.partial"), "{error}");
    assert!(!at.join("out.polder").exists());
    let words: Vec<&str> = words.split(' ').chain(["--resume"]).collect();
    assert_eq!(polder(at, &words).status.code(), Some(0));
    assert!(at.join("out.polder/index").exists());
    assert!(!at.join("out.polder.partial").exists());
}

#[test]
fn a_damaged_mesh_is_exit_1() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("square.geojson"), square("")).unwrap();
    let built = polder(
        at,
        &[
            "build",
            "square.geojson",
            "--size",
            "10",
            "--out",
            "m.polder",
            "--quiet",
        ],
    );
    assert_eq!(built.status.code(), Some(0));
    let chunk = at.join("m.polder/chunk-00000");
    let mut bytes = fs::read(&chunk).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&chunk, bytes).unwrap();
    let checked = polder(at, &["check", "m.polder"]);
    assert_eq!(checked.status.code(), Some(1));
    fs::remove_file(&chunk).unwrap();
    assert_eq!(polder(at, &["check", "m.polder"]).status.code(), Some(1));
}

#[test]
fn words_that_mean_nothing_are_exit_2() {
    let folder = TempDir::new().unwrap();
    for words in [
        &["bild"][..],
        &[],
        &["build"],
        &["synth", "--lines", "3", "--out", "c.geojson"],
    ] {
        assert_eq!(
            polder(folder.path(), words).status.code(),
            Some(2),
            "{words:?}"
        );
    }
}
