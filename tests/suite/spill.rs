//! Tests of `spill`, and of a run that was stopped.

use polder::chunk::writer::partial_of;
use polder::spill;
use polder::spill::Parked;
use std::fs;
use tempfile::TempDir;

fn empty() -> Parked {
    Parked {
        arrangement: Default::default(),
        partition: Default::default(),
        goals: Default::default(),
        balance: Default::default(),
        dropped: Vec::new(),
        changes: vec![polder::cleanup::changes::Change {
            what: "joined-end",
            at: polder::geometry::point::Point::new(3, -4),
            moved_m: 0.25,
        }],
        tally: Default::default(),
        findings: Vec::new(),
    }
}

#[test]
fn what_is_fetched_is_what_was_parked() {
    let folder = TempDir::new().unwrap();
    spill::park(folder.path(), "key", &empty()).unwrap();
    assert_eq!(spill::fetch(folder.path(), "key"), Some(empty()));
}

#[test]
fn another_key_or_a_cut_file_is_nothing() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    assert_eq!(spill::fetch(at, "key"), None);
    spill::park(at, "key", &empty()).unwrap();
    assert_eq!(spill::fetch(at, "other"), None);
    let whole = fs::read(at.join(spill::NAME)).unwrap();
    for cut in [0, 1, whole.len() / 2, whole.len() - 1] {
        fs::write(at.join(spill::NAME), &whole[..cut]).unwrap();
        assert_eq!(spill::fetch(at, "key"), None, "cut at {cut}");
    }
}

/// A run that is killed at some point and resumed gives the same bytes as one that was not.
#[test]
fn a_killed_run_resumes_to_the_same_bytes() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let polder = |words: &[&str]| {
        std::process::Command::new(env!("CARGO_BIN_EXE_polder"))
            .args(words)
            .current_dir(at)
            .output()
            .unwrap()
    };
    assert!(
        polder(&["synth", "--lines", "60", "--out", "c.geojson"])
            .status
            .success()
    );
    let whole = polder(&[
        "build",
        "c.geojson",
        "--size",
        "4",
        "--out",
        "a.polder",
        "--quiet",
    ]);
    assert!(whole.status.success());
    let mut resumed = 0;
    for wait_ms in [60, 150, 300, 600] {
        let mut killed = std::process::Command::new(env!("CARGO_BIN_EXE_polder"))
            .args([
                "build",
                "c.geojson",
                "--size",
                "4",
                "--out",
                "b.polder",
                "--quiet",
                "--force",
            ])
            .current_dir(at)
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(wait_ms));
        killed.kill().unwrap();
        killed.wait().unwrap();
        resumed += usize::from(partial_of(&at.join("b.polder")).join(spill::NAME).exists());
        let again = polder(&[
            "build",
            "c.geojson",
            "--size",
            "4",
            "--out",
            "b.polder",
            "--resume",
            "--force",
        ]);
        let error = String::from_utf8_lossy(&again.stderr);
        assert!(again.status.success(), "{error}");
        for file in ["index", "frame", "lines", "chunk-00000"] {
            let [a, b] =
                ["a.polder", "b.polder"].map(|it| fs::read(at.join(it).join(file)).unwrap());
            assert!(a == b, "{file} differs after {wait_ms} ms");
        }
    }
    println!("{resumed} of 4 runs were stopped after the plan was parked");
}
