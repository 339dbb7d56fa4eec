//! What a run took, beside the mesh: not part of it, so not byte-equal from run to run.

use crate::pipeline::progress::StageTime;
use serde::Deserialize;
use serde::Serialize;
use std::path::Path;

/// Name of the file in the mesh folder.
const NAME: &str = "log.json";

/// The log of one run.
#[derive(Serialize, Deserialize)]
pub(super) struct Log {
    pub stages: Vec<Stage>,
    pub peak_memory_bytes: u64,
}

/// One stage of it.
#[derive(Serialize, Deserialize)]
pub(super) struct Stage {
    pub stage: String,
    pub seconds: f64,
    pub note: String,
}

impl Log {
    /// The log of `stages`.
    pub(super) fn new(stages: &[StageTime], peak_memory_bytes: u64) -> Log {
        let stage = |it: &StageTime| Stage {
            stage: it.stage.into(),
            seconds: it.seconds,
            note: it.note.clone(),
        };
        Log {
            stages: stages.iter().map(stage).collect(),
            peak_memory_bytes,
        }
    }

    /// Writes the log into the mesh folder.
    pub(super) fn write(&self, folder: &Path) -> std::io::Result<()> {
        std::fs::write(folder.join(NAME), serde_json::to_string_pretty(self)?)
    }

    /// The log in the mesh folder, if there is a readable one.
    pub(super) fn read(folder: &Path) -> Option<Log> {
        serde_json::from_slice(&std::fs::read(folder.join(NAME)).ok()?).ok()
    }
}
