//! How writing or reading a mesh can fail, and what to do then.

use std::fmt;
use std::io;
use std::path::Path;
use std::path::PathBuf;

/// The world refused, or a file is not what it should be.
#[derive(Debug)]
pub enum Error {
    /// The output exists and the caller did not allow to replace it.
    Exists(PathBuf),
    /// A file or directory of the mesh is not there.
    Missing(PathBuf),
    /// The file system refused.
    Io {
        /// What was being done: "write", "read", ...
        doing: &'static str,
        /// To what.
        path: PathBuf,
        /// What it said.
        source: io::Error,
    },
    /// The file is damaged: cut, flipped, or not ours.
    Corrupt {
        /// Which one.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// Written by another version of polder.
    Version {
        /// Which file.
        path: PathBuf,
        /// Its layout.
        found: u32,
        /// The one that this polder reads.
        expected: u32,
    },
    /// A file would pass the 2 GiB that a FlatBuffer can hold.
    TooLarge {
        /// Which file.
        path: PathBuf,
        /// Its size, bytes.
        bytes: u64,
    },
}

impl Error {
    pub(crate) fn io(doing: &'static str, path: &Path, source: io::Error) -> Error {
        let path = path.to_path_buf();
        if source.kind() == io::ErrorKind::NotFound && doing == "read" {
            return Error::Missing(path);
        }
        Error::Io {
            doing,
            path,
            source,
        }
    }

    pub(crate) fn corrupt(path: &Path, what: impl Into<String>) -> Error {
        Error::Corrupt {
            path: path.to_path_buf(),
            what: what.into(),
        }
    }

    /// True if the mesh itself is at fault, not the machine that reads or writes it.
    pub fn is_broken_mesh(&self) -> bool {
        matches!(self, Error::Missing(_) | Error::Corrupt { .. })
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Exists(path) => write!(
                f,
                "{} exists: choose another output, or replace it with --force",
                path.display()
            ),
            Error::Missing(path) => write!(
                f,
                "{} is missing: the mesh is not complete; build it again or copy the whole \
                 directory",
                path.display()
            ),
            Error::Io {
                doing,
                path,
                source,
            } => write!(
                f,
                "cannot {doing} {}: {source}; {}",
                path.display(),
                advice(source)
            ),
            Error::Corrupt { path, what } => write!(
                f,
                "{} is damaged ({what}): build the mesh again or copy the file again",
                path.display()
            ),
            Error::Version {
                path,
                found,
                expected,
            } => write!(
                f,
                "{} has layout {found}, this polder reads layout {expected}: use the polder that \
                 made it, or build it again",
                path.display()
            ),
            Error::TooLarge { path, bytes } => write!(
                f,
                "{} would have {bytes} bytes, a file holds at most 2 GiB: split the domain",
                path.display()
            ),
        }
    }
}

/// What to do about a refusal of the file system.
fn advice(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "free some space or choose another disk; a build can be resumed"
        }
        io::ErrorKind::FileTooLarge => "raise the limit on file sizes (ulimit -f)",
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "choose a directory that you may write to"
        }
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => {
            "make its parent directory first, or correct the path"
        }
        _ => "check the path and the disk",
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Error::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}
