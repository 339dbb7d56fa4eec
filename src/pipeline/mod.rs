//! Job -> Outcome: the phases, the threads, the queues, the progress. The one home of concurrency.
//!
//! ```text
//! A  per tile, in parallel     ingest, noding                        (tiles)
//! B  the whole city            cleanup, partition, seams, intervals, parity   (plan)
//! C  per sub-domain, streamed  boundary, meshing, chunk              (patches, ordered)
//! ```
//!
//! # Promises
//! 1. Same input and same binary, same bytes of chunks and index, for any number of threads and any
//!    tile size: tiles are stitched in a fixed order, patches are written in the order of their
//!    sub-domains, and what fills a chunk is counted in bytes, not in time.
//! 2. Memory follows the input and [`ordered::IN_FLIGHT_PER_WORKER`] patches a thread, never the
//!    number of quads.
//! 3. A run that fails leaves no output, or the old one.
//!
//! # Not here
//! Algorithms: every stage is a plain function that knows no thread.

pub mod error;
mod frame;
pub mod job;
mod log;
pub mod ordered;
pub mod outcome;
mod patches;
pub mod plan;
pub mod progress;
mod report;
mod tiles;

pub use report::report;

use crate::check;
use crate::chunk;
use crate::chunk::linework::LineWork;
use crate::chunk::reader::Mesh;
use crate::chunk::writer::Existing;
use crate::chunk::writer::IndexRecord;
use crate::chunk::writer::Place;
use crate::chunk::writer::Writer;
use crate::pipeline::error::Error;
use crate::pipeline::job::Job;
use crate::pipeline::log::Log;
use crate::pipeline::outcome::Estimate;
use crate::pipeline::outcome::Outcome;
use crate::pipeline::progress::Listener;
use crate::pipeline::progress::Stopwatch;
use std::fs;

/// Line work in, mesh out, every promise checked.
pub fn build(job: &Job, listener: Listener) -> Result<Outcome, Error> {
    preflight(job)?;
    let made = pool(job).install(|| build_here(job, listener));
    if made.is_err() {
        // What stopped us is worth more to the user than a second failure while tidying up.
        let _ = fs::remove_dir_all(chunk::writer::partial_of(&job.output));
    }
    made
}

/// What a build will cost, from its plan: all but the meshing is done to know it.
pub fn estimate(job: &Job, listener: Listener) -> Result<Estimate, Error> {
    pool(job).install(|| {
        let watch = Stopwatch::new(listener);
        let plan = plan::plan(job, &watch)?;
        Ok(Estimate::new(
            &plan,
            watch.stages(),
            rayon::current_num_threads(),
        ))
    })
}

fn build_here(job: &Job, listener: Listener) -> Result<Outcome, Error> {
    let watch = Stopwatch::new(listener);
    let plan = plan::plan(job, &watch)?;
    let place = Place {
        epsg: plan.domain.epsg,
        grid: plan.domain.grid,
    };
    let existing = if job.force {
        Existing::Replace
    } else {
        Existing::Refuse
    };
    let writer = Writer::create(&job.output, existing, place)?;
    watch.stage("frame", 1, |_| -> Result<_, Error> {
        let frame = frame::frame(&plan);
        writer.write_frame(&frame)?;
        Ok(((), format!("{} nodes on lines", frame.nodes.len())))
    })?;
    let workers = rayon::current_num_threads();
    let written = watch.stage(
        "meshing",
        plan.quads_expected(),
        |count| -> Result<_, Error> {
            let written = patches::mesh_all(&plan, &writer, workers, count)?;
            let patches = written.receipts.iter().flat_map(|it| &it.patches);
            let quads: u64 = patches.map(|it| it.quads).sum();
            Ok((written, format!("{quads} quads")))
        },
    )?;
    let mut findings = plan.findings.clone();
    findings.extend(written.findings);
    writer.write_lines(&LineWork {
        domain: &plan.domain,
        dropped: &plan.dropped,
        changes: &plan.changes,
        tally: &plan.tally,
        findings: &findings,
    })?;
    writer.seal(
        written.receipts,
        &IndexRecord {
            size_m: job.size_m,
            tolerance_m: job.tolerance_in_force_m(),
            job: job.echo(),
            input_digest: plan.domain.digest,
        },
    )?;
    let verdict = watch.stage("check", 1, |_| -> Result<_, Error> {
        let verdict = check::check(&Mesh::open(&job.output)?, &check::OPTIONS);
        let note = if verdict.holds() {
            "every promise holds"
        } else {
            "A PROMISE IS BROKEN"
        };
        Ok((verdict, note.to_string()))
    })?;
    let outcome = Outcome::new(job, &plan, &findings, verdict, watch.stages());
    let log = Log::new(&outcome.stages, outcome.peak_memory_bytes);
    (log.write(&job.output)).map_err(|it| Error::Write(job.output.clone(), it))?;
    Ok(outcome)
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
