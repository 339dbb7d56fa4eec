//! Job -> Outcome: the phases, the threads, the queues, the progress. The one home of concurrency.
//!
//! ```text
//! A  per tile, in parallel     ingest, noding                        (tiles)
//! B  the whole city            cleanup, partition, seams, intervals, parity   (plan), settling (settle)
//! C  per sub-domain, streamed  boundary, meshing, chunk              (patches, ordered)
//! ```
//!
//! # Promises
//! 1. Same input and same binary, same bytes of chunks and index, for any number of threads and any
//!    tile size: tiles are stitched in a fixed order, patches are written in the order of their
//!    sub-domains, and what fills a chunk is counted in bytes, not in time.
//! 2. Memory follows the input and [`ordered::IN_FLIGHT_PER_WORKER`] patches a thread, never the
//!    number of quads.
//! 3. A run that fails leaves no output, or the old one; from the end of phase B on it can be
//!    resumed, after a kill too, and then gives the same bytes.
//!
//! # Not here
//! Algorithms: every stage is a plain function that knows no thread.

mod counts;
pub mod error;
mod frame;
pub mod job;
mod log;
pub mod ordered;
pub mod outcome;
mod patches;
pub mod plan;
mod previous;
pub mod progress;
pub mod refusal;
mod report;
mod settle;
mod shortest;
mod tiles;

pub use report::report;

use crate::check;
use crate::chunk;
use crate::chunk::linework::Limits;
use crate::chunk::linework::LineWork;
use crate::chunk::reader::Mesh;
use crate::chunk::record::ChunkReceipt;
use crate::chunk::writer::Existing;
use crate::chunk::writer::IndexRecord;
use crate::chunk::writer::Place;
use crate::chunk::writer::Writer;
use crate::domain::finding::Finding;
use crate::pipeline::error::Error;
use crate::pipeline::job::Job;
use crate::pipeline::log::Log;
use crate::pipeline::outcome::Estimate;
use crate::pipeline::outcome::Outcome;
use crate::pipeline::plan::Plan;
use crate::pipeline::progress::Listener;
use crate::pipeline::progress::Stopwatch;
use crate::pipeline::shortest::Shortest;
use crate::spill;
use std::fs;
use std::path::Path;

/// Line work in, mesh out, every promise checked.
pub fn build(job: &Job, listener: Listener) -> Result<Outcome, Error> {
    preflight(job)?;
    let made = pool(job).install(|| build_here(job, listener));
    let partial = chunk::writer::partial_of(&job.output);
    if made.is_err() && !partial.join(spill::NAME).exists() {
        // Nothing to resume. What stopped us is worth more to the user than a second failure here.
        let _ = fs::remove_dir_all(partial);
    }
    made
}

/// What a build will cost, from its plan: all but settling and meshing is done to know it.
pub fn estimate(job: &Job, listener: Listener) -> Result<Estimate, Error> {
    pool(job).install(|| {
        let watch = Stopwatch::new(listener);
        let plan = plan::plan(job, &watch, None)?;
        Ok(Estimate::new(
            job,
            &plan,
            watch.stages(),
            rayon::current_num_threads(),
        ))
    })
}

fn build_here(job: &Job, listener: Listener) -> Result<Outcome, Error> {
    let watch = Stopwatch::new(listener);
    let partial = chunk::writer::partial_of(&job.output);
    let mut plan = plan::plan(job, &watch, job.resume.then_some(partial.as_path()))?;
    settle::settle(job, &mut plan, &watch)?;
    plan.look_across();
    let writer = begin(job, &plan, &partial)?;
    watch.stage("frame", 1, |_| -> Result<_, Error> {
        let frame = frame::frame(&plan);
        writer.write_frame(&frame)?;
        Ok(((), format!("{} nodes on lines", frame.nodes.len())))
    })?;
    let workers = rayon::current_num_threads();
    let receipts = watch.stage("meshing", plan.quads_expected(), |count| {
        let receipts = patches::mesh_all(&plan, &writer, workers, count)?;
        let patches = receipts.iter().flat_map(|it| &it.patches);
        let quads: u64 = patches.map(|it| it.quads).sum();
        Ok::<_, Error>((receipts, format!("{quads} quads")))
    })?;
    let findings = finish(job, &plan, &partial, writer, receipts)?;
    // the check maps the files that were made of it
    plan.shed();
    let verdict = watch.stage("check", 1, |_| -> Result<_, Error> {
        let verdict = check::check(&Mesh::open(&job.output)?, &check::OPTIONS);
        let note = match verdict.holds() {
            true => "every promise holds",
            false => "A PROMISE IS BROKEN",
        };
        Ok((verdict, note.to_string()))
    })?;
    let outcome = Outcome::new(job, &plan, &findings, verdict, watch.stages());
    let log = Log::new(&outcome.stages, outcome.peak_memory_bytes);
    (log.write(&job.output)).map_err(|it| Error::Write(job.output.clone(), it))?;
    Ok(outcome)
}

/// Opens the growing mesh folder, with what an earlier run left there if this one resumes it.
fn begin(job: &Job, plan: &Plan, partial: &Path) -> Result<Writer, Error> {
    let place = Place {
        epsg: plan.domain.epsg,
        grid: plan.domain.grid,
    };
    let existing = match job.force {
        true => Existing::Replace,
        false => Existing::Refuse,
    };
    let key = plan::key(job, &plan.domain);
    if job.resume && spill::fetch(partial, &key).is_some() {
        return Ok(Writer::reopen(&job.output, existing, place)?);
    }
    let writer = Writer::create(&job.output, existing, place)?;
    let refused = |it| Error::Write(partial.to_path_buf(), it);
    spill::park(partial, &key, &plan.city).map_err(refused)?;
    Ok(writer)
}

/// Writes what comes last and gives the mesh its name. Returns all findings.
fn finish(
    job: &Job,
    plan: &Plan,
    partial: &Path,
    writer: Writer,
    receipts: Vec<ChunkReceipt>,
) -> Result<Vec<Finding>, Error> {
    let limits = limits(plan);
    let mut findings = plan.city.findings.clone();
    let mut shortest: Option<Shortest> = None;
    writer.review(receipts.len(), |frame, chunk| {
        let listing = shortest.get_or_insert_with(|| {
            Shortest::on_lines(&plan.domain, &limits, &plan.city.findings, frame)
        });
        for patch in chunk.patches() {
            listing.add(frame, &patch);
        }
    })?;
    findings.extend(shortest.map_or(Vec::new(), |it| it.findings));
    writer.write_lines(&LineWork {
        domain: &plan.domain,
        limits: &limits,
        dropped: &plan.city.dropped,
        changes: &plan.city.changes,
        tally: &plan.city.tally,
        findings: &findings,
    })?;
    spill::remove(partial).map_err(|it| Error::Write(partial.to_path_buf(), it))?;
    let record = IndexRecord {
        size_m: job.size_m,
        tolerance_m: job.tolerance_in_force_m(),
        job: job.echo(),
        input_digest: plan.domain.digest,
    };
    writer.seal(receipts, &record)?;
    Ok(findings)
}

/// What the mesh promises, by kind of line.
fn limits(plan: &Plan) -> Limits {
    let (cleaning, sizes) = (&plan.cleaning, &plan.sizes);
    let kinds = 0..plan.domain.kinds.len();
    Limits {
        tolerance_by_kind_m: (kinds.clone())
            .map(|it| cleaning.tolerance_m(sizes, it))
            .collect(),
        min_edge_by_kind_m: kinds.map(|it| cleaning.min_edge_m(sizes, it)).collect(),
        min_edge_m: cleaning.min_edge * sizes.default_m,
    }
}

/// Refuses at once what would only fail after the work: an output that exists or cannot be made.
fn preflight(job: &Job) -> Result<(), Error> {
    let exists = job.output.symlink_metadata().is_ok();
    if exists && !job.force {
        return Err(chunk::error::Error::Exists(job.output.clone()).into());
    }
    let partial = chunk::writer::partial_of(&job.output);
    if let Err(refusal) = fs::create_dir_all(&partial) {
        return Err(Error::Write(partial, refusal));
    }
    Ok(())
}

fn pool(job: &Job) -> rayon::ThreadPool {
    (rayon::ThreadPoolBuilder::new()
        .num_threads(job.threads)
        .build())
    .expect("the system gives a few threads")
}
