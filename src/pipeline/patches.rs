//! Phase C: every sub-domain's walks to a patch, patches to chunk files, in order.

use crate::boundary::walks::walks;
use crate::chunk;
use crate::chunk::record::ChunkReceipt;
use crate::chunk::record::PatchRecord;
use crate::chunk::writer::Writer;
use crate::domain::finding::Finding;
use crate::meshing;
use crate::meshing::patch::Loops;
use crate::partition::subdomains::SubdomainId;
use crate::pipeline::error::Error;
use crate::pipeline::ordered::in_order;
use crate::pipeline::plan::Plan;

/// A patch on its way to the writer.
struct Meshed {
    record: PatchRecord,
    findings: Vec<Finding>,
}

/// What phase C leaves behind.
pub(super) struct Written {
    /// One a chunk.
    pub receipts: Vec<ChunkReceipt>,
    /// What could not be meshed well, and why.
    pub findings: Vec<Finding>,
}

/// Meshes all sub-domains on `workers` threads and writes chunks as they fill.
pub(super) fn mesh_all(
    plan: &Plan,
    writer: &Writer,
    workers: usize,
    count: &(dyn Fn(u64) + Sync),
) -> Result<Written, Error> {
    let mut written = Written {
        receipts: Vec::new(),
        findings: Vec::new(),
    };
    let mut waiting: Vec<PatchRecord> = Vec::new();
    let mut bytes = 0;
    let subdomains = plan.partition.subdomains.len() as u32;
    let flush = |waiting: &mut Vec<PatchRecord>, written: &mut Written| -> Result<(), Error> {
        let number = written.receipts.len() as u32;
        written.receipts.push(writer.write_chunk(number, waiting)?);
        waiting.clear();
        Ok(())
    };
    in_order(
        subdomains,
        workers,
        |subdomain| mesh_one(plan, subdomain),
        |_, meshed: Meshed| -> Result<(), Error> {
            count(meshed.record.quads.len() as u64);
            written.findings.extend(meshed.findings);
            bytes += meshed.record.bytes();
            waiting.push(meshed.record);
            if bytes >= chunk::CHUNK_BYTES {
                bytes = 0;
                flush(&mut waiting, &mut written)?;
            }
            Ok(())
        },
    )?;
    if !waiting.is_empty() {
        flush(&mut waiting, &mut written)?;
    }
    Ok(written)
}

/// Meshes one sub-domain.
fn mesh_one(plan: &Plan, subdomain: SubdomainId) -> Meshed {
    let walked = walks(&plan.site(), subdomain);
    let boundary = walked.ids.iter().map(|&id| id as u32).collect();
    let seams = walked.on_seam.iter().flatten().any(|&it| it);
    let loops = Loops {
        nodes: walked.nodes,
        walks: walked.walks,
        size_m: plan.sizes.default_m,
        lattice_origin: seams.then_some([0.0, 0.0]),
        on_seam: walked.on_seam,
    };
    let options = meshing::Options {
        methods: vec![
            meshing::patch::Method::Strip,
            meshing::patch::Method::Indirect,
        ],
        good_enough: 0.9,
    };
    let meshed = meshing::mesh(&loops, &options).unwrap();
    let findings = Vec::new();
    Meshed {
        record: PatchRecord::new(subdomain, boundary, meshed.patch),
        findings,
    }
}
