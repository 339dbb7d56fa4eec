//! House rules, as a test.

use crate::layers::sources;
use std::path::Path;

/// Longest function, lines; a reader should see it whole.
const FUNCTION_LINES: usize = 70;

/// Longest file in src, lines.
const FILE_LINES: usize = 600;

/// Words that may not occur in src, and what to do instead.
const BANNED: &[(&str, &str)] = &[
    ("todo!(", "finish it"),
    ("unimplemented!(", "finish it"),
    ("dbg!(", "remove it"),
    ("FIXME", "mend it or say it in the issue"),
    ("TODO", "mend it or say it in the issue"),
    ("HashMap::new()", "FxHashMap, or a sorted vector"),
    ("std::collections::HashMap", "FxHashMap, or a sorted vector"),
    ("std::collections::HashSet", "FxHashSet, or a sorted vector"),
    ("#[allow(dead_code)]", "remove what is dead"),
    ("#[ignore", "a test runs or is not there"),
];

#[test]
fn files_and_functions_stay_readable() {
    let mut faults = Vec::new();
    for (file, text) in all_sources() {
        let lines: Vec<&str> = text.lines().collect();
        if file.starts_with("src/") && lines.len() > FILE_LINES {
            faults.push(format!("{file}: {} lines; split by step", lines.len()));
        }
        for (start, length) in functions(&lines) {
            if length > FUNCTION_LINES {
                faults.push(format!(
                    "{file}:{}: a function of {length} lines",
                    start + 1
                ));
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn banned_words_stay_out() {
    let mut faults = Vec::new();
    for (file, text) in sources(Path::new("src")) {
        for (n, line) in text.lines().enumerate() {
            for (word, instead) in BANNED {
                if line.contains(word) {
                    faults.push(format!("{file}:{}: {word}: {instead}", n + 1));
                }
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn drawer_names_stay_out() {
    for (file, _) in sources(Path::new("src")) {
        for drawer in ["util", "common", "helper", "manager", "misc"] {
            assert!(!file.contains(drawer), "{file}: name it by what it does");
        }
    }
}

#[test]
fn every_stage_has_a_contract_page() {
    for stage in [
        "noding",
        "cleanup",
        "partition",
        "seams",
        "intervals",
        "parity",
        "boundary",
        "meshing",
        "settling",
    ] {
        let page = std::fs::read_to_string(format!("src/{stage}/mod.rs")).unwrap();
        for heading in ["# Promises", "# Needs", "# Method", "# Cost", "# Not here"] {
            let found = page.lines().any(|it| it == format!("//! {heading}"));
            assert!(found, "src/{stage}/mod.rs lacks `{heading}`");
        }
        let check = format!("src/{stage}/check.rs");
        assert!(Path::new(&check).exists(), "{check} is missing");
    }
}

/// (first line, length) of every function, by brace counting.
fn functions(lines: &[&str]) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    for (start, line) in lines.iter().enumerate() {
        let code = line.trim_start();
        let is_function = ["fn ", "pub fn ", "pub(crate) fn ", "pub(super) fn "]
            .iter()
            .any(|it| code.starts_with(it));
        if !is_function {
            continue;
        }
        let indent = line.len() - code.len();
        let closes = |it: &&str| it.len() > indent && &it[indent..] == "}" && it.trim() == "}";
        if let Some(length) = lines[start..].iter().position(closes) {
            found.push((start, length + 1));
        }
    }
    found
}

fn all_sources() -> Vec<(String, String)> {
    let mut all = sources(Path::new("src"));
    all.extend(sources(Path::new("tests/suite")));
    all.extend(sources(Path::new("benches")));
    all.retain(|(file, _)| !file.ends_with("generated.rs"));
    all
}
