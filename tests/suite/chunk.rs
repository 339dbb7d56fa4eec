//! The mesh on disk: what is written is what is read, and what is damaged says so.

use polder::chunk::chunk_name;
use polder::chunk::error::Error;
use polder::chunk::frame::Certificate;
use polder::chunk::frame::Frame;
use polder::chunk::linework::Limits;
use polder::chunk::linework::LineWork;
use polder::chunk::reader::Mesh;
use polder::chunk::record::ChunkReceipt;
use polder::chunk::record::PatchRecord;
use polder::chunk::writer::Existing;
use polder::chunk::writer::IndexRecord;
use polder::chunk::writer::Place;
use polder::chunk::writer::Writer;
use polder::chunk::writer::partial_of;
use polder::cleanup::changes::Change;
use polder::cleanup::changes::Dropped;
use polder::cleanup::changes::Reason;
use polder::cleanup::changes::Tally;
use polder::domain::finding::Finding;
use polder::domain::line::Domain;
use polder::domain::line::Line;
use polder::domain::line::Role;
use polder::geometry::grid::Grid;
use polder::geometry::point::Point;
use polder::geometry::point::Xy;
use polder::intervals::goals::Goals;
use polder::meshing::patch::Method;
use polder::noding::arrangement::Piece;
use polder::partition::subdomains::OUTSIDE;
use polder::partition::subdomains::Subdomain;
use std::fs;
use std::path::Path;
use std::path::PathBuf;
use std::process::Command;

/// A mesh by hand: 40 m x 20 m in cells of 10 m, a dyke across the middle, and a wall that ends in
/// the open (a slit) in the eastern half.
///
/// ```text
///   1 -- 11 -- 3 -- 10 -- 7
///   |    |     |    |     |
///   12 - x --- 13 - 4 === 6      === the wall, digitised from 6 to 4
///   |    |     |    |     |      2 - 13 - 3 the dyke
///   0 -- 8 --- 2 -- 9 --- 5
/// ```
pub struct Tiny {
    pub domain: Domain,
    pub frame: Frame,
    pub patches: Vec<PatchRecord>,
    pub dropped: Vec<Dropped>,
    pub changes: Vec<Change>,
    pub tally: Tally,
    pub min_edge_m: f64,
    pub findings: Vec<Finding>,
}

const NODES: [Xy; 14] = [
    [0.0, 0.0],
    [0.0, 20.0],
    [20.0, 0.0],
    [20.0, 20.0],
    [30.0, 10.0],
    [40.0, 0.0],
    [40.0, 10.0],
    [40.0, 20.0],
    [10.0, 0.0],
    [30.0, 0.0],
    [30.0, 20.0],
    [10.0, 20.0],
    [0.0, 10.0],
    [20.0, 10.0],
];

/// Nodes, left, right, line, station of the first node, step of the station along the curve.
type Row = (&'static [u32], u32, u32, u32, f64, f64);

const CURVES: [Row; 9] = [
    (&[0, 8, 2], 0, OUTSIDE, 0, 0.0, 10.0),
    (&[2, 9, 5], 1, OUTSIDE, 0, 20.0, 10.0),
    (&[5, 6], 1, OUTSIDE, 0, 40.0, 10.0),
    (&[6, 7], 1, OUTSIDE, 0, 50.0, 10.0),
    (&[7, 10, 3], 1, OUTSIDE, 0, 60.0, 10.0),
    (&[3, 11, 1], 0, OUTSIDE, 0, 80.0, 10.0),
    (&[1, 12, 0], 0, OUTSIDE, 0, 100.0, 10.0),
    (&[2, 13, 3], 0, 1, 1, 0.0, 10.0),
    (&[4, 6], 1, 1, 2, 10.0, -10.0),
];

pub const DYKE: usize = 7;

fn line(source: u32, role: Role, kind: u16, name: &str, points_m: &[[i32; 2]]) -> Line {
    Line {
        source,
        role,
        kind,
        name: name.into(),
        points: (points_m.iter())
            .map(|p| Point::new(1000 * p[0], 1000 * p[1]))
            .collect(),
    }
}

fn tiny_domain() -> Domain {
    let ring = [[0, 0], [40, 0], [40, 20], [0, 20], [0, 0]];
    Domain {
        grid: Grid {
            origin_m: [250_000.0, 4_000_000.0],
            cell_m: 0.001,
        },
        epsg: Some(32_631),
        kinds: vec![String::new(), "dyke".into(), "wall".into()],
        lines: vec![
            line(0, Role::Boundary, 0, "", &ring),
            line(
                1,
                Role::Constraint,
                1,
                "the \"old\" dyke",
                &[[20, 0], [20, 20]],
            ),
            line(2, Role::Constraint, 2, "", &[[40, 10], [30, 10]]),
            line(5, Role::Constraint, 2, "stub", &[[5, 5], [6, 5]]),
        ],
        digest: 0x1234_5678_9abc_def0,
    }
}

fn tiny_frame() -> Frame {
    let mut frame = Frame {
        nodes: NODES.to_vec(),
        fixed_nodes: 8,
        curve_start: vec![0],
        piece_start: vec![0],
        size_m: vec![10.0; 2],
        ..Frame::default()
    };
    let mut goals = Goals::default();
    for (nodes, left, right, line, start, step) in CURVES {
        frame.curve_nodes.extend(nodes);
        frame.curve_start.push(frame.curve_nodes.len() as u32);
        frame.left.push(left);
        frame.right.push(right);
        frame.is_seam.push(false);
        for k in 0..nodes.len() - 1 {
            let from_m = start + step * k as f64;
            let to_m = from_m + step;
            frame.pieces.push(Piece { line, from_m, to_m });
            frame.piece_start.push(frame.pieces.len() as u32);
        }
        goals.goal.push(nodes.len() as f64 - 1.0);
        goals.lower.push(1);
        goals.upper.push(9);
        goals.weight.push(1.0);
    }
    // One interval is a little cheaper than two here, but leaves sub-domain 0 odd: the optimum
    // is to pay for two, and the set {0} with that price as its dual proves it.
    goals.goal[0] = 1.4;
    let units = |n: u32| (goals.cost(0, n) / 1e-6).round() as i64;
    frame.certificate = Some(Certificate {
        cost_unit: 1e-6,
        objective: units(2),
        base: units(1),
        bound: units(2),
        solved: polder::parity::balance::Solved::default(),
        set_parent: vec![u32::MAX],
        set_dual2: vec![2 * (units(2) - units(1))],
        set_of: vec![0, u32::MAX],
    });
    frame.goals = goals;
    let half = |curve: u32, reversed: u32| curve << 1 | reversed;
    let west = [half(0, 0), half(7, 0), half(5, 0), half(6, 0)];
    let east = [
        half(1, 0),
        half(2, 0),
        half(8, 1),
        half(8, 0),
        half(3, 0),
        half(4, 0),
        half(7, 1),
    ];
    for walk in [west.to_vec(), east.to_vec()] {
        frame.subdomains.push(Subdomain {
            walks: vec![walk],
            area_m2: 400.0,
        });
    }
    frame
}

pub fn tiny() -> Tiny {
    let west = PatchRecord {
        subdomain: 0,
        method: Method::Mapping,
        last_resort_quads: 0,
        boundary: vec![0, 8, 2, 13, 3, 11, 1, 12],
        interior: vec![[10.0, 10.0]],
        quads: vec![[0, 1, 8, 7], [1, 2, 3, 8], [7, 8, 5, 6], [8, 3, 4, 5]],
    };
    let east = PatchRecord {
        subdomain: 1,
        method: Method::Looping,
        last_resort_quads: 2,
        boundary: vec![2, 9, 5, 6, 4, 7, 10, 3, 13],
        interior: vec![],
        quads: vec![[0, 1, 4, 8], [1, 2, 3, 4], [8, 4, 6, 7], [4, 3, 5, 6]],
    };
    Tiny {
        domain: tiny_domain(),
        frame: tiny_frame(),
        patches: vec![west, east],
        dropped: vec![Dropped {
            line: 3,
            reason: Reason::ShortEnd,
            from_m: 0.0,
            to_m: 1.0,
        }],
        changes: vec![Change {
            what: "joined-end",
            at: Point::new(40_000, 10_000),
            moved_m: 0.25,
        }],
        tally: Tally {
            rows: vec![("joined-end", 1, 0.25), ("merged-nodes", 0, 0.0)],
            displacement_max_m: 0.25,
            displacement_p99_m: 0.2,
            displacement_max_over_size: 0.05,
            displacement_p99_over_size: 0.01,
            length_m: 31.0,
            length_dropped_m: 1.0,
            sharp_angles: [2, 1],
        },
        min_edge_m: 0.0,
        findings: vec![
            Finding {
                what: "short-line",
                text: "shorter than the mesh can show".into(),
                feature: Some(5),
                at_m: Some([250_005.0, 4_000_005.0]),
            },
            Finding {
                what: "no-crs",
                text: "taken as metres".into(),
                feature: None,
                at_m: None,
            },
        ],
    }
}

impl Tiny {
    pub fn writer(&self, out: &Path) -> Writer {
        let place = Place {
            epsg: self.domain.epsg,
            grid: self.domain.grid,
        };
        Writer::create(out, Existing::Refuse, place).unwrap()
    }

    pub fn index(&self) -> IndexRecord {
        IndexRecord {
            size_m: 10.0,
            tolerance_m: 1.0,
            job: "{\"size\":10}".into(),
            input_digest: self.domain.digest,
        }
    }

    /// All but sealing, one chunk a patch.
    pub fn write_parts(&self, writer: &Writer) -> Vec<ChunkReceipt> {
        writer.write_frame(&self.frame).unwrap();
        let kinds = self.domain.kinds.len();
        let limits = Limits {
            tolerance_by_kind_m: vec![1.0; kinds],
            min_edge_by_kind_m: vec![self.min_edge_m; kinds],
            min_edge_m: self.min_edge_m,
        };
        let lines = LineWork {
            limits: &limits,
            domain: &self.domain,
            dropped: &self.dropped,
            changes: &self.changes,
            tally: &self.tally,
            findings: &self.findings,
        };
        writer.write_lines(&lines).unwrap();
        (0..)
            .zip(&self.patches)
            .map(|(n, patch)| writer.write_chunk(n, std::slice::from_ref(patch)).unwrap())
            .collect()
    }

    pub fn write(&self, out: &Path) {
        let writer = self.writer(out);
        let receipts = self.write_parts(&writer);
        writer.seal(receipts, &self.index()).unwrap();
    }

    /// Written into a directory of its own, and opened.
    pub fn mesh(&self) -> (tempfile::TempDir, Mesh) {
        let dir = tempfile::tempdir().unwrap();
        let out = dir.path().join("tiny.polder");
        self.write(&out);
        let mesh = Mesh::open(&out).unwrap();
        (dir, mesh)
    }
}

#[test]
fn what_is_written_is_what_is_read() {
    let tiny = tiny();
    let (_dir, mesh) = tiny.mesh();
    let (index, frame, lines) = (mesh.index(), mesh.frame(), mesh.lines());
    assert_eq!((index.epsg, index.grid), (Some(32_631), tiny.domain.grid));
    assert_eq!(
        (index.nodes, index.quads, index.boundary_nodes),
        (15, 8, 14)
    );
    assert_eq!(index.box_m, [0.0, 0.0, 40.0, 20.0]);
    assert_eq!((index.size_m, index.tolerance_m), (10.0, 1.0));
    assert_eq!(
        (index.job, index.input_digest),
        ("{\"size\":10}", tiny.domain.digest)
    );
    assert_eq!(index.patch_node_base, [14, 15, 15]);
    assert_eq!(index.patch_quad_base, [0, 4, 8]);
    assert_eq!(frame.nodes, NODES);
    assert_eq!(frame.nodes_of(DYKE), [2, 13, 3]);
    assert_eq!(frame.edges_of(DYKE), 12..14);
    assert!(frame.is_rim(0) && !frame.is_rim(DYKE) && !frame.is_seam(DYKE));
    let walk: Vec<[u32; 2]> = frame.walk_edges(1).collect();
    assert_eq!(walk.len(), 10);
    assert_eq!(walk[3..5], [[6, 4], [4, 6]]);
    let wanted = tiny.frame.certificate.unwrap();
    let read = frame.certificate.unwrap();
    assert_eq!(
        (read.objective, read.bound, &read.solved),
        (wanted.objective, wanted.bound, &wanted.solved)
    );
    assert_eq!(
        (read.set_dual2, read.set_of),
        (&wanted.set_dual2[..], &wanted.set_of[..])
    );
    assert_eq!(lines.source, [0, 1, 2, 5]);
    assert_eq!((lines.kind(1), lines.name(1)), ("dyke", "the \"old\" dyke"));
    assert_eq!(lines.stations_m(0), tiny.domain.stations_m(0));
    assert_eq!(
        (lines.dropped_line, lines.dropped_reason),
        (&[3][..], &[1][..])
    );
    assert_eq!(
        (lines.change_what(0), lines.change_at),
        ("joined-end", &[[40_000, 10_000]][..])
    );
    assert_eq!(lines.tally().collect::<Vec<_>>(), tiny.tally.rows);
    let found: Vec<_> = lines.findings().collect();
    assert_eq!((found[0].what, found[0].feature), ("short-line", Some(5)));
    assert_eq!(
        (found[0].at_m, found[1].at_m),
        (tiny.findings[0].at_m, None)
    );
}

#[test]
fn patches_are_read_as_written_with_arithmetic_ids() {
    let tiny = tiny();
    let (_dir, mesh) = tiny.mesh();
    assert_eq!(mesh.chunks(), 2);
    let chunk = mesh.chunk(0).unwrap();
    let patch = chunk.view().patch(0);
    let record = &tiny.patches[0];
    assert_eq!(
        (patch.boundary, patch.interior),
        (&record.boundary[..], &record.interior[..])
    );
    assert_eq!((patch.quads, patch.method), (&record.quads[..], 0));
    assert_eq!((patch.global(2, 14), patch.global(8, 14)), (2, 14));
    let mut places = Vec::new();
    patch.place_into(mesh.frame().nodes, &mut places);
    assert_eq!((places[3], places[8]), ([20.0, 10.0], [10.0, 10.0]));
}

#[test]
fn receipts_can_be_read_again() {
    let tiny = tiny();
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("a.polder");
    let receipts = tiny.write_parts(&tiny.writer(&out));
    let place = Place {
        epsg: tiny.domain.epsg,
        grid: tiny.domain.grid,
    };
    let writer = Writer::reopen(&out, Existing::Refuse, place).unwrap();
    let again = [1, 0].map(|n| writer.receipt(n).unwrap());
    assert_eq!(again[1], receipts[0]);
    // Any order will do.
    writer.seal(again.to_vec(), &tiny.index()).unwrap();
    assert_eq!(Mesh::open(&out).unwrap().index().quads, 8);
}

#[test]
fn same_records_same_bytes() {
    let dir = tempfile::tempdir().unwrap();
    let outs = ["a.polder", "b.polder"].map(|name| dir.path().join(name));
    outs.iter().for_each(|out| tiny().write(out));
    for name in ["index", "frame", "lines", "chunk-00000", "chunk-00001"] {
        let [a, b] = [&outs[0], &outs[1]].map(|out| fs::read(out.join(name)).unwrap());
        assert!(a == b, "{name}");
    }
}

#[test]
fn nothing_is_there_until_all_is_there() {
    let tiny = tiny();
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("a.polder");
    let writer = tiny.writer(&out);
    let mut receipts = tiny.write_parts(&writer);
    assert!(!out.exists());
    let first = receipts.remove(0);
    let error = writer.seal(receipts, &tiny.index()).unwrap_err();
    assert!(error.to_string().contains(&chunk_name(0)), "{error}");
    assert!(!out.exists());
    // A sub-domain that no chunk has is no mesh either.
    let writer = tiny.writer(&out);
    tiny.write_parts(&writer);
    let error = writer.seal(vec![first], &tiny.index()).unwrap_err();
    assert!(error.to_string().contains("sub-domain 1"), "{error}");
    assert!(!out.exists() && partial_of(&out).exists());
    tiny.writer(&out).discard().unwrap();
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
}

#[test]
fn an_existing_output_is_refused_or_replaced_when_complete() {
    let tiny = tiny();
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("a.polder");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("precious"), "x").unwrap();
    let place = Place {
        epsg: None,
        grid: tiny.domain.grid,
    };
    let error = Writer::create(&out, Existing::Refuse, place).unwrap_err();
    assert!(matches!(error, Error::Exists(_)) && error.to_string().contains("--force"));
    let writer = Writer::create(&out, Existing::Replace, place).unwrap();
    let receipts = tiny.write_parts(&writer);
    assert!(out.join("precious").exists());
    writer.seal(receipts, &tiny.index()).unwrap();
    assert!(!out.join("precious").exists());
    Mesh::open(&out).unwrap();
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
}

#[test]
fn the_world_refusing_names_the_path() {
    let tiny = tiny();
    let place = Place {
        epsg: None,
        grid: tiny.domain.grid,
    };
    let nowhere = Path::new("/nonexistent-parent/a.polder");
    let error = Writer::create(nowhere, Existing::Refuse, place).unwrap_err();
    assert!(error.to_string().contains("/nonexistent-parent"), "{error}");
    let error = Mesh::open(nowhere).unwrap_err();
    assert!(
        error.is_broken_mesh() && error.to_string().contains("missing"),
        "{error}"
    );
    let full = Error::Io {
        doing: "write",
        path: PathBuf::from("a.polder.partial/chunk-00007"),
        source: std::io::Error::from(std::io::ErrorKind::StorageFull),
    };
    let text = full.to_string();
    assert!(
        text.contains("chunk-00007") && text.contains("free some space"),
        "{text}"
    );
}

/// Any single flipped bit and any cut is found, in any file.
#[test]
fn damage_is_found_and_named() {
    let tiny = tiny();
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("a.polder");
    tiny.write(&out);
    let read = || -> Result<(), Error> {
        let mesh = Mesh::open(&out)?;
        (0..mesh.chunks()).try_for_each(|n| mesh.chunk(n).map(|_| ()))
    };
    read().unwrap();
    for name in ["index", "frame", "lines", "chunk-00000", "chunk-00001"] {
        let path = out.join(name);
        let whole = fs::read(&path).unwrap();
        let mut damaged: Vec<Vec<u8>> = vec![vec![], whole[..11].to_vec()];
        damaged.extend((1..8).map(|k| whole[..whole.len() * k / 8].to_vec()));
        for at in (0..whole.len()).step_by(whole.len() / 60) {
            let mut flipped = whole.clone();
            flipped[at] ^= 1 << (at % 8);
            damaged.push(flipped);
        }
        for bytes in damaged {
            fs::write(&path, bytes).unwrap();
            let error = read().unwrap_err();
            assert!(error.is_broken_mesh(), "{error}");
            assert!(error.to_string().contains(name), "{error}");
        }
        fs::remove_file(&path).unwrap();
        let error = read().unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
        fs::write(&path, whole).unwrap();
    }
    read().unwrap();
}

#[test]
fn files_of_two_meshes_do_not_mix() {
    let dir = tempfile::tempdir().unwrap();
    let [a, b] = ["a.polder", "b.polder"].map(|name| dir.path().join(name));
    tiny().write(&a);
    let mut other = tiny();
    other.frame.nodes[13] = [20.5, 10.0];
    other.patches[0].interior[0] = [11.0, 10.0];
    other.write(&b);
    fs::copy(b.join("chunk-00000"), a.join("chunk-00000")).unwrap();
    let error = Mesh::open(&a).unwrap().chunk(0).unwrap_err();
    assert!(error.to_string().contains("chunk-00000"), "{error}");
    fs::copy(b.join("frame"), a.join("frame")).unwrap();
    assert!(Mesh::open(&a).unwrap_err().to_string().contains("frame"));
}

/// A file with a right checksum whose content does not fit together is an error, not a panic.
#[test]
fn nonsense_with_a_right_checksum_is_refused() {
    let mut bad = tiny();
    bad.frame.curve_nodes[3] = 99;
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("a.polder");
    let writer = bad.writer(&out);
    let receipts = bad.write_parts(&writer);
    let error = writer.seal(receipts, &bad.index()).unwrap_err();
    assert!(error.to_string().contains("curve_nodes"), "{error}");
    assert!(!out.exists());
}

/// The checked-in code is what the schemas say. Needs flatc of the crate's version.
#[test]
fn generated_code_is_that_of_the_schemas() {
    let flatc = std::env::var("FLATC").unwrap_or("flatc".into());
    let version = Command::new(&flatc).arg("--version").output();
    let fits = version.is_ok_and(|it| {
        String::from_utf8_lossy(&it.stdout)
            .trim_end()
            .ends_with("25.12.19")
    });
    if !fits {
        println!("skipped: no flatc 25.12.19 (set FLATC)");
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let run = Command::new("tools/flatc")
        .arg(dir.path())
        .status()
        .unwrap();
    assert!(run.success());
    for name in ["index", "frame", "lines", "chunk"] {
        let file = format!("{name}_generated.rs");
        let [made, kept] = [dir.path(), Path::new("src/chunk/generated")]
            .map(|folder| fs::read_to_string(folder.join(&file)).unwrap());
        assert!(made == kept, "{file} is stale: run tools/flatc");
    }
}
