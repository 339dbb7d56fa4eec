//! UGRID-1.0 in classic NetCDF: nodes, edges with the line that runs along them, faces with their
//! sub-domain and method.
//!
//! Edges are those of the curves first, in the order of the frame, then those inside patches.

use crate::chunk::reader::Mesh;
use crate::chunk::views::IndexView;
use crate::export::Stats;
use crate::export::classic::Header;
use crate::export::classic::Type;
use crate::export::classic::Value;
use crate::export::classic::Variable;
use crate::export::classic::text;
use crate::export::destination::Destination;
use crate::export::edges::Edges;
use crate::export::error::Error;
use crate::geometry::point::Xy;
use std::io::Write;

const NODES: usize = 0;
const FACES: usize = 1;
const CORNERS: usize = 2;
const EDGES: usize = 3;
const ENDS: usize = 4;

pub(crate) fn write(mesh: &Mesh, to: &Destination) -> Result<Stats, Error> {
    let index = mesh.index();
    // Connectivity counts nodes from 1 in 32 bits; what counts faces is as wide as the file needs.
    if index.nodes > i32::MAX as u64 {
        return Err(Error::TooLarge {
            what: "nodes",
            found: index.nodes,
        });
    }
    let mut edges = Edges::of(mesh);
    let (header, places) = header(&index, edges.total).encode();
    // All variables are written side by side, so that each chunk is mapped once.
    let mut sections = Vec::new();
    for &place in [0].iter().chain(&places) {
        sections.push(to.section(place)?);
    }
    let [
        head,
        topology,
        projection,
        x,
        y,
        faces,
        subdomains,
        methods,
        ends,
        sources,
    ] = &mut sections[..]
    else {
        unreachable!("one section for the header and one a variable");
    };
    let io = |e| to.refused(e);
    head.write_all(&header).map_err(io)?;
    topology.write_all(&[0; 4]).map_err(io)?;
    projection.write_all(&[0; 4]).map_err(io)?;
    let origin_m = index.grid.origin_m;
    let mut places = Places {
        bytes: Vec::new(),
        origin_m,
    };
    x.write_all(places.axis(mesh.frame().nodes, 0))
        .map_err(io)?;
    y.write_all(places.axis(mesh.frame().nodes, 1))
        .map_err(io)?;
    let (curve_ends, curve_sources) = edges.of_curves();
    ends.write_all(&curve_ends).map_err(io)?;
    sources.write_all(&curve_sources).map_err(io)?;
    let mut bytes = Vec::new();
    for number in 0..mesh.chunks() {
        let chunk = mesh.chunk(number)?;
        for (row, patch) in (chunk.first_patch()..).zip(chunk.view().patches()) {
            x.write_all(places.axis(patch.interior, 0)).map_err(io)?;
            y.write_all(places.axis(patch.interior, 1)).map_err(io)?;
            let base = index.patch_node_base[row];
            bytes.clear();
            for &corner in patch.quads.as_flattened() {
                let node = patch.global(corner, base) + 1;
                bytes.extend_from_slice(&(node as i32).to_be_bytes());
            }
            faces.write_all(&bytes).map_err(io)?;
            bytes.clear();
            for _ in patch.quads {
                bytes.extend_from_slice(&(patch.subdomain as i32).to_be_bytes());
            }
            subdomains.write_all(&bytes).map_err(io)?;
            bytes.clear();
            bytes.resize(patch.quads.len(), patch.method);
            methods.write_all(&bytes).map_err(io)?;
            let inner = edges.inside(&patch, base);
            ends.write_all(inner).map_err(io)?;
            bytes.clear();
            bytes.resize(inner.len() / 2, 0xff); // -1: no line
            sources.write_all(&bytes).map_err(io)?;
        }
    }
    edges.expect_all(mesh)?;
    let padding = (index.quads.next_multiple_of(4) - index.quads) as usize;
    methods.write_all(&[0; 3][..padding]).map_err(io)?;
    for section in &mut sections {
        section.flush().map_err(io)?;
    }
    Ok(Stats {
        nodes: index.nodes,
        quads: index.quads,
        ..Stats::default()
    })
}

/// Coordinates as the file wants them: one axis, projected, big-endian.
struct Places {
    bytes: Vec<u8>,
    origin_m: Xy,
}

impl Places {
    fn axis(&mut self, places: &[Xy], axis: usize) -> &[u8] {
        self.bytes.clear();
        for place in places {
            let value = place[axis] + self.origin_m[axis];
            self.bytes.extend_from_slice(&value.to_be_bytes());
        }
        &self.bytes
    }
}

fn header(index: &IndexView, edges: u64) -> Header {
    let mut topology = Variable {
        name: "mesh2d",
        kind: Type::Int,
        dimensions: vec![],
        attributes: vec![
            text("cf_role", "mesh_topology"),
            text("long_name", "Topology of the quadrilateral mesh"),
        ],
    };
    topology
        .attributes
        .push(("topology_dimension", Value::Int(2)));
    for (name, value) in [
        ("node_coordinates", "mesh2d_node_x mesh2d_node_y"),
        ("edge_node_connectivity", "mesh2d_edge_nodes"),
        ("edge_dimension", "mesh2d_nEdges"),
        ("face_node_connectivity", "mesh2d_face_nodes"),
        ("face_dimension", "mesh2d_nFaces"),
        ("max_face_nodes_dimension", "mesh2d_nMax_face_nodes"),
    ] {
        topology.attributes.push(text(name, value));
    }
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
            topology,
            projection(index),
            axis(
                "mesh2d_node_x",
                "projection_x_coordinate",
                "x of mesh nodes",
            ),
            axis(
                "mesh2d_node_y",
                "projection_y_coordinate",
                "y of mesh nodes",
            ),
            connectivity(
                "mesh2d_face_nodes",
                "face_node_connectivity",
                vec![FACES, CORNERS],
            ),
            on(
                "face",
                "mesh2d_subdomain",
                Type::Int,
                vec![text(
                    "long_name",
                    "sub-domain: the face of the line work that holds the cell",
                )],
            ),
            on(
                "face",
                "mesh2d_method",
                Type::Byte,
                vec![
                    text("long_name", "how the sub-domain was meshed"),
                    ("flag_values", Value::Bytes(vec![0, 1, 2, 3, 4])),
                    text(
                        "flag_meanings",
                        "mapping looping strip indirect last_resort",
                    ),
                ],
            ),
            connectivity(
                "mesh2d_edge_nodes",
                "edge_node_connectivity",
                vec![EDGES, ENDS],
            ),
            on(
                "edge",
                "mesh2d_edge_source",
                Type::Int,
                vec![text(
                    "long_name",
                    "input feature of the line along the edge; -1: none",
                )],
            ),
        ],
    }
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
