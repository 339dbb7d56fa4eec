//! Exports: read back by foreign readers where they are installed, and by hand where not.

use crate::chunk::tiny;
use polder::export::Format;
use polder::export::export;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

/// A Python with `modules`, or `None` (said aloud). POLDER_PYTHON names another than `python3`.
fn python_with(modules: &str) -> Option<String> {
    let python = std::env::var("POLDER_PYTHON").unwrap_or("python3".into());
    let import = format!("import {modules}");
    let run = Command::new(&python).args(["-c", &import]).output();
    if run.is_ok_and(|it| it.status.success()) {
        return Some(python);
    }
    println!("skipped: {python} has no {modules} (set POLDER_PYTHON)");
    None
}

fn run(python: &str, script: &str, file: &Path) -> String {
    let run = Command::new(python)
        .args(["-c", script])
        .arg(file)
        .output()
        .unwrap();
    let [out, err] = [&run.stdout, &run.stderr].map(|it| String::from_utf8_lossy(it).into_owned());
    assert!(run.status.success(), "{out}{err}");
    out
}

#[test]
fn ugrid_is_read_by_netcdf_as_written() {
    let (dir, mesh) = tiny().mesh();
    let out = dir.path().join("tiny.nc");
    let stats = export(&mesh, Format::Ugrid, &out).unwrap();
    assert_eq!((stats.nodes, stats.quads), (15, 8));
    assert_eq!(stats.bytes, fs::metadata(&out).unwrap().len());
    let Some(python) = python_with("netCDF4") else {
        return;
    };
    let script = "
import netCDF4, sys
d = netCDF4.Dataset(sys.argv[1])
print(d.data_model, d['mesh2d_face_nodes'].start_index, d['projected_coordinate_system'].epsg)
print(float(d['mesh2d_node_x'][14]), float(d['mesh2d_node_y'][14]))
print(d['mesh2d_face_nodes'][0].tolist(), d['mesh2d_face_nodes'][7].tolist())
print(d['mesh2d_subdomain'][:].tolist(), d['mesh2d_method'][:].tolist())
e, s = d['mesh2d_edge_nodes'][:].tolist(), d['mesh2d_edge_source'][:].tolist()
print(len(e), len(set(tuple(sorted(x)) for x in e)), [(x, t) for x, t in zip(e, s) if t >= 0])
";
    let wanted = "NETCDF3_64BIT_OFFSET 1 32631\n250010.0 4000010.0\n[1, 9, 15, 13] [5, 7, 8, 11]\n\
                  [0, 0, 0, 0, 1, 1, 1, 1] [0, 0, 0, 0, 1, 1, 1, 1]\n\
                  22 22 [([3, 14], 1), ([14, 4], 1), ([5, 7], 2)]\n";
    assert_eq!(run(&python, script, &out), wanted);
}

#[test]
fn ugrid_opens_in_xugrid() {
    let (dir, mesh) = tiny().mesh();
    let out = dir.path().join("tiny.nc");
    export(&mesh, Format::Ugrid, &out).unwrap();
    let Some(python) = python_with("xugrid") else {
        return;
    };
    let script = "
import xugrid, sys
d = xugrid.open_dataset(sys.argv[1])
g = d.ugrid.grid
print(g.n_face, g.n_node, g.n_edge, float(g.area.sum()))
";
    assert_eq!(run(&python, script, &out), "8 15 22 800.0\n");
}

#[test]
fn ugrid_passes_the_conformance_checker() {
    let (dir, mesh) = tiny().mesh();
    let out = dir.path().join("tiny.nc");
    export(&mesh, Format::Ugrid, &out).unwrap();
    let Some(python) = python_with("ugrid_checks") else {
        return;
    };
    let script = "
import sys
from ugrid_checks.check import check_dataset
c = check_dataset(sys.argv[1], print_summary=False)
print([r.msg for r in c.logger.report_statement_logrecords()])
";
    let said = run(&python, script, &out);
    assert_eq!(said, "[]\n");
}

#[test]
fn sms_has_cards_in_order_and_strings_in_direction() {
    let (dir, mesh) = tiny().mesh();
    let out = dir.path().join("tiny.2dm");
    let stats = export(&mesh, Format::Sms, &out).unwrap();
    assert_eq!((stats.nodes, stats.quads, stats.features), (15, 8, 2));
    let text = fs::read_to_string(&out).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "MESH2D");
    assert!(lines.contains(&"E4Q 1 1 9 15 13 1"));
    assert!(lines.contains(&"ND 15 250010.0 4000010.0 0.0"));
    assert_eq!(lines[lines.len() - 2..], ["NS 3 14 -4 1", "NS 7 -5 2"]);
    let Some(python) = python_with("py2dm") else {
        return;
    };
    let script = "
import py2dm, sys
with py2dm.Reader(sys.argv[1]) as m:
    print(m.num_nodes, m.num_elements, m.num_node_strings)
    print([list(s.nodes) for s in m.iter_node_strings()])
";
    assert_eq!(run(&python, script, &out), "15 8 2\n[[3, 14, 4], [7, 5]]\n");
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn lines_are_drawn_along_mesh_nodes_as_digitised() {
    let (dir, mesh) = tiny().mesh();
    let out = dir.path().join("lines.geojson");
    assert_eq!(export(&mesh, Format::Lines, &out).unwrap().features, 2);
    let made = json(&out);
    assert_eq!(
        made["crs"]["properties"]["name"],
        "urn:ogc:def:crs:EPSG::32631"
    );
    let [dyke, wall] = [&made["features"][0], &made["features"][1]];
    assert_eq!(dyke["properties"]["source"], 1);
    assert_eq!(dyke["properties"]["kind"], "dyke");
    assert_eq!(dyke["properties"]["name"], "the \"old\" dyke");
    assert_eq!(dyke["properties"]["left"], serde_json::json!([0]));
    assert_eq!(dyke["properties"]["right"], serde_json::json!([1]));
    assert_eq!(dyke["properties"]["edges"], serde_json::json!([2]));
    let [x, y] = [250_000.0, 4_000_000.0];
    let through = serde_json::json!([[x + 20.0, y], [x + 20.0, y + 10.0], [x + 20.0, y + 20.0]]);
    assert_eq!(floats(&dyke["geometry"]["coordinates"]), floats(&through));
    let back = serde_json::json!([[x + 40.0, y + 10.0], [x + 30.0, y + 10.0]]);
    assert_eq!(floats(&wall["geometry"]["coordinates"]), floats(&back));
}

#[test]
fn cleaned_lines_leave_out_nodes_within_straight_edges() {
    let (dir, mesh) = tiny().mesh();
    let out = dir.path().join("lines.geojson");
    export(&mesh, Format::CleanedLines, &out).unwrap();
    let dyke = &json(&out)["features"][0]["geometry"]["coordinates"];
    assert_eq!(dyke.as_array().unwrap().len(), 2);
}

#[test]
fn changes_hold_dropped_stretches_of_the_line_as_read() {
    let (dir, mesh) = tiny().mesh();
    let out = dir.path().join("changes.geojson");
    assert_eq!(export(&mesh, Format::Changes, &out).unwrap().features, 2);
    let made = json(&out);
    let [stub, joined] = [&made["features"][0], &made["features"][1]];
    assert_eq!(
        (&stub["properties"]["source"], &stub["properties"]["reason"]),
        (&Value::from(5), &Value::from("short-end"))
    );
    let wanted = [[250_005.0, 4_000_005.0], [250_006.0, 4_000_005.0]].concat();
    assert_eq!(floats(&stub["geometry"]["coordinates"]), wanted);
    assert_eq!(
        (
            &joined["properties"]["source"],
            &joined["properties"]["what"]
        ),
        (&Value::from(-1), &Value::from("joined-end"))
    );
}

#[test]
fn changes_show_what_was_moved_before_and_after() {
    let mut tiny = tiny();
    let mut lines = tiny.domain.lines.iter_mut();
    let dyke = lines.find(|it| it.name.contains("dyke")).unwrap();
    dyke.points.iter_mut().for_each(|it| it.x += 1_200);
    let (dir, mesh) = tiny.mesh();
    let out = dir.path().join("changes.geojson");
    export(&mesh, Format::Changes, &out).unwrap();
    let made = json(&out);
    let features = made["features"].as_array().unwrap().iter();
    let moved: Vec<&Value> = (features.filter(|it| it["properties"]["what"] == "moved")).collect();
    let states = moved
        .iter()
        .map(|it| it["properties"]["state"].as_str().unwrap());
    assert_eq!(states.collect::<Vec<_>>(), ["before", "after"]);
    assert_eq!(moved[0]["properties"]["name"], "the \"old\" dyke");
    assert_eq!(moved[0]["properties"]["moved_m"], 1.2);
    let [before, after] = [moved[0], moved[1]].map(|it| floats(&it["geometry"]["coordinates"]));
    assert!(
        (before[0] - after[0] - 1.2).abs() < 1e-6,
        "{before:?} {after:?}"
    );
}

fn floats(coordinates: &Value) -> Vec<f64> {
    let pairs = coordinates.as_array().unwrap().iter();
    pairs
        .flat_map(|it| it.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()))
        .collect()
}

#[test]
fn a_failed_export_leaves_nothing() {
    let (dir, mesh) = tiny().mesh();
    let out = dir.path().join("missing/tiny.nc");
    let error = export(&mesh, Format::Ugrid, &out).unwrap_err();
    assert!(error.to_string().contains("missing/tiny.nc"), "{error}");
    fs::remove_file(mesh.dir().join("chunk-00001")).unwrap();
    for format in [Format::Ugrid, Format::Sms] {
        let out = dir.path().join("tiny.out");
        let error = export(&mesh, format, &out).unwrap_err();
        assert!(error.to_string().contains("chunk-00001"), "{error}");
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    }
}

/// CDF-5, which needs more than 2^31 quads, is not written in a test; its header is.
#[test]
fn same_mesh_same_bytes() {
    let (dir, mesh) = tiny().mesh();
    for format in Format::NAMES.map(|it| it.1) {
        let outs = ["a", "b"].map(|name| dir.path().join(name));
        outs.iter().for_each(|out| {
            export(&mesh, format, out).unwrap();
        });
        let [a, b] = outs.map(|out| fs::read(out).unwrap());
        assert!(a == b, "{format:?}");
    }
}
