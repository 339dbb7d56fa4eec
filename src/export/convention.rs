//! The UGRID-1.0 and CF conventions: which variables a mesh file has, and what is said of each.

use crate::chunk::views::IndexView;
use crate::export::classic::Header;
use crate::export::classic::Type;
use crate::export::classic::Value;
use crate::export::classic::Variable;
use crate::export::classic::text;
use crate::meshing::patch::Method;

const NODES: usize = 0;
const FACES: usize = 1;
const CORNERS: usize = 2;
const EDGES: usize = 3;
const ENDS: usize = 4;

// Rows of the variables in the header.
pub(crate) const MESH: usize = 0;
pub(crate) const PROJECTION: usize = 1;
pub(crate) const NODE_X: usize = 2;
pub(crate) const NODE_Y: usize = 3;
pub(crate) const FACE_NODES: usize = 4;
pub(crate) const SUBDOMAIN: usize = 5;
pub(crate) const METHOD: usize = 6;
pub(crate) const EDGE_NODES: usize = 7;
pub(crate) const EDGE_SOURCE: usize = 8;

/// The header of a mesh with so many `edges`.
pub(crate) fn header(index: &IndexView, edges: u64) -> Header {
    let [x, y] = ["projection_x_coordinate", "projection_y_coordinate"];
    Header {
        dimensions: vec![
            ("mesh2d_nNodes", index.nodes),
            ("mesh2d_nFaces", index.quads),
            ("mesh2d_nMax_face_nodes", 4),
            ("mesh2d_nEdges", edges),
            ("Two", 2),
        ],
        attributes: vec![
            text("Conventions", "CF-1.8 UGRID-1.0"),
            text("title", "All-quadrilateral flood mesh"),
            text("source", &format!("polder {}", index.polder)),
        ],
        variables: vec![
            topology(),
            projection(index),
            axis("mesh2d_node_x", x, "x of mesh nodes"),
            axis("mesh2d_node_y", y, "y of mesh nodes"),
            connectivity(
                "mesh2d_face_nodes",
                "face_node_connectivity",
                vec![FACES, CORNERS],
            ),
            subdomain(),
            method(),
            connectivity(
                "mesh2d_edge_nodes",
                "edge_node_connectivity",
                vec![EDGES, ENDS],
            ),
            edge_source(),
        ],
    }
}

fn topology() -> Variable {
    Variable {
        name: "mesh2d",
        kind: Type::Int,
        dimensions: vec![],
        attributes: vec![
            text("cf_role", "mesh_topology"),
            text("long_name", "Topology of the quadrilateral mesh"),
            ("topology_dimension", Value::Int(2)),
            text("node_coordinates", "mesh2d_node_x mesh2d_node_y"),
            text("edge_node_connectivity", "mesh2d_edge_nodes"),
            text("edge_dimension", "mesh2d_nEdges"),
            text("face_node_connectivity", "mesh2d_face_nodes"),
            text("face_dimension", "mesh2d_nFaces"),
            text("max_face_nodes_dimension", "mesh2d_nMax_face_nodes"),
        ],
    }
}

fn subdomain() -> Variable {
    let name = "sub-domain: the face of the line work that holds the cell";
    on(
        "face",
        "mesh2d_subdomain",
        Type::Int,
        vec![text("long_name", name)],
    )
}

fn method() -> Variable {
    let attributes = vec![
        text("long_name", "how the sub-domain was meshed"),
        ("flag_values", Value::Bytes(vec![0, 1, 2, 3, 4])),
        text("flag_meanings", &Method::NAMES.join(" ")),
    ];
    on("face", "mesh2d_method", Type::Byte, attributes)
}

fn edge_source() -> Variable {
    let name = "input feature of the line along the edge; -1: none";
    on(
        "edge",
        "mesh2d_edge_source",
        Type::Int,
        vec![text("long_name", name)],
    )
}

fn projection(index: &IndexView) -> Variable {
    let epsg = index.epsg.unwrap_or(0);
    let mut attributes = vec![
        text("name", "projected"),
        ("epsg", Value::Int(epsg as i32)),
        text("grid_mapping_name", "Unknown projected"),
        ("semi_major_axis", Value::Double(6_378_137.0)),
        ("inverse_flattening", Value::Double(298.257_223_563)),
    ];
    if index.epsg.is_some() {
        // Both spellings are in use: Deltares writes the first, GDAL reads the second.
        attributes.push(text("EPSG_code", &format!("EPSG:{epsg}")));
        attributes.push(text("spatial_ref", &format!("EPSG:{epsg}")));
    }
    Variable {
        name: "projected_coordinate_system",
        kind: Type::Int,
        dimensions: vec![],
        attributes,
    }
}

fn axis(name: &'static str, standard: &str, long: &str) -> Variable {
    Variable {
        name,
        kind: Type::Double,
        dimensions: vec![NODES],
        attributes: vec![
            text("units", "m"),
            text("standard_name", standard),
            text("long_name", long),
            text("mesh", "mesh2d"),
            text("location", "node"),
            text("grid_mapping", "projected_coordinate_system"),
        ],
    }
}

fn connectivity(name: &'static str, role: &str, dimensions: Vec<usize>) -> Variable {
    Variable {
        name,
        kind: Type::Int,
        dimensions,
        attributes: vec![
            text("cf_role", role),
            text("long_name", "node numbers; around a face counter-clockwise"),
            ("start_index", Value::Int(1)),
        ],
    }
}

/// A variable with a value for each edge or face.
fn on(
    location: &str,
    name: &'static str,
    kind: Type,
    mut attributes: Vec<(&'static str, Value)>,
) -> Variable {
    attributes.push(text("mesh", "mesh2d"));
    attributes.push(text("location", location));
    Variable {
        name,
        kind,
        dimensions: vec![if location == "edge" { EDGES } else { FACES }],
        attributes,
    }
}
