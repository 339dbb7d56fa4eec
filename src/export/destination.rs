//! The file to be written: under another name until it is complete.

use crate::export::error::Error;
use std::fs;
use std::fs::File;
use std::io;
use std::io::BufWriter;
use std::io::Seek;
use std::io::SeekFrom;
use std::io::Write;
use std::path::Path;
use std::path::PathBuf;

/// Large enough that the disk sees long runs, small beside a chunk.
const BUFFER_BYTES: usize = 1 << 20;

/// An output in the making; removed when dropped unfinished.
pub(crate) struct Destination {
    path: PathBuf,
    unfinished: PathBuf,
    file: BufWriter<File>,
    is_finished: bool,
}

impl Destination {
    pub fn create(path: &Path) -> Result<Destination, Error> {
        let mut unfinished = path.as_os_str().to_os_string();
        unfinished.push(".partial");
        let unfinished = PathBuf::from(unfinished);
        let file = File::create(&unfinished).map_err(|e| Error::io(path, e))?;
        Ok(Destination {
            path: path.to_path_buf(),
            unfinished,
            file: BufWriter::with_capacity(BUFFER_BYTES, file),
            is_finished: false,
        })
    }

    /// Runs `write` on the file.
    pub fn write(
        &mut self,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<(), Error> {
        write(&mut self.file).map_err(|e| self.refused(e))
    }

    /// A second writer into the same file, from byte `at` on.
    pub fn section(&self, at: u64) -> Result<BufWriter<File>, Error> {
        let open = || {
            let mut file = File::options().write(true).open(&self.unfinished)?;
            file.seek(SeekFrom::Start(at))?;
            Ok(BufWriter::with_capacity(BUFFER_BYTES, file))
        };
        open().map_err(|e| self.refused(e))
    }

    /// The error for a refusal of the file system.
    pub fn refused(&self, source: io::Error) -> Error {
        Error::io(&self.path, source)
    }

    /// Syncs the file and gives it its name. Returns its length, bytes.
    pub fn finish(mut self) -> Result<u64, Error> {
        let mut finish = || {
            self.file.flush()?;
            let file = self.file.get_ref();
            file.sync_all()?;
            let bytes = file.metadata()?.len();
            fs::rename(&self.unfinished, &self.path)?;
            Ok(bytes)
        };
        let bytes = finish().map_err(|e| Error::io(&self.path, e))?;
        self.is_finished = true;
        Ok(bytes)
    }
}

impl Drop for Destination {
    fn drop(&mut self) {
        if !self.is_finished {
            let _ = fs::remove_file(&self.unfinished);
        }
    }
}
