//! How an export can fail.

use crate::chunk::error::Error as MeshError;
use std::fmt;
use std::io;
use std::path::Path;
use std::path::PathBuf;

/// The world refused, or the mesh cannot be had in this format.
#[derive(Debug)]
pub enum Error {
    /// The mesh cannot be read.
    Mesh(MeshError),
    /// The output cannot be written.
    Io {
        /// The output.
        path: PathBuf,
        /// What the file system said.
        source: io::Error,
    },
    /// The format counts in 32 bits.
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How many.
        found: u64,
    },
}

impl Error {
    pub(crate) fn io(path: &Path, source: io::Error) -> Error {
        Error::Io {
            path: path.to_path_buf(),
            source,
        }
    }
}

impl From<MeshError> for Error {
    fn from(error: MeshError) -> Error {
        Error::Mesh(error)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Mesh(error) => error.fmt(f),
            Error::Io { path, source } => write!(
                f,
                "cannot write {}: {source}; choose another place or free some space",
                path.display()
            ),
            Error::TooLarge { what, found } => write!(
                f,
                "{found} {what}: this format counts to {} at most; export parts of the domain",
                i32::MAX
            ),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Error::Mesh(error) => Some(error),
            Error::Io { source, .. } => Some(source),
            Error::TooLarge { .. } => None,
        }
    }
}
