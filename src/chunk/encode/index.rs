//! Receipts -> the bytes of the index.

use crate::chunk::SCHEMA;
use crate::chunk::chunk_name;
use crate::chunk::encode::Builder;
use crate::chunk::encode::Encoded;
use crate::chunk::encode::offsets;
use crate::chunk::generated::index as index_file;
use crate::chunk::record::ChunkReceipt;
use crate::chunk::record::NO_BOX;
use crate::chunk::record::widened;
use crate::chunk::store::Stored;
use crate::chunk::writer::IndexRecord;
use crate::chunk::writer::Place;
use crate::geometry::point::Xy;

/// All that the index is made from.
pub(crate) struct IndexParts<'a> {
    pub place: &'a Place,
    pub record: &'a IndexRecord,
    /// By number, without gaps.
    pub receipts: &'a [ChunkReceipt],
    /// Positions of the boundary nodes.
    pub boundary: &'a [Xy],
    /// Name and checksum of the other files.
    pub others: &'a [(&'a str, Stored)],
}

/// The bytes of the index file.
pub(crate) fn index(parts: &IndexParts) -> Encoded {
    let mut b = Builder::new();
    let patches = || parts.receipts.iter().flat_map(|receipt| &receipt.patches);
    let (mut node_base, mut quad_base) = (vec![parts.boundary.len() as u64], vec![0_u64]);
    for patch in patches() {
        node_base.push(node_base[node_base.len() - 1] + patch.interior);
        quad_base.push(quad_base[quad_base.len() - 1] + patch.quads);
    }
    let subdomain: Vec<u32> = patches().map(|patch| patch.subdomain).collect();
    let method: Vec<u8> = patches().map(|patch| patch.method).collect();
    let chunk_start = offsets(parts.receipts.iter().map(|receipt| receipt.patches.len()));
    let box_m = (parts.receipts.iter()).fold(widened(NO_BOX, parts.boundary), |a, receipt| {
        let b = receipt.box_m;
        [
            a[0].min(b[0]),
            a[1].min(b[1]),
            a[2].max(b[2]),
            a[3].max(b[3]),
        ]
    });
    let chunks = (parts.receipts.iter()).map(|r| (chunk_name(r.number), r.bytes, r.crc32));
    let others = (parts.others.iter()).map(|(name, it)| (name.to_string(), it.bytes, it.crc32));
    let mut files = Vec::new();
    for (name, bytes, crc32) in others.chain(chunks) {
        let name = Some(b.create_string(&name));
        let args = index_file::FileArgs { name, bytes, crc32 };
        files.push(index_file::File::create(&mut b, &args));
    }
    let args = index_file::IndexArgs {
        schema: SCHEMA,
        polder: Some(b.create_string(env!("CARGO_PKG_VERSION"))),
        epsg: parts.place.epsg.unwrap_or(0),
        origin_x_m: parts.place.grid.origin_m[0],
        origin_y_m: parts.place.grid.origin_m[1],
        cell_m: parts.place.grid.cell_m,
        size_m: parts.record.size_m,
        tolerance_m: parts.record.tolerance_m,
        job: Some(b.create_string(&parts.record.job)),
        input_digest: parts.record.input_digest,
        boundary_nodes: parts.boundary.len() as u64,
        nodes: node_base[node_base.len() - 1],
        quads: quad_base[quad_base.len() - 1],
        box_m: Some(b.create_vector(&box_m)),
        chunk_start: Some(b.create_vector(&chunk_start)),
        patch_subdomain: Some(b.create_vector(&subdomain)),
        patch_method: Some(b.create_vector(&method)),
        patch_node_base: Some(b.create_vector(&node_base)),
        patch_quad_base: Some(b.create_vector(&quad_base)),
        files: Some(b.create_vector(&files)),
    };
    let root = index_file::Index::create(&mut b, &args);
    index_file::finish_index_buffer(&mut b, root);
    Encoded::from(b)
}
