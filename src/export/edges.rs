//! The edges of the mesh, each once: those of the curves, then those inside patches.

use crate::chunk::error::Error as MeshError;
use crate::chunk::reader::Mesh;
use crate::chunk::views::FrameView;
use crate::chunk::views::LinesView;
use crate::chunk::views::PatchView;
use crate::export::error::Error;
use crate::partition::subdomains::OUTSIDE;

/// The edges of the mesh, each once.
pub(crate) struct Edges<'a> {
    frame: FrameView<'a>,
    lines: LinesView<'a>,
    /// Number of edges, if the mesh is sound: each side of a cell that is not on a walk is shared.
    pub total: u64,
    written: u64,
    /// Edges of all curves as pairs of global ids, lesser first, sorted.
    on_curves: Vec<[u32; 2]>,
    bytes: Vec<u8>,
}

impl<'a> Edges<'a> {
    pub fn of(mesh: &'a Mesh) -> Edges<'a> {
        let frame = mesh.frame();
        let mut on_curves = Vec::with_capacity(frame.edges());
        let mut walked = 0;
        for curve in 0..frame.curves() {
            let sides = [frame.left[curve], frame.right[curve]];
            let inner_sides = sides.iter().filter(|&&side| side != OUTSIDE).count();
            walked += u64::from(frame.count(curve)) * inner_sides as u64;
            let pairs = frame.nodes_of(curve).windows(2);
            on_curves.extend(pairs.map(|w| [w[0].min(w[1]), w[0].max(w[1])]));
        }
        on_curves.sort_unstable();
        Edges {
            frame,
            lines: mesh.lines(),
            total: frame.edges() as u64 + (4 * mesh.index().quads).saturating_sub(walked) / 2,
            written: 0,
            on_curves,
            bytes: Vec::new(),
        }
    }

    /// Ends and input features of the edges of all curves.
    pub fn of_curves(&mut self) -> (Vec<u8>, Vec<u8>) {
        let (frame, lines) = (self.frame, self.lines);
        let (mut ends, mut sources) = (Vec::new(), Vec::new());
        for curve in 0..frame.curves() {
            for (edge, pair) in frame.edges_of(curve).zip(frame.nodes_of(curve).windows(2)) {
                for &node in pair {
                    ends.extend_from_slice(&(node as i32 + 1).to_be_bytes());
                }
                let constraint = (frame.pieces_of(edge))
                    .map(|piece| frame.piece_line[piece] as usize)
                    .find(|&line| lines.role[line] == 0);
                let source = constraint.map_or(-1, |line| lines.source[line] as i32);
                sources.extend_from_slice(&source.to_be_bytes());
                self.written += 1;
            }
        }
        (ends, sources)
    }

    /// Ends of the edges inside `patch`, as bytes of the file.
    pub fn inside(&mut self, patch: &PatchView, base: u64) -> &[u8] {
        self.bytes.clear();
        for quad in patch.quads {
            for k in 0..4 {
                let (a, b) = (quad[k], quad[(k + 1) % 4]);
                // The cell beyond has the same edge the other way round: one of the two writes it.
                if a > b || self.is_on_curve(patch, a, b) {
                    continue;
                }
                for node in [a, b] {
                    let id = patch.global(node, base) as i32 + 1;
                    self.bytes.extend_from_slice(&id.to_be_bytes());
                }
                self.written += 1;
            }
        }
        &self.bytes
    }

    fn is_on_curve(&self, patch: &PatchView, a: u32, b: u32) -> bool {
        let boundary = |node: u32| patch.boundary.get(node as usize).copied();
        match (boundary(a), boundary(b)) {
            (Some(a), Some(b)) => self.on_curves.binary_search(&[a.min(b), a.max(b)]).is_ok(),
            _ => false,
        }
    }

    /// The header was written before the edges were counted; a mesh that `check` passes fits it.
    pub fn expect_all(&self, mesh: &Mesh) -> Result<(), Error> {
        if self.written == self.total {
            return Ok(());
        }
        Err(Error::Mesh(MeshError::Corrupt {
            path: mesh.dir().to_path_buf(),
            what: "its cells do not conform, see polder check".into(),
        }))
    }
}
