//! What the pipeline says while it runs, and how long each stage took.

use std::sync::Mutex;
use std::time::Instant;

/// A sign of life. Stages run one after the other; `Advance` comes from any thread.
#[derive(Clone, Debug, PartialEq)]
pub enum Tick {
    /// A stage begins; it has `total` units of work.
    Begin {
        /// Its name.
        stage: &'static str,
        /// Units of work, at least 1.
        total: u64,
    },
    /// So many more units are done.
    Advance {
        /// Units of work.
        by: u64,
    },
    /// The stage is done.
    End {
        /// What it made, for the user.
        note: String,
    },
}

/// Wall time of one stage.
#[derive(Clone, Debug, PartialEq)]
pub struct StageTime {
    /// The stage.
    pub stage: &'static str,
    /// Wall time, seconds.
    pub seconds: f64,
    /// What it made.
    pub note: String,
}

/// Where ticks go.
pub type Listener<'a> = &'a (dyn Fn(Tick) + Sync);

/// Times stages and tells the listener.
pub struct Stopwatch<'a> {
    listener: Listener<'a>,
    stages: Mutex<Vec<StageTime>>,
}

impl<'a> Stopwatch<'a> {
    /// A stopwatch that tells `listener`.
    pub fn new(listener: Listener<'a>) -> Stopwatch<'a> {
        Stopwatch {
            listener,
            stages: Mutex::new(Vec::new()),
        }
    }

    /// Runs one stage; `work` gets a function that counts units done and returns what it made and
    /// a note about it.
    pub fn stage<T, E>(
        &self,
        stage: &'static str,
        total: u64,
        work: impl FnOnce(&(dyn Fn(u64) + Sync)) -> Result<(T, String), E>,
    ) -> Result<T, E> {
        (self.listener)(Tick::Begin {
            stage,
            total: total.max(1),
        });
        let begun = Instant::now();
        let (made, note) = work(&|by| (self.listener)(Tick::Advance { by }))?;
        let seconds = begun.elapsed().as_secs_f64();
        (self.listener)(Tick::End { note: note.clone() });
        let mut stages = self.stages.lock().expect("no stage panics while timing");
        stages.push(StageTime {
            stage,
            seconds,
            note,
        });
        Ok(made)
    }

    /// All stages so far, in order.
    pub fn stages(self) -> Vec<StageTime> {
        self.stages
            .into_inner()
            .expect("no stage panics while timing")
    }
}
