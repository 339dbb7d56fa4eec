//! The bytes of a file: unpacked, and digested as stored.

use crate::ingest::error::Error;
use flate2::bufread::MultiGzDecoder;
use std::cell::Cell;
use std::fs::File;
use std::io::BufRead;
use std::io::BufReader;
use std::io::Read;
use std::path::Path;
use std::rc::Rc;

/// An open file.
pub struct Opened {
    /// Its content, unpacked if it is gzip.
    pub bytes: Box<dyn Read>,
    /// FNV-1a of all stored bytes read so far.
    pub digest: Rc<Cell<u64>>,
}

/// Opens `path`; the first two bytes, not the name, tell whether it is packed.
pub fn open(path: &Path) -> Result<Opened, Error> {
    let failed = |source| Error::Io {
        file: path.to_path_buf(),
        source,
    };
    // the offset basis and prime of the 64-bit FNV-1a hash
    let digest = Rc::new(Cell::new(0xcbf2_9ce4_8422_2325));
    let stored = Digested {
        file: File::open(path).map_err(failed)?,
        digest: Rc::clone(&digest),
    };
    let mut stored = BufReader::with_capacity(1 << 16, stored);
    let is_gzip = stored
        .fill_buf()
        .map_err(failed)?
        .starts_with(&[0x1f, 0x8b]);
    let bytes: Box<dyn Read> = if is_gzip {
        Box::new(BufReader::with_capacity(
            1 << 16,
            MultiGzDecoder::new(stored),
        ))
    } else {
        Box::new(stored)
    };
    Ok(Opened { bytes, digest })
}

struct Digested {
    file: File,
    digest: Rc<Cell<u64>>,
}

impl Read for Digested {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let count = self.file.read(into)?;
        let mut hash = self.digest.get();
        for &byte in &into[..count] {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
        self.digest.set(hash);
        Ok(count)
    }
}
