//! One file, all or nothing: temporary name, checksum, sync, rename.

use crate::chunk::error::Error;
use std::fs;
use std::fs::File;
use std::io::Write;
use std::path::Path;

/// Length and checksum of a file that was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Stored {
    /// With the closing four bytes.
    pub bytes: u64,
    pub crc32: u32,
}

/// Writes `buffer` and its CRC-32 as `dir/name`; on any failure nothing is left.
pub(crate) fn store(dir: &Path, name: &str, buffer: &[u8]) -> Result<Stored, Error> {
    let path = dir.join(name);
    let unfinished = dir.join(format!("{name}.tmp"));
    let crc32 = crc32fast::hash(buffer);
    let write = || {
        let mut file = File::create(&unfinished)?;
        file.write_all(buffer)?;
        file.write_all(&crc32.to_le_bytes())?;
        // Rename before the data is on disk could leave an empty file after a power cut.
        file.sync_all()?;
        fs::rename(&unfinished, &path)
    };
    write().map_err(|source| {
        let _ = fs::remove_file(&unfinished);
        Error::io("write", &path, source)
    })?;
    Ok(Stored {
        bytes: buffer.len() as u64 + 4,
        crc32,
    })
}

/// Makes the names within `dir` durable.
pub(crate) fn sync_dir(dir: &Path) -> Result<(), Error> {
    // Directories cannot be opened on every system; where they can, syncing them must work.
    match File::open(dir) {
        Ok(open) => open
            .sync_all()
            .map_err(|source| Error::io("sync", dir, source)),
        Err(_) => Ok(()),
    }
}
