//! A finished mesh, mapped.

use crate::chunk::chunk_name;
use crate::chunk::error::Error;
use crate::chunk::open;
use crate::chunk::open::MappedFile;
use crate::chunk::views::ChunkView;
use crate::chunk::views::FrameView;
use crate::chunk::views::IndexView;
use crate::chunk::views::LinesView;
use std::path::Path;
use std::path::PathBuf;

/// A mesh on disk. The index, frame and line work are mapped and verified; chunks are opened one at
/// a time.
#[derive(Debug)]
pub struct Mesh {
    dir: PathBuf,
    index: MappedFile,
    frame: MappedFile,
    lines: MappedFile,
}

/// One chunk, mapped and verified; unmapped when dropped.
#[derive(Debug)]
pub struct Chunk {
    file: MappedFile,
    first_patch: usize,
}

impl Mesh {
    /// Opens the mesh in `dir`. Reads index, frame and line work once, and no chunk.
    pub fn open(dir: &Path) -> Result<Mesh, Error> {
        let mesh = Mesh {
            dir: dir.to_path_buf(),
            index: open::map(&dir.join("index"))?,
            frame: open::map(&dir.join("frame"))?,
            lines: open::map(&dir.join("lines"))?,
        };
        let index = open::index(&mesh.index)?;
        let frame = open::frame(&mesh.frame)?;
        let lines = open::lines(&mesh.lines)?;
        mesh.expect_listed(&index, &mesh.frame, "frame")?;
        mesh.expect_listed(&index, &mesh.lines, "lines")?;
        mesh.expect_same_counts(&index, &frame, &lines)?;
        Ok(mesh)
    }

    /// Files of two meshes do not mix: the index knows each file's checksum.
    fn expect_listed(&self, index: &IndexView, file: &MappedFile, name: &str) -> Result<(), Error> {
        let stored = file.stored();
        let listed = index.files.contains(&(name, stored.bytes, stored.crc32));
        if listed {
            Ok(())
        } else {
            Err(Error::corrupt(&file.path, "the index lists another one"))
        }
    }

    fn expect_same_counts(
        &self,
        index: &IndexView,
        frame: &FrameView,
        lines: &LinesView,
    ) -> Result<(), Error> {
        let subdomains = frame.subdomains();
        if index.boundary_nodes != frame.nodes.len() as u64
            || index
                .patch_subdomain
                .iter()
                .any(|&s| s as usize >= subdomains)
        {
            return Err(Error::corrupt(
                &self.index.path,
                "it does not fit the frame",
            ));
        }
        if frame
            .piece_line
            .iter()
            .any(|&line| line as usize >= lines.lines())
        {
            return Err(Error::corrupt(&self.frame.path, "a piece names no line"));
        }
        Ok(())
    }

    /// Where it is.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Counts, number bases, what the job was.
    pub fn index(&self) -> IndexView<'_> {
        open::index_again(&self.index)
    }

    /// What patches share.
    pub fn frame(&self) -> FrameView<'_> {
        open::frame_again(&self.frame)
    }

    /// The line work as read, and what became of it.
    pub fn lines(&self) -> LinesView<'_> {
        open::lines_again(&self.lines)
    }

    /// Number of chunks.
    pub fn chunks(&self) -> usize {
        self.index().chunks()
    }

    /// Maps and verifies chunk `number`.
    pub fn chunk(&self, number: usize) -> Result<Chunk, Error> {
        let index = self.index();
        let name = chunk_name(number as u32);
        let file = open::map(&self.dir.join(&name))?;
        self.expect_listed(&index, &file, &name)?;
        let view = open::chunk(&file)?;
        let first = index.chunk_start[number] as usize;
        let last = index.chunk_start[number + 1] as usize;
        let same = view.subdomain == &index.patch_subdomain[first..last]
            && view.number as usize == number
            && (view.interior_start.windows(2))
                .zip(index.patch_node_base[first..=last].windows(2))
                .all(|(a, b)| u64::from(a[1] - a[0]) == b[1] - b[0])
            && (view.quad_start.windows(2))
                .zip(index.patch_quad_base[first..=last].windows(2))
                .all(|(a, b)| u64::from(a[1] - a[0]) == b[1] - b[0]);
        if !same {
            return Err(Error::corrupt(&file.path, "the index lists other patches"));
        }
        let boundary = index.boundary_nodes;
        if view.boundary.iter().any(|&id| u64::from(id) >= boundary) {
            return Err(Error::corrupt(
                &file.path,
                "a boundary node is not in the frame",
            ));
        }
        Ok(Chunk {
            file,
            first_patch: first,
        })
    }
}

impl Chunk {
    /// Its patches.
    pub fn view(&self) -> ChunkView<'_> {
        open::chunk_again(&self.file)
    }

    /// Row of its first patch in the index.
    pub fn first_patch(&self) -> usize {
        self.first_patch
    }

    /// Its file.
    pub fn path(&self) -> &Path {
        &self.file.path
    }
}
