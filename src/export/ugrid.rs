//! UGRID-1.0 in classic NetCDF: nodes, edges with the line that runs along them, faces with their
//! sub-domain and method.

use crate::chunk::reader::Mesh;
use crate::chunk::views::PatchView;
use crate::export::Stats;
use crate::export::convention;
use crate::export::destination::Destination;
use crate::export::edges::Edges;
use crate::export::error::Error;
use crate::geometry::point::Xy;
use std::fs::File;
use std::io::BufWriter;
use std::io::Write;

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
    let (header, places) = convention::header(&index, edges.total).encode();
    let mut out = Sections::open(to, &header, &places)?;
    out.put(convention::MESH, &[0; 4])?;
    out.put(convention::PROJECTION, &[0; 4])?;
    out.put_nodes(mesh.frame().nodes, index.grid.origin_m)?;
    let (ends, sources) = edges.of_curves();
    out.put(convention::EDGE_NODES, &ends)?;
    out.put(convention::EDGE_SOURCE, &sources)?;
    for number in 0..mesh.chunks() {
        let chunk = mesh.chunk(number)?;
        for (row, patch) in (chunk.first_patch()..).zip(chunk.view().patches()) {
            let base = index.patch_node_base[row];
            out.put_nodes(patch.interior, index.grid.origin_m)?;
            out.put_faces(&patch, base)?;
            let ends = edges.inside(&patch, base);
            out.put(convention::EDGE_NODES, ends)?;
            // -1 for each: no line runs inside a patch.
            out.put(convention::EDGE_SOURCE, &vec![0xff; ends.len() / 2])?;
        }
    }
    edges.expect_all(mesh)?;
    let padding = (index.quads.next_multiple_of(4) - index.quads) as usize;
    out.put(convention::METHOD, &[0; 3][..padding])?;
    out.finish()?;
    Ok(Stats {
        nodes: index.nodes,
        quads: index.quads,
        ..Stats::default()
    })
}

/// A writer for each variable, so that each chunk is mapped once. Values are big-endian.
struct Sections<'a> {
    to: &'a Destination,
    variables: Vec<BufWriter<File>>,
    bytes: Vec<u8>,
}

impl<'a> Sections<'a> {
    fn open(to: &'a Destination, header: &[u8], places: &[u64]) -> Result<Sections<'a>, Error> {
        let mut head = to.section(0)?;
        head.write_all(header).map_err(|e| to.refused(e))?;
        head.flush().map_err(|e| to.refused(e))?;
        let mut variables = Vec::new();
        for &place in places {
            variables.push(to.section(place)?);
        }
        Ok(Sections {
            to,
            variables,
            bytes: Vec::new(),
        })
    }

    fn put(&mut self, variable: usize, bytes: &[u8]) -> Result<(), Error> {
        let section = &mut self.variables[variable];
        section.write_all(bytes).map_err(|e| self.to.refused(e))
    }

    /// Puts values one after the other.
    fn put_all<const N: usize>(
        &mut self,
        variable: usize,
        values: impl Iterator<Item = [u8; N]>,
    ) -> Result<(), Error> {
        let mut bytes = std::mem::take(&mut self.bytes);
        bytes.clear();
        values.for_each(|value| bytes.extend_from_slice(&value));
        let put = self.put(variable, &bytes);
        self.bytes = bytes;
        put
    }

    /// Nodes as the file wants them: axis by axis, projected.
    fn put_nodes(&mut self, places: &[Xy], origin_m: Xy) -> Result<(), Error> {
        for (axis, variable) in [convention::NODE_X, convention::NODE_Y]
            .into_iter()
            .enumerate()
        {
            let values = places
                .iter()
                .map(|p| (p[axis] + origin_m[axis]).to_be_bytes());
            self.put_all(variable, values)?;
        }
        Ok(())
    }

    fn put_faces(&mut self, patch: &PatchView, base: u64) -> Result<(), Error> {
        let corners = patch.quads.as_flattened().iter();
        let number = |&node: &u32| (patch.global(node, base) as i32 + 1).to_be_bytes();
        self.put_all(convention::FACE_NODES, corners.map(number))?;
        let subdomain = (patch.subdomain as i32).to_be_bytes();
        self.put_all(convention::SUBDOMAIN, patch.quads.iter().map(|_| subdomain))?;
        self.put_all(
            convention::METHOD,
            patch.quads.iter().map(|_| [patch.method]),
        )
    }

    fn finish(&mut self) -> Result<(), Error> {
        let flush = self.variables.iter_mut().try_for_each(BufWriter::flush);
        flush.map_err(|e| self.to.refused(e))
    }
}
