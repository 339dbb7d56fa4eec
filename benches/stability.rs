//! How far a moved line reaches: one line of a case moves by one size, and the counts of the curves
//! more than five sub-domains away are compared.
//!
//! `cargo bench --bench stability -- CASE.geojson[.gz] SIZE_M [MOVES] [MATCH_SIDES]...` prints a row for
//! each worth of patterns, without and with the first mesh as `--previous`, and each of MOVES lines
//! (default 4, spread evenly over the file), moved by itself. `--smoke` moves one of a synthetic city.

use flate2::read::GzDecoder;
use polder::chunk::reader::Mesh;
use polder::pipeline::build;
use polder::pipeline::job::Job;
use polder::pipeline::job::MATCH_SIDES;
use serde_json::Value;
use std::collections::BTreeMap;
use std::collections::BTreeSet;
use std::io::Read;
use std::path::Path;
use std::path::PathBuf;
use std::process::Command;

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Sub-domains within which counts may change.
const NEAR: u32 = 5;

/// The side of nothing.
const OUTSIDE: u32 = u32::MAX;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let folder = std::env::temp_dir().join(format!("polder-stability-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the temporary folder can be made");
    let numbers: Vec<f64> = words.iter().filter_map(|it| it.parse().ok()).collect();
    let (case, size_m, moves, worths) = match words.iter().find(|it| it.contains(".geojson")) {
        Some(case) => {
            let worths = match numbers.get(2..) {
                Some(worths) if !worths.is_empty() => worths.to_vec(),
                _ => vec![MATCH_SIDES],
            };
            let moves = numbers.get(1).map_or(4, |it| *it as usize);
            (PathBuf::from(case), numbers[0], moves, worths)
        }
        None => (synthetic(&folder), 20.0, 1, vec![MATCH_SIDES]),
    };
    let city = parsed(&case);
    println!(
        "| match sides | --previous | moved | far curves | bent | without twin | changed | the farthest | kept % |\n|---|---|---|---|---|---|---|---|---|"
    );
    for worth in worths {
        let before = made(&folder, "before", &city, size_m, worth, None);
        for previous in [None, Some(&before)] {
            let words = format!(
                "{worth} | {}",
                if previous.is_some() { "yes" } else { "no" }
            );
            let mut all = Tally::default();
            for k in 0..moves {
                let (line, moved) = with_a_line_moved(&city, k, moves, size_m);
                let after = made(&folder, "after", &moved, size_m, worth, previous);
                let tally = compare(&before, &after, line);
                tally.print(&words, &format!("feature {line}"));
                all.add(&tally);
            }
            all.print(&words, "all");
        }
    }
    std::fs::remove_dir_all(&folder).expect("the temporary folder can be removed");
}

fn synthetic(folder: &Path) -> PathBuf {
    let input = folder.join("city.geojson");
    let words = ["synth", "--quiet", "--force", "--lines", "100", "--out"];
    let made = Command::new(env!("CARGO_BIN_EXE_polder"))
        .args(words)
        .arg(&input)
        .status()
        .expect("the binary starts");
    assert!(made.success());
    input
}

fn parsed(case: &Path) -> Value {
    let mut bytes = std::fs::read(case).expect("a readable case");
    if case.extension().is_some_and(|it| it == "gz") {
        let mut plain = Vec::new();
        (GzDecoder::new(&bytes[..]).read_to_end(&mut plain)).expect("a sound gzip file");
        bytes = plain;
    }
    serde_json::from_slice(&bytes).expect("GeoJSON")
}

/// The city with line `k` of `of` moved sideways by a size, and the line's feature.
fn with_a_line_moved(city: &Value, k: usize, of: usize, size_m: f64) -> (u32, Value) {
    let mut moved = city.clone();
    let features = moved["features"].as_array_mut().expect("features");
    let lines: Vec<usize> = (0..features.len())
        .filter(|&id| features[id]["geometry"]["type"] == "LineString")
        .collect();
    let id = lines[(2 * k + 1) * lines.len() / (2 * of)];
    let points = features[id]["geometry"]["coordinates"].as_array_mut();
    let points = points.expect("a line has points");
    let at = |p: &Value| [0, 1].map(|axis| p[axis].as_f64().expect("a number"));
    let (from, to) = (at(&points[0]), at(&points[points.len() - 1]));
    let along = [to[0] - from[0], to[1] - from[1]];
    let long = along[0].hypot(along[1]).max(1e-9);
    let aside = [-along[1] / long * size_m, along[0] / long * size_m];
    for point in points {
        let [x, y] = at(point);
        (point[0], point[1]) = ((x + aside[0]).into(), (y + aside[1]).into());
    }
    (id as u32, moved)
}

fn made(
    folder: &Path,
    name: &str,
    city: &Value,
    size_m: f64,
    match_sides: f64,
    previous: Option<&Mesh>,
) -> Mesh {
    let input = folder.join(format!("{name}.geojson"));
    std::fs::write(&input, city.to_string()).expect("room for the case");
    let job = Job {
        match_sides,
        previous: previous.map(|it| it.dir().to_path_buf()),
        force: true,
        ..Job::usual(input, folder.join(format!("{name}.polder")), size_m)
    };
    let outcome = build(&job, &|_| {}).expect("a case can be built");
    assert!(outcome.verdict.holds());
    Mesh::open(&job.output).expect("a mesh")
}

/// What became of the curves far from the moved line, before and after.
#[derive(Clone, Debug, Default)]
struct Tally {
    far: u32,
    /// Of other geometry after the move: clean-up reached so far.
    bent: u32,
    /// Of those, the ones without a twin: no curve after the move has its ends within half a size.
    lost: u32,
    /// With another count than the twin has.
    changed: u32,
    /// Of those that changed, how far the farthest is, sub-domains.
    farthest: u32,
}

impl Tally {
    fn add(&mut self, other: &Tally) {
        self.far += other.far;
        self.bent += other.bent;
        self.lost += other.lost;
        self.changed += other.changed;
        self.farthest = self.farthest.max(other.farthest);
    }

    fn print(&self, words: &str, name: &str) {
        let kept = 100.0 * (1.0 - f64::from(self.changed + self.lost) / f64::from(self.far.max(1)));
        println!(
            "| {words} | {name} | {} | {} | {} | {} | {} | {kept:.3} |",
            self.far, self.bent, self.lost, self.changed, self.farthest
        );
    }
}

/// A curve as the cleaned lines draw it: its nodes in grid cells, from the lesser end.
type Chain = Vec<[i64; 2]>;

fn chain(mesh: &Mesh, curve: usize) -> Chain {
    let (frame, grid) = (mesh.frame(), mesh.index().grid);
    let nodes = frame.curve_start[curve] as usize..frame.curve_start[curve + 1] as usize;
    let mut chain: Chain = (frame.curve_nodes[nodes].iter())
        .filter(|&&node| node < frame.fixed_nodes)
        .map(|&node| {
            let xy_m = frame.nodes[node as usize];
            [0, 1].map(|axis| ((xy_m[axis] + grid.origin_m[axis]) / grid.cell_m).round() as i64)
        })
        .collect();
    if chain.last() < chain.first() {
        chain.reverse();
    }
    chain
}

fn count(mesh: &Mesh, curve: usize) -> u32 {
    let start = mesh.frame().curve_start;
    start[curve + 1] - start[curve] - 1
}

fn compare(before: &Mesh, after: &Mesh, feature: u32) -> Tally {
    let chains = [before, after].map(|mesh| -> Vec<Chain> {
        let curves = 0..mesh.frame().left.len();
        curves.map(|id| chain(mesh, id)).collect()
    });
    let at: BTreeMap<&Chain, usize> = (chains[1].iter().enumerate())
        .map(|(id, chain)| (chain, id))
        .collect();
    let old: BTreeSet<&Chain> = chains[0].iter().collect();
    let new: Vec<usize> = (0..chains[1].len())
        .filter(|&id| !old.contains(&chains[1][id]))
        .collect();
    let half_a_size = 0.5 * before.index().size_m / before.index().grid.cell_m;
    let far = [before, after].map(|mesh| curves_away(mesh, feature));
    let mut tally = Tally::default();
    for (id, chain) in chains[0].iter().enumerate() {
        let same = at.get(chain).copied();
        let near = || (new.iter().copied()).find(|&k| is_near(chain, &chains[1][k], half_a_size));
        let away = far[0][id];
        if away <= NEAR || same.is_some_and(|twin| far[1][twin] <= NEAR) {
            continue;
        }
        tally.far += 1;
        tally.bent += u32::from(same.is_none());
        match same.or_else(near) {
            None => tally.lost += 1,
            Some(twin) if count(before, id) == count(after, twin) => {}
            Some(twin) => {
                tally.changed += 1;
                tally.farthest = tally.farthest.max(away.min(far[1][twin]));
            }
        }
    }
    tally
}

/// Both ends, and the lengths, differ by at most `most`.
fn is_near(a: &Chain, b: &Chain, most: f64) -> bool {
    let apart = |p: [i64; 2], q: [i64; 2]| ((p[0] - q[0]) as f64).hypot((p[1] - q[1]) as f64);
    let length = |it: &Chain| it.windows(2).map(|at| apart(at[0], at[1])).sum::<f64>();
    let (from, to) = ((a[0], a[a.len() - 1]), (b[0], b[b.len() - 1]));
    let ahead = apart(from.0, to.0) <= most && apart(from.1, to.1) <= most;
    let back = apart(from.0, to.1) <= most && apart(from.1, to.0) <= most;
    (ahead || back) && (length(a) - length(b)).abs() <= most
}

/// How many sub-domains each curve lies away from those along the line of `feature`.
fn curves_away(mesh: &Mesh, feature: u32) -> Vec<u32> {
    let (frame, lines) = (mesh.frame(), mesh.lines());
    let mut steps = vec![u32::MAX; frame.subdomains()];
    let sides = |id: usize| [frame.left[id], frame.right[id]];
    let mut rim = Vec::new();
    let reach = |side: u32, step: u32, steps: &mut Vec<u32>, next: &mut Vec<u32>| {
        if side != OUTSIDE && steps[side as usize] == u32::MAX {
            steps[side as usize] = step;
            next.push(side);
        }
    };
    for id in 0..frame.left.len() {
        let edges =
            frame.curve_start[id] as usize - id..frame.curve_start[id + 1] as usize - id - 1;
        let pieces = edges.flat_map(|edge| {
            frame.piece_start[edge] as usize..frame.piece_start[edge + 1] as usize
        });
        let mut on_line = pieces.map(|it| lines.source[frame.piece_line[it] as usize]);
        if on_line.any(|source| source == feature) {
            for side in sides(id) {
                reach(side, 0, &mut steps, &mut rim);
            }
        }
    }
    let mut around = vec![Vec::new(); frame.subdomains()];
    for id in 0..frame.left.len() {
        let [left, right] = sides(id);
        if left != OUTSIDE && right != OUTSIDE {
            around[left as usize].push(right);
            around[right as usize].push(left);
        }
    }
    let mut step = 0;
    while !rim.is_empty() {
        step += 1;
        let mut next = Vec::new();
        for side in rim.drain(..) {
            for &near in &around[side as usize] {
                reach(near, step, &mut steps, &mut next);
            }
        }
        rim = next;
    }
    (0..frame.left.len())
        .map(|id| {
            let near = sides(id).into_iter().filter(|&side| side != OUTSIDE);
            near.map(|side| steps[side as usize]).min().unwrap_or(0)
        })
        .collect()
}
