//! Mesh on disk -> [`Verdict`]: every promise, verified from the output alone.
//!
//! # Promises
//! What is verified, a name and a file of code each; a broken one is reported with its places:
//! 1. `files`: all files are there, whole and of this mesh.
//! 2. `counts`: the index's sums are those of the files; each sub-domain has exactly one patch.
//! 3. `walks`: each side of each curve occurs in exactly one walk of the sub-domain on that side;
//!    walks are closed; no edge and no position of a boundary node occurs twice.
//! 4. `even`: each sub-domain has an even number of boundary edges, at least 4.
//! 5. `quads`: every cell has four distinct nodes of its patch, and every node is used.
//! 6. `jacobians`: every cell has four positive corner Jacobians, from the coordinates as stored
//!    and as exported (projected).
//! 7. `conforming`: each edge is used once or twice. Inside a patch, each edge used once is an edge
//!    of its walks and each edge of the walks is used once (both sides of a free line once each);
//!    all others twice, in opposite directions. With 3: no hanging node, no crack, no hole.
//! 8. `areas`: the cells of a patch have the area that its walks enclose, to 1e-9.
//! 9. `outline`: the curves between mesh and outside do not cross each other, enclose the area of
//!    all cells to 1e-9, and lie within the tolerance (of each ring's kind) of the domain's rings both ways. With 6 and 7
//!    it follows that no two cells overlap: the mesh covers each point once, as its outline does.
//! 10. `lines`: the mesh edges of each constraint line form chains in the digitised direction that
//!     follow it from end to end within the tolerance of its kind both ways, dropped stretches
//!     aside.
//! 11. `edges`: no edge of a cell is shorter than the least length of its place (that of its lines;
//!     inside a patch the least of its walks), but for those whose middle is that of a finding.
//! 12. `bounds`: each curve's count lies between its bounds.
//! 13. `certificate`: the cost of the counts is as claimed and not below the bound, which is
//!     computed again from the duals.
//! 14. `patterns`: the same for cost and patterns' price together, from multipliers and duals.
//!
//! # Needs
//! A mesh that [`Mesh::open`] accepts. Nothing else: not the input, not the code that made it.
//!
//! # Method
//! One pass over the chunks, a patch at a time (`cells`, `conforming`, [`quality`]), and one over
//! the frame (`walks`, `outline`, `following`, `parity`). No step trusts a derived number in the
//! files where it can compute it.
//!
//! # Cost
//! Linear but for sorting boundary edges. Memory: 5 bytes a boundary node, 16 a boundary edge, 8 a
//! piece, and the largest patch; not the mesh.
//!
//! # Not here
//! How shapes are shown: `report`. The independent checker outside this project is the other
//! witness.

pub mod patterns;
pub mod quality;
pub mod verdict;

mod cells;
mod conforming;
mod counts;
mod following;
mod outline;
mod parity;
mod rings;
mod seam_rows;
mod segments;
mod shortest;
mod walks;

use crate::check::quality::Quality;
use crate::check::verdict::Promise;
use crate::check::verdict::Verdict;
use crate::chunk::reader::Mesh;
use crate::chunk::views::PatchView;
use crate::geometry::point::Xy;

/// How strict to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// What rounding to the grid may add to the tolerance, metres; 0.002 for a grid of 1 mm.
    pub slack_m: f64,
}

/// For a grid of 1 mm: rounding moves a node by at most 0.71 mm, twice, and a file's decimals add
/// half a millimetre.
pub const OPTIONS: Options = Options { slack_m: 0.002 };

/// Verifies all promises of `mesh`. Never fails: what cannot be read breaks the promise `files`.
pub fn check(mesh: &Mesh, options: &Options) -> Verdict {
    let mut files = Promise::new("files");
    let mut scan = Scan::of(mesh);
    for number in 0..mesh.chunks() {
        match mesh.chunk(number) {
            Ok(chunk) => chunk.view().patches().for_each(|patch| scan.add(&patch)),
            Err(error) => files.broken(None, || error.to_string()),
        }
    }
    files.says(format!("{} files", mesh.index().files.len() + 1));
    let area_m2 = scan.quality.area_m2;
    let Scan {
        cells,
        conforming,
        quality,
        shortest,
        ..
    } = scan;
    let outline = outline::check(mesh, area_m2, files.holds(), options.slack_m);
    let quality = quality.finished();
    let mut promises = vec![files, counts::check(mesh)];
    promises.extend(walks::check(mesh));
    promises.extend(cells.promises());
    promises.extend(conforming.promises());
    promises.push(outline);
    promises.push(following::check(mesh, options.slack_m));
    promises.push(shortest.promise());
    promises.extend(parity::check(mesh));
    promises.push(patterns::check(mesh));
    Verdict { promises, quality }
}

/// The quality alone, for a report: one pass over the chunks. Fails if one cannot be read.
pub fn measure(mesh: &Mesh) -> Result<Quality, crate::chunk::error::Error> {
    let mut scan = Scan::of(mesh);
    for number in 0..mesh.chunks() {
        let chunk = mesh.chunk(number)?;
        for patch in chunk.view().patches() {
            if scan.cells.has_sound_indices(&patch) {
                patch.place_into(mesh.frame().nodes, &mut scan.places);
                scan.quality.add(&patch, &scan.places);
            }
        }
    }
    Ok(scan.quality.finished())
}

/// What goes over the patches.
struct Scan<'a> {
    nodes: &'a [Xy],
    cells: cells::Cells,
    conforming: conforming::Conforming<'a>,
    quality: quality::Measuring<'a>,
    shortest: shortest::Shortest,
    /// Positions of the nodes of the patch at hand, kept for its allocation.
    places: Vec<Xy>,
}

impl<'a> Scan<'a> {
    fn of(mesh: &'a Mesh) -> Scan<'a> {
        let origin_m = mesh.index().grid.origin_m;
        Scan {
            nodes: mesh.frame().nodes,
            cells: cells::Cells::new(origin_m),
            conforming: conforming::Conforming::new(mesh.frame(), origin_m),
            quality: quality::Measuring::new(mesh.frame(), origin_m),
            shortest: shortest::Shortest::new(mesh),
            places: Vec::new(),
        }
    }

    fn add(&mut self, patch: &PatchView) {
        patch.place_into(self.nodes, &mut self.places);
        if !self.cells.add(patch, &self.places) {
            // A cell that names no node of its patch leaves nothing to measure.
            return;
        }
        self.conforming.add(patch, &self.places);
        self.quality.add(patch, &self.places);
        self.shortest.add(patch, &self.places);
    }
}
