//! Records -> files, under a temporary name until all is there.

use crate::chunk::chunk_name;
use crate::chunk::encode;
use crate::chunk::error::Error;
use crate::chunk::frame::Frame;
use crate::chunk::linework::LineWork;
use crate::chunk::open;
use crate::chunk::record::ChunkReceipt;
use crate::chunk::record::NO_BOX;
use crate::chunk::record::PatchEntry;
use crate::chunk::record::PatchRecord;
use crate::chunk::record::widened;
use crate::chunk::store;
use crate::chunk::views::ChunkView;
use crate::chunk::views::FrameView;
use crate::geometry::grid::Grid;
use std::fs;
use std::path::Path;
use std::path::PathBuf;

/// What to do with an output that is already there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// Refuse to start.
    Refuse,
    /// Replace it when the new one is complete.
    Replace,
}

/// Where on earth the mesh lies; said in every file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// EPSG code of the projected reference system, if the input names one.
    pub epsg: Option<u32>,
    /// The grid of the line work; its origin is the local origin of all coordinates.
    pub grid: Grid,
}

/// What the index says beyond what the files do.
#[derive(Clone, Debug, PartialEq)]
pub struct IndexRecord {
    /// Wished edge length where nothing else is said, metres.
    pub size_m: f64,
    /// How far line work may lie from the mesh edges that represent it, metres.
    pub tolerance_m: f64,
    /// The whole job as JSON.
    pub job: String,
    /// Digest of the input file.
    pub input_digest: u64,
}

/// A mesh that is being written. Dropping it leaves the partial directory for a resumed run.
#[derive(Debug)]
pub struct Writer {
    /// Where the mesh will be.
    out: PathBuf,
    /// Where it grows: `out` with `.partial`.
    partial: PathBuf,
    existing: Existing,
    place: Place,
}

impl Writer {
    /// Starts a new mesh; what an earlier, broken run left is removed.
    pub fn create(out: &Path, existing: Existing, place: Place) -> Result<Writer, Error> {
        let writer = Writer::named(out, existing, place)?;
        let partial = &writer.partial;
        if partial.exists() {
            fs::remove_dir_all(partial).map_err(|e| Error::io("remove", partial, e))?;
        }
        fs::create_dir(partial).map_err(|e| Error::io("create", partial, e))?;
        Ok(writer)
    }

    /// Goes on with a mesh that an earlier run began (or begins it), keeping its files.
    pub fn reopen(out: &Path, existing: Existing, place: Place) -> Result<Writer, Error> {
        let writer = Writer::named(out, existing, place)?;
        let partial = &writer.partial;
        if !partial.is_dir() {
            fs::create_dir(partial).map_err(|e| Error::io("create", partial, e))?;
        }
        Ok(writer)
    }

    fn named(out: &Path, existing: Existing, place: Place) -> Result<Writer, Error> {
        if existing == Existing::Refuse && out.symlink_metadata().is_ok() {
            return Err(Error::Exists(out.to_path_buf()));
        }
        Ok(Writer {
            out: out.to_path_buf(),
            partial: partial_of(out),
            existing,
            place,
        })
    }

    /// The directory in which the mesh grows.
    pub fn partial(&self) -> &Path {
        &self.partial
    }

    /// Writes the frame.
    pub fn write_frame(&self, frame: &Frame) -> Result<(), Error> {
        let path = self.partial.join("frame");
        let buffer = encode::frame::frame(frame, &self.place, &path)?;
        store::store(&self.partial, "frame", buffer.bytes()).map(|_| ())
    }

    /// Writes the line work.
    pub fn write_lines(&self, lines: &LineWork) -> Result<(), Error> {
        let path = self.partial.join("lines");
        let buffer = encode::lines::lines(lines, &path)?;
        store::store(&self.partial, "lines", buffer.bytes()).map(|_| ())
    }

    /// Writes chunk `number`. Chunks may come in any order, from one thread or several.
    pub fn write_chunk(&self, number: u32, patches: &[PatchRecord]) -> Result<ChunkReceipt, Error> {
        let name = chunk_name(number);
        let buffer = encode::chunk::chunk(number, patches, &self.place, &self.partial.join(&name))?;
        let stored = store::store(&self.partial, &name, buffer.bytes())?;
        Ok(ChunkReceipt {
            number,
            bytes: stored.bytes,
            crc32: stored.crc32,
            patches: patches.iter().map(entry_of).collect(),
            box_m: (patches.iter()).fold(NO_BOX, |b, patch| widened(b, &patch.interior)),
        })
    }

    /// Shows what was written to `visit`, chunk by chunk, as a reader will see it.
    pub fn review(
        &self,
        chunks: usize,
        mut visit: impl FnMut(&FrameView, &ChunkView),
    ) -> Result<(), Error> {
        let mapped = open::map(&self.partial.join("frame"))?;
        let frame = open::frame(&mapped)?;
        for number in 0..chunks {
            let file = open::map(&self.partial.join(chunk_name(number as u32)))?;
            visit(&frame, &open::chunk(&file)?);
        }
        Ok(())
    }

    /// The receipt of a chunk that an earlier run wrote, after verifying the file.
    pub fn receipt(&self, number: u32) -> Result<ChunkReceipt, Error> {
        let file = open::map(&self.partial.join(chunk_name(number)))?;
        let view = open::chunk(&file)?;
        Ok(receipt_of(&view, number, file.stored()))
    }

    /// Writes the index and gives the mesh its name. `receipts` may come in any order; a gap in
    /// their numbers is [`Error::Missing`].
    pub fn seal(self, mut receipts: Vec<ChunkReceipt>, record: &IndexRecord) -> Result<(), Error> {
        receipts.sort_by_key(|receipt| receipt.number);
        for (number, receipt) in (0..).zip(&receipts) {
            if receipt.number != number {
                return Err(Error::Missing(self.partial.join(chunk_name(number))));
            }
        }
        let mapped = open::map(&self.partial.join("frame"))?;
        let frame = open::frame(&mapped)?;
        let lines = open::map(&self.partial.join("lines"))?;
        self.expect_all_subdomains(&receipts, frame.size_m.len())?;
        let others = [("frame", mapped.stored()), ("lines", lines.stored())];
        let buffer = encode::index::index(&encode::index::IndexParts {
            place: &self.place,
            record,
            receipts: &receipts,
            boundary: frame.nodes,
            others: &others,
        });
        store::store(&self.partial, "index", buffer.bytes())?;
        store::sync_dir(&self.partial)?;
        self.rename()
    }

    /// Each sub-domain must have exactly one patch: shards of different plans do not mix.
    fn expect_all_subdomains(&self, receipts: &[ChunkReceipt], count: usize) -> Result<(), Error> {
        let mut seen = vec![false; count];
        for receipt in receipts {
            for patch in &receipt.patches {
                let first = (seen.get_mut(patch.subdomain as usize))
                    .is_some_and(|it| !std::mem::replace(it, true));
                if !first {
                    let what = format!("sub-domain {} is unknown or twice there", patch.subdomain);
                    let path = self.partial.join(chunk_name(receipt.number));
                    return Err(Error::corrupt(&path, what));
                }
            }
        }
        match seen.iter().position(|&it| !it) {
            None => Ok(()),
            Some(lost) => Err(Error::corrupt(
                &self.partial,
                format!("no chunk has sub-domain {lost}"),
            )),
        }
    }

    fn rename(&self) -> Result<(), Error> {
        let refuse = |doing, e| Error::io(doing, &self.out, e);
        let mut old = self.out.clone().into_os_string();
        old.push(".old");
        let old = PathBuf::from(old);
        // A run that was killed between the two renames left it.
        remove(&old)?;
        let replaced = self.out.symlink_metadata().is_ok();
        if replaced && self.existing == Existing::Refuse {
            return Err(Error::Exists(self.out.clone()));
        }
        if replaced {
            fs::rename(&self.out, &old).map_err(|e| refuse("replace", e))?;
        }
        if let Err(e) = fs::rename(&self.partial, &self.out) {
            if replaced {
                let _ = fs::rename(&old, &self.out);
            }
            return Err(refuse("rename", e));
        }
        remove(&old)?;
        store::sync_dir(self.out.parent().unwrap_or(Path::new(".")))
    }

    /// Removes all that was written.
    pub fn discard(self) -> Result<(), Error> {
        fs::remove_dir_all(&self.partial).map_err(|e| Error::io("remove", &self.partial, e))
    }
}

/// Removes a file or a directory, if it is there.
fn remove(path: &Path) -> Result<(), Error> {
    let gone = match path.symlink_metadata() {
        Ok(it) if it.is_dir() => fs::remove_dir_all(path),
        Ok(_) => fs::remove_file(path),
        Err(_) => Ok(()),
    };
    gone.map_err(|e| Error::io("remove", path, e))
}

/// Where a mesh with the name `out` grows.
pub fn partial_of(out: &Path) -> PathBuf {
    // Without the closing slash: the name, not what is in it.
    let mut name = out.components().as_path().as_os_str().to_os_string();
    name.push(".partial");
    PathBuf::from(name)
}

fn entry_of(patch: &PatchRecord) -> PatchEntry {
    PatchEntry {
        subdomain: patch.subdomain,
        method: patch.method as u8,
        interior: patch.interior.len() as u64,
        quads: patch.quads.len() as u64,
    }
}

fn receipt_of(view: &ChunkView, number: u32, stored: store::Stored) -> ChunkReceipt {
    let entry = |p: usize| PatchEntry {
        subdomain: view.subdomain[p],
        method: view.method[p],
        interior: u64::from(view.interior_start[p + 1] - view.interior_start[p]),
        quads: u64::from(view.quad_start[p + 1] - view.quad_start[p]),
    };
    ChunkReceipt {
        number,
        bytes: stored.bytes,
        crc32: stored.crc32,
        patches: (0..view.subdomain.len()).map(entry).collect(),
        box_m: widened(NO_BOX, view.interior),
    }
}
