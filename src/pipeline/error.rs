//! Why a run ended early, and which exit code that is.

use crate::chunk;
use crate::export;
use crate::ingest;
use crate::partition;
use std::fmt;

/// A run that ended early.
#[derive(Debug)]
pub enum Error {
    /// The input cannot be used.
    Ingest(ingest::error::Error),
    /// The job asks for something that this input cannot give.
    Job(String),
    /// The line work encloses nothing, or its rim is torn.
    Partition(partition::error::Error),
    /// No counts make every sub-domain even.
    Parity(String),
    /// The output cannot be written or read.
    Chunk(chunk::error::Error),
    /// An export cannot be written.
    Export(export::error::Error),
    /// A file beside the output cannot be written.
    Write(std::path::PathBuf, std::io::Error),
}

impl Error {
    /// The process's exit code: 2 bad input or usage, 3 the world refused, 1 a broken mesh.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Ingest(it) => 2 + u8::from(it.is_world()),
            Error::Job(_) | Error::Partition(_) | Error::Parity(_) => 2,
            Error::Chunk(chunk::error::Error::Exists(_)) => 2,
            Error::Chunk(it) if it.is_broken_mesh() => 1,
            Error::Chunk(_) => 3,
            Error::Export(export::error::Error::Mesh(it)) if it.is_broken_mesh() => 1,
            Error::Export(export::error::Error::TooLarge { .. }) => 2,
            Error::Export(_) | Error::Write(..) => 3,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Ingest(it) => it.fmt(to),
            Error::Job(it) | Error::Parity(it) => it.fmt(to),
            Error::Partition(it) => it.fmt(to),
            Error::Chunk(it) => it.fmt(to),
            Error::Export(it) => it.fmt(to),
            Error::Write(path, it) => {
                let path = path.display();
                write!(
                    to,
                    "{path}: cannot be written: {it}; free space or choose another place"
                )
            }
        }
    }
}

impl std::error::Error for Error {}

impl From<ingest::error::Error> for Error {
    fn from(it: ingest::error::Error) -> Error {
        Error::Ingest(it)
    }
}

impl From<partition::error::Error> for Error {
    fn from(it: partition::error::Error) -> Error {
        Error::Partition(it)
    }
}

impl From<chunk::error::Error> for Error {
    fn from(it: chunk::error::Error) -> Error {
        Error::Chunk(it)
    }
}

impl From<export::error::Error> for Error {
    fn from(it: export::error::Error) -> Error {
        Error::Export(it)
    }
}
