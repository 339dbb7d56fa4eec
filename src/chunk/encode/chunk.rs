//! Patches -> the bytes of a chunk file.

use crate::chunk::SCHEMA;
use crate::chunk::encode::Encoded;
use crate::chunk::encode::builder_for;
use crate::chunk::encode::offsets;
use crate::chunk::error::Error;
use crate::chunk::generated::chunk as chunk_file;
use crate::chunk::record::PatchRecord;
use crate::chunk::writer::Place;
use std::path::Path;

/// The bytes of a chunk file.
pub(crate) fn chunk(
    number: u32,
    patches: &[PatchRecord],
    place: &Place,
    path: &Path,
) -> Result<Encoded, Error> {
    let bytes = patches.iter().map(PatchRecord::bytes).sum();
    let mut builder = builder_for(bytes, path)?;
    let subdomain: Vec<u32> = patches.iter().map(|p| p.subdomain).collect();
    let method: Vec<u8> = patches.iter().map(|p| p.method as u8).collect();
    let last_resort: Vec<u32> = patches.iter().map(|p| p.last_resort_quads).collect();
    let boundary_start = offsets(patches.iter().map(|p| p.boundary.len()));
    let interior_start = offsets(patches.iter().map(|p| p.interior.len()));
    let quad_start = offsets(patches.iter().map(|p| p.quads.len()));
    let boundary: Vec<u32> = (patches.iter().flat_map(|p| &p.boundary).copied()).collect();
    let boundary = builder.create_vector(&boundary);
    // A FlatBuffer grows from its end, so vectors of parts are pushed last part first.
    let interior_len = 2 * interior_start[patches.len()] as usize;
    builder.start_vector::<f64>(interior_len);
    for patch in patches.iter().rev() {
        for value in patch.interior.as_flattened().iter().rev() {
            builder.push(*value);
        }
    }
    let interior = builder.end_vector::<f64>(interior_len);
    let quads_len = 4 * quad_start[patches.len()] as usize;
    builder.start_vector::<u32>(quads_len);
    for patch in patches.iter().rev() {
        for value in patch.quads.as_flattened().iter().rev() {
            builder.push(*value);
        }
    }
    let quads = builder.end_vector::<u32>(quads_len);
    let args = chunk_file::ChunkArgs {
        schema: SCHEMA,
        number,
        epsg: place.epsg.unwrap_or(0),
        origin_x_m: place.grid.origin_m[0],
        origin_y_m: place.grid.origin_m[1],
        patch_subdomain: Some(builder.create_vector(&subdomain)),
        patch_method: Some(builder.create_vector(&method)),
        boundary_start: Some(builder.create_vector(&boundary_start)),
        boundary: Some(boundary),
        interior_start: Some(builder.create_vector(&interior_start)),
        interior_xy_m: Some(interior),
        quad_start: Some(builder.create_vector(&quad_start)),
        quads: Some(quads),
        patch_last_resort_quads: Some(builder.create_vector(&last_resort)),
    };
    let root = chunk_file::Chunk::create(&mut builder, &args);
    chunk_file::finish_chunk_buffer(&mut builder, root);
    Ok(Encoded::from(builder))
}
