//! Words -> Args -> Job; the only module that prints.
//!
//! Results go to standard output, progress and errors to standard error. `--json` puts one JSON
//! object on standard output instead of text.

mod args;
mod city_file;
mod job_file;
mod progress;
mod summary;

use crate::check;
use crate::chunk::reader::Mesh;
use crate::cli::args::BuildArgs;
use crate::cli::args::Command;
use crate::cli::args::FormatWord;
use crate::cli::args::Words;
use crate::cli::progress::Progress;
use crate::export;
use crate::pipeline;
use crate::pipeline::error::Error;
use clap::Parser;
use std::path::Path;

/// Runs the command that the process was started with; returns its exit code.
pub fn run() -> u8 {
    let words = Words::parse();
    match obey(&words) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("polder: {error}");
            error.exit_code()
        }
    }
}

fn obey(words: &Words) -> Result<u8, Error> {
    match &words.command {
        Command::Build(args) => build(words, args),
        Command::Plan(args) => plan(words, args),
        Command::Check { mesh } => verify(words, mesh),
        Command::Report { mesh, out, force } => report(words, mesh, out, *force),
        Command::Export {
            mesh,
            format,
            cleaned,
            out,
            force,
        } => {
            let format = match format {
                FormatWord::Ugrid => export::Format::Ugrid,
                FormatWord::Sms => export::Format::Sms,
                FormatWord::Lines if *cleaned => export::Format::CleanedLines,
                FormatWord::Lines => export::Format::Lines,
                FormatWord::Changes => export::Format::Changes,
            };
            refuse_existing(out, *force)?;
            let written = export::export(&Mesh::open(mesh)?, format, out)?;
            say(words, summary::exported(out, &written));
            Ok(0)
        }
        Command::Info { mesh } => {
            say(words, summary::info(&Mesh::open(mesh)?));
            Ok(0)
        }
        Command::Synth {
            lines,
            seed,
            out,
            force,
        } => {
            refuse_existing(out, *force)?;
            let city = city_file::write(*lines, *seed, out)?;
            say(words, summary::synth(out, &city));
            Ok(0)
        }
    }
}

fn build(words: &Words, args: &BuildArgs) -> Result<u8, Error> {
    let job = job_file::job(args).map_err(Error::Job)?;
    let progress = Progress::new(words.quiet);
    let outcome = pipeline::build(&job, &|tick| progress.tick(tick))?;
    let holds = outcome.verdict.holds();
    say(words, summary::built(&job, &outcome));
    Ok(u8::from(!holds))
}

fn plan(words: &Words, args: &BuildArgs) -> Result<u8, Error> {
    let job = job_file::job(args).map_err(Error::Job)?;
    let progress = Progress::new(words.quiet);
    let cost = pipeline::estimate(&job, &|tick| progress.tick(tick))?;
    say(words, summary::planned(&cost));
    Ok(0)
}

fn verify(words: &Words, mesh: &Path) -> Result<u8, Error> {
    let verdict = check::check(&Mesh::open(mesh)?, &check::OPTIONS);
    let holds = verdict.holds();
    say(words, summary::verdict(&verdict));
    Ok(u8::from(!holds))
}

fn report(words: &Words, mesh: &Path, out: &Path, force: bool) -> Result<u8, Error> {
    let picture = out.with_extension("png");
    refuse_existing(out, force)?;
    refuse_existing(&picture, force)?;
    let holds = pipeline::report(&Mesh::open(mesh)?, out, &picture)?;
    say(words, summary::reported(out, &picture));
    Ok(u8::from(!holds))
}

fn refuse_existing(out: &Path, force: bool) -> Result<(), Error> {
    if !force && out.symlink_metadata().is_ok() {
        let out = out.display();
        return Err(Error::Job(format!(
            "{out} exists: choose another name, or replace it with --force"
        )));
    }
    Ok(())
}

/// Prints a summary in the form that the user asked for.
fn say(words: &Words, summary: summary::Summary) {
    if words.json {
        println!("{}", summary.json);
    } else if !words.quiet || !summary.good {
        println!("{}", summary.text);
    }
}
