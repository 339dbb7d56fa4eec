//! Files -> verified views.

use crate::chunk::SCHEMA;
use crate::chunk::error::Error;
use crate::chunk::generated::chunk as chunk_file;
use crate::chunk::generated::frame as frame_file;
use crate::chunk::generated::index as index_file;
use crate::chunk::generated::lines as lines_file;
use crate::chunk::shape;
use crate::chunk::store::Stored;
use crate::chunk::views::CertificateView;
use crate::chunk::views::ChunkView;
use crate::chunk::views::FrameView;
use crate::chunk::views::IndexView;
use crate::chunk::views::LinesView;
use crate::chunk::views::PatternsView;
use crate::geometry::grid::Grid;
use crate::parity::balance::Solved;
use flatbuffers::Follow;
use flatbuffers::Vector;
use flatbuffers::Verifiable;
use flatbuffers::VerifierOptions;
use memmap2::Mmap;
use std::fs::File;
use std::path::Path;
use std::path::PathBuf;

// Slices are handed out as they lie in the file, and files are little-endian.
#[cfg(target_endian = "big")]
compile_error!("polder maps little-endian files without copying");

/// A mapped file with a correct checksum.
#[derive(Debug)]
pub(crate) struct MappedFile {
    pub path: PathBuf,
    bytes: Mmap,
    crc32: u32,
}

impl MappedFile {
    /// The FlatBuffer, without the closing checksum.
    fn buffer(&self) -> &[u8] {
        &self.bytes[..self.bytes.len() - 4]
    }

    /// Length and checksum.
    pub fn stored(&self) -> Stored {
        Stored {
            bytes: self.bytes.len() as u64,
            crc32: self.crc32,
        }
    }
}

/// Maps `path` and verifies its checksum: one pass over the bytes.
pub(crate) fn map(path: &Path) -> Result<MappedFile, Error> {
    let refuse = |e| Error::io("read", path, e);
    let file = File::open(path).map_err(refuse)?;
    let length = file.metadata().map_err(refuse)?.len();
    // Root offset, identifier, checksum: nothing shorter is one of our files.
    if length < 12 {
        return Err(Error::corrupt(path, format!("it has only {length} bytes")));
    }
    // SAFETY: the files of a mesh are never changed in place, they are renamed when complete. Who
    // truncates one under a running polder gets SIGBUS, as with every mapping.
    let bytes = unsafe { Mmap::map(&file) }.map_err(refuse)?;
    let (buffer, closing) = bytes.split_at(bytes.len() - 4);
    let said = u32::from_le_bytes([closing[0], closing[1], closing[2], closing[3]]);
    let crc32 = crc32fast::hash(buffer);
    if said != crc32 {
        return Err(Error::corrupt(path, "its checksum does not match"));
    }
    Ok(MappedFile {
        path: path.to_path_buf(),
        bytes,
        crc32,
    })
}

/// The root table of `file`, with all offsets inside the file.
fn root<'a, T>(file: &'a MappedFile, identifier: &str) -> Result<T::Inner, Error>
where
    T: Follow<'a> + Verifiable + 'a,
{
    let buffer = file.buffer();
    if !flatbuffers::buffer_has_identifier(buffer, identifier, false) {
        return Err(Error::corrupt(
            &file.path,
            format!("it is no {identifier} file"),
        ));
    }
    let options = VerifierOptions {
        // Each finding is a table; the file's length bounds them.
        max_tables: buffer.len(),
        max_apparent_size: 1 << 31,
        ..VerifierOptions::default()
    };
    flatbuffers::root_with_opts::<T>(&options, buffer)
        .map_err(|e| Error::corrupt(&file.path, e.to_string()))
}

fn expect_schema(file: &MappedFile, found: u32) -> Result<(), Error> {
    if found == SCHEMA {
        return Ok(());
    }
    Err(Error::Version {
        path: file.path.clone(),
        found,
        expected: SCHEMA,
    })
}

/// Numbers whose every bit pattern is a value.
trait Scalar: Copy {}
impl Scalar for u8 {}
impl Scalar for u16 {}
impl Scalar for u32 {}
impl Scalar for u64 {}
impl Scalar for i32 {}
impl Scalar for i64 {}
impl Scalar for f64 {}

/// The vector as a slice into the mapping.
fn slice<'a, T: Scalar>(vector: Vector<'a, T>) -> &'a [T] {
    // SAFETY: any bits are a valid T (Scalar), and `align_to` keeps to the alignment.
    let (before, values, after) = unsafe { vector.bytes().align_to::<T>() };
    // The verifier refuses vectors that are not aligned.
    assert!(before.is_empty() && after.is_empty());
    values
}

/// Rows of `N` numbers; a rest that fills no row is left to `shape` to find.
fn rows<const N: usize, T: Scalar>(vector: Vector<'_, T>) -> &[[T; N]] {
    slice(vector).as_chunks::<N>().0
}

/// The verified view of an index.
pub(crate) fn index(file: &MappedFile) -> Result<IndexView<'_>, Error> {
    let table = root::<index_file::Index>(file, index_file::INDEX_IDENTIFIER)?;
    expect_schema(file, table.schema())?;
    if table.box_m().len() != 4 {
        return Err(Error::corrupt(&file.path, "the box has not four numbers"));
    }
    let view = index_view(&table);
    shape::index(&view).map_err(|what| Error::corrupt(&file.path, what))?;
    Ok(view)
}

/// The view of an index that `index` has verified before.
pub(crate) fn index_again(file: &MappedFile) -> IndexView<'_> {
    // SAFETY: the same bytes passed the verifier.
    index_view(&unsafe { flatbuffers::root_unchecked::<index_file::Index>(file.buffer()) })
}

fn index_view<'a>(table: &index_file::Index<'a>) -> IndexView<'a> {
    IndexView {
        polder: table.polder(),
        epsg: (table.epsg() != 0).then(|| table.epsg()),
        grid: Grid {
            origin_m: [table.origin_x_m(), table.origin_y_m()],
            cell_m: table.cell_m(),
        },
        size_m: table.size_m(),
        tolerance_m: table.tolerance_m(),
        job: table.job(),
        input_digest: table.input_digest(),
        boundary_nodes: table.boundary_nodes(),
        nodes: table.nodes(),
        quads: table.quads(),
        box_m: std::array::from_fn(|k| table.box_m().get(k)),
        chunk_start: slice(table.chunk_start()),
        patch_subdomain: slice(table.patch_subdomain()),
        patch_method: slice(table.patch_method()),
        patch_node_base: slice(table.patch_node_base()),
        patch_quad_base: slice(table.patch_quad_base()),
        files: (table.files().iter())
            .map(|it| (it.name(), it.bytes(), it.crc32()))
            .collect(),
    }
}

/// The verified view of a frame.
pub(crate) fn frame(file: &MappedFile) -> Result<FrameView<'_>, Error> {
    let table = root::<frame_file::Frame>(file, frame_file::FRAME_IDENTIFIER)?;
    expect_schema(file, table.schema())?;
    let view = frame_view(&table);
    shape::frame(&view).map_err(|what| Error::corrupt(&file.path, what))?;
    Ok(view)
}

/// The view of a frame that `frame` has verified before.
pub(crate) fn frame_again(file: &MappedFile) -> FrameView<'_> {
    // SAFETY: the same bytes passed the verifier.
    frame_view(&unsafe { flatbuffers::root_unchecked::<frame_file::Frame>(file.buffer()) })
}

fn frame_view<'a>(table: &frame_file::Frame<'a>) -> FrameView<'a> {
    FrameView {
        nodes: rows(table.node_xy_m()),
        fixed_nodes: table.fixed_nodes(),
        curve_start: slice(table.curve_start()),
        curve_nodes: slice(table.curve_nodes()),
        left: slice(table.curve_left()),
        right: slice(table.curve_right()),
        flags: slice(table.curve_flags()),
        piece_start: slice(table.piece_start()),
        piece_line: slice(table.piece_line()),
        piece_from_m: slice(table.piece_from_m()),
        piece_to_m: slice(table.piece_to_m()),
        subdomain_start: slice(table.subdomain_start()),
        walk_start: slice(table.walk_start()),
        walk_halves: slice(table.walk_halves()),
        size_m: slice(table.subdomain_size_m()),
        goal: slice(table.goal()),
        lower: slice(table.lower()),
        upper: slice(table.upper()),
        weight: slice(table.weight()),
        certificate: table.certificate().map(|it| CertificateView {
            cost_unit: it.cost_unit(),
            objective: it.objective(),
            base: it.base(),
            bound: it.bound(),
            solved: solved(it.solved(), it.claimed()),
            set_parent: slice(it.set_parent()),
            set_dual2: slice(it.set_dual2()),
            set_of: slice(it.set_of()),
        }),
        patterns: table.patterns().map(|it| PatternsView {
            worth: it.worth(),
            price: it.price(),
            bound: it.bound(),
            solved: solved(it.solved(), it.claimed()),
            rounds: it.rounds(),
            improved: it.improved(),
            block_subdomain: slice(it.block_subdomain()),
            block_start: slice(it.block_start()),
            side_start: slice(it.side_start()),
            side_curves: slice(it.side_curves()),
            multiplier: slice(it.multiplier()),
            set_parent: slice(it.set_parent()),
            set_dual2: slice(it.set_dual2()),
            set_of: slice(it.set_of()),
        }),
    }
}

fn solved(given: Option<&frame_file::Solved>, claimed: f64) -> Solved {
    let number = |of: fn(&frame_file::Solved) -> u32| given.map_or(0, of);
    Solved {
        parts: number(frame_file::Solved::parts),
        left: number(frame_file::Solved::left),
        rows: number(frame_file::Solved::rows),
        columns: number(frame_file::Solved::columns),
        added: number(frame_file::Solved::added),
        branched: number(frame_file::Solved::branched),
        claimed: (!claimed.is_nan()).then_some(claimed),
    }
}

/// The verified view of the line work.
pub(crate) fn lines(file: &MappedFile) -> Result<LinesView<'_>, Error> {
    let table = root::<lines_file::Lines>(file, lines_file::LINES_IDENTIFIER)?;
    expect_schema(file, table.schema())?;
    let view = lines_view(&table);
    shape::lines(&view).map_err(|what| Error::corrupt(&file.path, what))?;
    Ok(view)
}

/// The view of line work that `lines` has verified before.
pub(crate) fn lines_again(file: &MappedFile) -> LinesView<'_> {
    // SAFETY: the same bytes passed the verifier.
    lines_view(&unsafe { flatbuffers::root_unchecked::<lines_file::Lines>(file.buffer()) })
}

fn lines_view<'a>(table: &lines_file::Lines<'a>) -> LinesView<'a> {
    LinesView {
        grid: Grid {
            origin_m: [table.origin_x_m(), table.origin_y_m()],
            cell_m: table.cell_m(),
        },
        source: slice(table.line_source()),
        role: slice(table.line_role()),
        point_start: slice(table.point_start()),
        points: rows(table.points()),
        dropped_line: slice(table.dropped_line()),
        dropped_reason: slice(table.dropped_reason()),
        dropped_from_m: slice(table.dropped_from_m()),
        dropped_to_m: slice(table.dropped_to_m()),
        change_at: rows(table.change_at()),
        change_moved_m: slice(table.change_moved_m()),
        tally_count: slice(table.tally_count()),
        tally_moved_max_m: slice(table.tally_moved_max_m()),
        displacement_max_m: table.displacement_max_m(),
        displacement_p99_m: table.displacement_p99_m(),
        length_m: table.length_m(),
        length_dropped_m: table.length_dropped_m(),
        kinds: table.kinds(),
        kind_tolerance_m: slice(table.kind_tolerance_m()),
        kind_min_edge_m: slice(table.kind_min_edge_m()),
        min_edge_m: table.min_edge_m(),
        displacement_max_over_size: table.displacement_max_over_size(),
        displacement_p99_over_size: table.displacement_p99_over_size(),
        names: table.names(),
        words: table.words(),
        kind_row: slice(table.line_kind()),
        name_row: slice(table.line_name()),
        change_word: slice(table.change_word()),
        tally_word: slice(table.tally_word()),
        findings: table.findings(),
    }
}

/// The verified view of a chunk.
pub(crate) fn chunk(file: &MappedFile) -> Result<ChunkView<'_>, Error> {
    let table = root::<chunk_file::Chunk>(file, chunk_file::CHUNK_IDENTIFIER)?;
    expect_schema(file, table.schema())?;
    let view = chunk_view(&table);
    shape::chunk(&view).map_err(|what| Error::corrupt(&file.path, what))?;
    Ok(view)
}

/// The view of a chunk that `chunk` has verified before.
pub(crate) fn chunk_again(file: &MappedFile) -> ChunkView<'_> {
    // SAFETY: the same bytes passed the verifier.
    chunk_view(&unsafe { flatbuffers::root_unchecked::<chunk_file::Chunk>(file.buffer()) })
}

fn chunk_view<'a>(table: &chunk_file::Chunk<'a>) -> ChunkView<'a> {
    ChunkView {
        number: table.number(),
        subdomain: slice(table.patch_subdomain()),
        method: slice(table.patch_method()),
        boundary_start: slice(table.boundary_start()),
        boundary: slice(table.boundary()),
        interior_start: slice(table.interior_start()),
        interior: rows(table.interior_xy_m()),
        quad_start: slice(table.quad_start()),
        quads: rows(table.quads()),
        last_resort_quads: slice(table.patch_last_resort_quads()),
    }
}
