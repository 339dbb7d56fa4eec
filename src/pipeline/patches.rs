//! Phase C: every sub-domain's walks to a patch, patches to chunk files, in order.

use crate::boundary::walks::walks;
use crate::chunk;
use crate::chunk::record::ChunkReceipt;
use crate::chunk::record::PatchRecord;
use crate::chunk::writer::Writer;
use crate::meshing;
use crate::meshing::patch::Loops;
use crate::partition::subdomains::SubdomainId;
use crate::pipeline::error::Error;
use crate::pipeline::ordered::in_order;
use crate::pipeline::plan::Plan;

/// Meshes all sub-domains on `workers` threads and writes chunks as they fill; goes on after the
/// chunks that an earlier run finished. Returns a receipt a chunk.
///
/// What a chunk holds follows from the sizes of its patches alone, so a resumed run writes the same
/// chunks.
pub(super) fn mesh_all(
    plan: &Plan,
    writer: &Writer,
    workers: usize,
    count: &(dyn Fn(u64) + Sync),
) -> Result<Vec<ChunkReceipt>, Error> {
    let mut receipts = finished_chunks(writer);
    let patches = receipts.iter().flat_map(|it| &it.patches);
    count(patches.clone().map(|it| it.quads).sum());
    let done = patches.count() as u32;
    let mut waiting: Vec<PatchRecord> = Vec::new();
    let mut bytes = 0;
    let left = plan.city.partition.subdomains.len() as u32 - done;
    in_order(
        left,
        workers,
        |n| mesh_one(plan, done + n),
        |_, patch: PatchRecord| -> Result<(), Error> {
            count(patch.quads.len() as u64);
            bytes += patch.bytes();
            waiting.push(patch);
            if bytes >= chunk::CHUNK_BYTES {
                bytes = 0;
                receipts.push(writer.write_chunk(receipts.len() as u32, &waiting)?);
                waiting.clear();
            }
            Ok(())
        },
    )?;
    if !waiting.is_empty() {
        receipts.push(writer.write_chunk(receipts.len() as u32, &waiting)?);
    }
    Ok(receipts)
}

/// Receipts of the whole chunks that are there, up to the first gap.
fn finished_chunks(writer: &Writer) -> Vec<ChunkReceipt> {
    (0..)
        .map_while(|number| writer.receipt(number).ok())
        .collect()
}

/// Meshes one sub-domain.
fn mesh_one(plan: &Plan, subdomain: SubdomainId) -> PatchRecord {
    let walked = walks(&plan.site(), subdomain);
    let boundary = walked.ids.iter().map(|&id| id as u32).collect();
    let loops = Loops::of(&walked, plan.sizes.default_m);
    match meshing::mesh(&loops, &meshing::Options::all()) {
        Ok(meshed) => PatchRecord::new(subdomain, boundary, meshed.patch),
        // `partition` and `boundary` promise planar, even walks: this is our mistake, not the user's.
        Err(defect) => {
            let at = plan.domain.grid.origin_m;
            let place = [0, 1].map(|k| defect.at_m[k] + at[k]);
            panic!("sub-domain {subdomain} near {place:?}: {}", defect.what)
        }
    }
}
