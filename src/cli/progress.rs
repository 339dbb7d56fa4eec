//! Progress on standard error: a bar on a terminal, throttled plain lines elsewhere.

use crate::pipeline::progress::Tick;
use indicatif::ProgressBar;
use indicatif::ProgressStyle;
use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::Duration;
use std::time::Instant;

/// Least time between two plain lines of one stage.
const PLAIN_EVERY: Duration = Duration::from_secs(10);

/// What the user sees while a stage runs.
struct Shown {
    stage: &'static str,
    bar: Option<ProgressBar>,
    total: u64,
    done: u64,
    begun: Instant,
    last_line: Instant,
}

/// Shows ticks in one of three ways; silent with `--quiet`.
pub struct Progress {
    quiet: bool,
    terminal: bool,
    shown: Mutex<Option<Shown>>,
}

impl Progress {
    /// A progress display that fits where standard error goes.
    pub fn new(quiet: bool) -> Progress {
        Progress {
            quiet,
            terminal: std::io::stderr().is_terminal(),
            shown: Mutex::new(None),
        }
    }

    /// Takes one tick from the pipeline; called from any thread.
    pub fn tick(&self, tick: Tick) {
        if self.quiet {
            return;
        }
        let mut shown = self.shown.lock().expect("no tick panics");
        match tick {
            Tick::Begin { stage, total } => *shown = Some(self.begin(stage, total)),
            Tick::Advance { by } => {
                if let Some(shown) = shown.as_mut() {
                    advance(shown, by);
                }
            }
            Tick::End { note } => {
                if let Some(shown) = shown.take() {
                    if let Some(bar) = &shown.bar {
                        bar.finish_and_clear();
                    }
                    let seconds = shown.begun.elapsed().as_secs_f64();
                    eprintln!("{:<10} {seconds:8.2} s   {note}", shown.stage);
                }
            }
        }
    }

    fn begin(&self, stage: &'static str, total: u64) -> Shown {
        let bar = self.terminal.then(|| {
            let style = "{prefix:<10} {bar:40} {percent:>3} %  {elapsed} of about {duration}";
            let bar = ProgressBar::new(total.max(1));
            bar.set_style(ProgressStyle::with_template(style).expect("the template is valid"));
            bar.set_prefix(stage);
            bar
        });
        let now = Instant::now();
        Shown {
            stage,
            bar,
            total,
            done: 0,
            begun: now,
            last_line: now,
        }
    }
}

fn advance(shown: &mut Shown, by: u64) {
    shown.done += by;
    match &shown.bar {
        Some(bar) => bar.set_position(shown.done.min(shown.total)),
        None if shown.last_line.elapsed() >= PLAIN_EVERY => {
            shown.last_line = Instant::now();
            let percent = 100 * shown.done / shown.total.max(1);
            eprintln!("{:<10} {percent:3} %", shown.stage);
        }
        None => {}
    }
}
