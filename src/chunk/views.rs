//! What is in the files, as plain slices into the mapped bytes. Nothing is copied.
//!
//! The fields are those of `schemas/*.fbs`, with the same names where that reads well. A view only
//! exists for a file that was verified: all offsets rise and end where they should, all vectors have
//! the length that they must, and all indices are in range.

use crate::geometry::grid::Grid;
use crate::geometry::point::Point;
use crate::geometry::point::Xy;
use crate::parity::balance::Solved;
use crate::partition::subdomains::HalfCurve;
use std::ops::Range;

pub(crate) type Strings<'a> = flatbuffers::Vector<'a, flatbuffers::ForwardsUOffset<&'a str>>;

fn range(starts: &[u32], row: usize) -> Range<usize> {
    starts[row] as usize..starts[row + 1] as usize
}

/// The index: counts, number bases, what the job was.
#[derive(Clone, Debug)]
pub struct IndexView<'a> {
    /// Version of the polder that wrote the mesh.
    pub polder: &'a str,
    /// EPSG code of the projected reference system.
    pub epsg: Option<u32>,
    /// The grid of the line work; its origin is that of all local coordinates.
    pub grid: Grid,
    /// Wished edge length where nothing else is said, metres.
    pub size_m: f64,
    /// How far line work may lie from the mesh edges that represent it, metres.
    pub tolerance_m: f64,
    /// The whole job as JSON.
    pub job: &'a str,
    /// Digest of the input file.
    pub input_digest: u64,
    /// Number of boundary nodes.
    pub boundary_nodes: u64,
    /// Number of all nodes.
    pub nodes: u64,
    /// Number of all quads.
    pub quads: u64,
    /// Box around all nodes, local metres: min x, min y, max x, max y.
    pub box_m: [f64; 4],
    /// Chunk -> its patches, CSR.
    pub chunk_start: &'a [u32],
    /// Patch -> sub-domain.
    pub patch_subdomain: &'a [u32],
    /// Patch -> method, as in `Method`.
    pub patch_method: &'a [u8],
    /// Patch -> global id of its first interior node; one longer.
    pub patch_node_base: &'a [u64],
    /// Patch -> number of quads before it; one longer.
    pub patch_quad_base: &'a [u64],
    /// Name, length in bytes and CRC-32 of all other files.
    pub files: Vec<(&'a str, u64, u32)>,
}

impl IndexView<'_> {
    /// Number of chunk files.
    pub fn chunks(&self) -> usize {
        self.chunk_start.len() - 1
    }
}

/// The certificate of the interval counts, in whole cost units.
#[derive(Clone, Copy, Debug)]
pub struct CertificateView<'a> {
    /// One cost unit.
    pub cost_unit: f64,
    /// Cost of the counts, as parity computed it.
    pub objective: i64,
    /// Cost if each curve took its own cheapest count.
    pub base: i64,
    /// Lower bound, as claimed.
    pub bound: i64,
    /// What HiGHS solved.
    pub solved: Solved,
    /// Odd set -> the next larger set around it, or `u32::MAX`.
    pub set_parent: &'a [u32],
    /// Odd set -> twice its dual.
    pub set_dual2: &'a [i64],
    /// Sub-domain -> the least set that holds it, or `u32::MAX`.
    pub set_of: &'a [u32],
}

/// The proof of cost and patterns' price together, in whole cost units.
#[derive(Clone, Copy, Debug)]
pub struct PatternsView<'a> {
    /// Price of an excess of one.
    pub worth: i64,
    /// Price of all blocks, as claimed.
    pub price: i64,
    /// Lower bound, as claimed.
    pub bound: i64,
    /// What HiGHS solved.
    pub solved: Solved,
    /// T-joins that the multipliers took.
    pub rounds: u32,
    /// Neighbourhoods that HiGHS found better counts for.
    pub improved: u32,
    /// Block -> its sub-domain.
    pub block_subdomain: &'a [u32],
    /// Block -> sides, CSR; rules and multipliers alike.
    pub block_start: &'a [u32],
    /// Side -> curves, CSR.
    pub side_start: &'a [u32],
    /// Curves, side by side.
    pub side_curves: &'a [u32],
    /// Rule -> multiplier.
    pub multiplier: &'a [i64],
    /// Odd set -> the next larger set around it, or `u32::MAX`.
    pub set_parent: &'a [u32],
    /// Odd set -> twice its dual.
    pub set_dual2: &'a [i64],
    /// Node -> the least set that holds it, or `u32::MAX`.
    pub set_of: &'a [u32],
}

/// The frame: boundary nodes, curves, pieces, sub-domains.
#[derive(Clone, Copy, Debug)]
pub struct FrameView<'a> {
    /// Boundary nodes, local metres; the row is the global id.
    pub nodes: &'a [Xy],
    /// How many of them are nodes of the cleaned line work.
    pub fixed_nodes: u32,
    /// Curve -> nodes, CSR.
    pub curve_start: &'a [u32],
    /// Node ids, curve by curve.
    pub curve_nodes: &'a [u32],
    /// Curve -> sub-domain on its left.
    pub left: &'a [u32],
    /// Curve -> sub-domain on its right.
    pub right: &'a [u32],
    /// Curve -> bits: 1 seam, 2 rim.
    pub flags: &'a [u8],
    /// Edge -> pieces, CSR.
    pub piece_start: &'a [u32],
    /// Piece -> line.
    pub piece_line: &'a [u32],
    /// Piece -> station at the first node of the edge, metres.
    pub piece_from_m: &'a [f64],
    /// Piece -> station at the second node of the edge, metres.
    pub piece_to_m: &'a [f64],
    /// Sub-domain -> walks, CSR.
    pub subdomain_start: &'a [u32],
    /// Walk -> half-curves, CSR.
    pub walk_start: &'a [u32],
    /// Half-curves, walk by walk.
    pub walk_halves: &'a [HalfCurve],
    /// Sub-domain -> wished edge length, metres.
    pub size_m: &'a [f64],
    /// Curve -> wished number of intervals.
    pub goal: &'a [f64],
    /// Curve -> least count.
    pub lower: &'a [u32],
    /// Curve -> largest count.
    pub upper: &'a [u32],
    /// Curve -> weight of its cost.
    pub weight: &'a [f64],
    /// How good the counts are.
    pub certificate: Option<CertificateView<'a>>,
    /// The same for patterns.
    pub patterns: Option<PatternsView<'a>>,
}

impl<'a> FrameView<'a> {
    /// Number of curves.
    pub fn curves(&self) -> usize {
        self.left.len()
    }

    /// Number of sub-domains.
    pub fn subdomains(&self) -> usize {
        self.size_m.len()
    }

    /// Number of edges on all curves.
    pub fn edges(&self) -> usize {
        self.piece_start.len() - 1
    }

    /// Nodes of `curve` in order, both ends included.
    pub fn nodes_of(&self, curve: usize) -> &'a [u32] {
        &self.curve_nodes[range(self.curve_start, curve)]
    }

    /// Rows of the edges of `curve` in order.
    pub fn edges_of(&self, curve: usize) -> Range<usize> {
        let r = range(self.curve_start, curve);
        r.start - curve..r.end - curve - 1
    }

    /// Number of intervals of `curve`.
    pub fn count(&self, curve: usize) -> u32 {
        self.nodes_of(curve).len() as u32 - 1
    }

    /// Rows of the pieces of `edge`.
    pub fn pieces_of(&self, edge: usize) -> Range<usize> {
        range(self.piece_start, edge)
    }

    /// True if `curve` was added to cut a large sub-domain.
    pub fn is_seam(&self, curve: usize) -> bool {
        self.flags[curve] & 1 != 0
    }

    /// True if one side of `curve` is the outside.
    pub fn is_rim(&self, curve: usize) -> bool {
        self.flags[curve] & 2 != 0
    }

    /// Rows of the walks of `subdomain`.
    pub fn walks_of(&self, subdomain: usize) -> Range<usize> {
        range(self.subdomain_start, subdomain)
    }

    /// Half-curves of `walk` in order.
    pub fn halves_of(&self, walk: usize) -> &'a [HalfCurve] {
        &self.walk_halves[range(self.walk_start, walk)]
    }

    /// Node `k` along `half`, counted from where the half-curve starts.
    pub fn node_along(&self, half: HalfCurve, k: usize) -> u32 {
        let nodes = self.nodes_of((half >> 1) as usize);
        if half & 1 == 0 {
            nodes[k]
        } else {
            nodes[nodes.len() - 1 - k]
        }
    }

    /// The directed edges of `walk` in order, as pairs of global ids.
    pub fn walk_edges(self, walk: usize) -> impl Iterator<Item = [u32; 2]> + 'a {
        self.halves_of(walk).iter().flat_map(move |&half| {
            let count = self.count((half >> 1) as usize) as usize;
            (0..count).map(move |k| [self.node_along(half, k), self.node_along(half, k + 1)])
        })
    }
}

/// The line work as read, and what became of it.
#[derive(Clone, Copy, Debug)]
pub struct LinesView<'a> {
    /// The grid that points lie on.
    pub grid: Grid,
    /// Line -> input feature.
    pub source: &'a [u32],
    /// Line -> 0 constraint, 1 boundary, 2 hole.
    pub role: &'a [u8],
    /// Line -> points, CSR.
    pub point_start: &'a [u32],
    /// Points as (x, y), cells, line by line.
    pub points: &'a [[i32; 2]],
    /// Dropped stretch -> line.
    pub dropped_line: &'a [u32],
    /// Dropped stretch -> reason, as in `Reason`.
    pub dropped_reason: &'a [u8],
    /// Dropped stretch -> station of its begin, metres.
    pub dropped_from_m: &'a [f64],
    /// Dropped stretch -> station of its end, metres.
    pub dropped_to_m: &'a [f64],
    /// Change -> place, cells.
    pub change_at: &'a [[i32; 2]],
    /// Change -> how far something moved, metres.
    pub change_moved_m: &'a [f64],
    /// Row of the tally -> how often.
    pub tally_count: &'a [u64],
    /// Row of the tally -> largest displacement, metres.
    pub tally_moved_max_m: &'a [f64],
    /// Largest distance of an input sample from its mesh edge, metres.
    pub displacement_max_m: f64,
    /// 99 % quantile of the same by length, metres.
    pub displacement_p99_m: f64,
    /// Both as shares of the wished size along each line.
    pub displacement_max_over_size: f64,
    /// 99 % quantile of the same.
    pub displacement_p99_over_size: f64,
    /// Length of all lines inside the domain, metres.
    pub length_m: f64,
    /// Length dropped inside the domain, metres.
    pub length_dropped_m: f64,
    /// Kind -> how far its lines may lie from their mesh edges, metres.
    pub kind_tolerance_m: &'a [f64],
    /// Kind -> mesh edges along its lines that are shorter than this are findings, metres.
    pub kind_min_edge_m: &'a [f64],
    /// The same away from lines.
    pub min_edge_m: f64,
    pub(crate) kinds: Strings<'a>,
    pub(crate) names: Strings<'a>,
    pub(crate) words: Strings<'a>,
    pub(crate) kind_row: &'a [u16],
    pub(crate) name_row: &'a [u32],
    pub(crate) change_word: &'a [u16],
    pub(crate) tally_word: &'a [u16],
    pub(crate) findings: Findings<'a>,
}

pub(crate) type Findings<'a> = flatbuffers::Vector<
    'a,
    flatbuffers::ForwardsUOffset<crate::chunk::generated::lines::Finding<'a>>,
>;

/// One finding, as read back.
#[derive(Clone, Debug, PartialEq)]
pub struct FindingView<'a> {
    /// A short stable word.
    pub what: &'a str,
    /// A full sentence.
    pub text: &'a str,
    /// Index of the input feature.
    pub feature: Option<u32>,
    /// Projected coordinates, metres.
    pub at_m: Option<Xy>,
}

impl<'a> LinesView<'a> {
    /// Number of lines.
    pub fn lines(&self) -> usize {
        self.source.len()
    }

    /// Points of `line` in digitised order.
    pub fn points_of(&self, line: usize) -> &'a [[i32; 2]] {
        &self.points[range(self.point_start, line)]
    }

    /// Points of `line`, local metres.
    pub fn local_m(&self, line: usize) -> impl ExactSizeIterator<Item = Xy> + 'a {
        let grid = self.grid;
        (self.points_of(line).iter()).map(move |&[x, y]| grid.local_m(Point::new(x, y)))
    }

    /// Cumulative length at each point of `line`, metres: the same bits as `Domain::stations_m`.
    pub fn stations_m(&self, line: usize) -> Vec<f64> {
        let mut at = 0.0;
        let mut stations = vec![0.0];
        for pair in self.points_of(line).windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|[x, y]| Point::new(x, y));
            at += a.distance(b) * self.grid.cell_m;
            stations.push(at);
        }
        stations
    }

    /// How far `line` may lie from the mesh edges that represent it, metres.
    pub fn tolerance_m(&self, line: usize) -> f64 {
        self.kind_tolerance_m[self.kind_row[line] as usize]
    }

    /// What mesh edges that carry these lines should at least measure, metres.
    pub fn min_edge_along_m(&self, lines: &[u32]) -> f64 {
        let kinds = lines.iter().map(|&line| self.kind_row[line as usize]);
        let limits = kinds.map(|kind| self.kind_min_edge_m[usize::from(kind)]);
        limits.reduce(f64::min).unwrap_or(self.min_edge_m)
    }

    /// A line in words: kind, name, input feature.
    pub fn words_for(&self, line: usize) -> String {
        let said = [self.kind(line), self.name(line)];
        let said: Vec<&str> = said.into_iter().filter(|it| !it.is_empty()).collect();
        match self.source[line] {
            u32::MAX => "the box around all lines".to_string(),
            source if said.is_empty() => format!("feature {source}"),
            source => format!("{} (feature {source})", said.join(" ")),
        }
    }

    /// Name of the kind of `line`, or empty.
    pub fn kind(&self, line: usize) -> &'a str {
        self.kinds.get(self.kind_row[line] as usize)
    }

    /// Name of `line`, or empty.
    pub fn name(&self, line: usize) -> &'a str {
        self.names.get(self.name_row[line] as usize)
    }

    /// The word of `change`.
    pub fn change_what(&self, change: usize) -> &'a str {
        self.words.get(self.change_word[change] as usize)
    }

    /// The rows of the tally: word, how often, largest displacement in metres.
    pub fn tally(&self) -> impl Iterator<Item = (&'a str, u64, f64)> + '_ {
        (0..self.tally_count.len()).map(|row| {
            let word = self.words.get(self.tally_word[row] as usize);
            (word, self.tally_count[row], self.tally_moved_max_m[row])
        })
    }

    /// What is wrong with the input.
    pub fn findings(&self) -> impl ExactSizeIterator<Item = FindingView<'a>> + 'a {
        self.findings.iter().map(|it| FindingView {
            what: it.what(),
            text: it.text(),
            feature: (it.feature() != u32::MAX).then(|| it.feature()),
            at_m: (!it.x_m().is_nan()).then(|| [it.x_m(), it.y_m()]),
        })
    }
}

/// The patches of one chunk, column by column.
#[derive(Clone, Copy, Debug)]
pub struct ChunkView<'a> {
    /// The chunk's number.
    pub number: u32,
    /// Patch -> sub-domain.
    pub subdomain: &'a [u32],
    /// Patch -> method, as in `Method`.
    pub method: &'a [u8],
    /// Patch -> boundary, CSR.
    pub boundary_start: &'a [u32],
    /// Global ids of boundary nodes, patch by patch.
    pub boundary: &'a [u32],
    /// Patch -> interior, CSR.
    pub interior_start: &'a [u32],
    /// Interior nodes, local metres, patch by patch.
    pub interior: &'a [Xy],
    /// Patch -> quads, CSR.
    pub quad_start: &'a [u32],
    /// Quads as local ids, patch by patch.
    pub quads: &'a [[u32; 4]],
    /// Patch -> quads that the last resort made.
    pub last_resort_quads: &'a [u32],
}

/// One patch.
#[derive(Clone, Copy, Debug)]
pub struct PatchView<'a> {
    /// Its sub-domain.
    pub subdomain: u32,
    /// How it was made, as in `Method`.
    pub method: u8,
    /// Quads that the last resort made.
    pub last_resort_quads: u32,
    /// Local -> global id of boundary nodes.
    pub boundary: &'a [u32],
    /// Interior nodes, local metres.
    pub interior: &'a [Xy],
    /// Quads, local ids, counter-clockwise.
    pub quads: &'a [[u32; 4]],
}

impl<'a> ChunkView<'a> {
    /// Number of patches.
    pub fn len(&self) -> usize {
        self.subdomain.len()
    }

    /// True if the chunk has no patch.
    pub fn is_empty(&self) -> bool {
        self.subdomain.is_empty()
    }

    /// Patch `p` of this chunk.
    pub fn patch(&self, p: usize) -> PatchView<'a> {
        PatchView {
            subdomain: self.subdomain[p],
            method: self.method[p],
            last_resort_quads: self.last_resort_quads[p],
            boundary: &self.boundary[range(self.boundary_start, p)],
            interior: &self.interior[range(self.interior_start, p)],
            quads: &self.quads[range(self.quad_start, p)],
        }
    }

    /// All patches in order.
    pub fn patches(self) -> impl ExactSizeIterator<Item = PatchView<'a>> {
        (0..self.len()).map(move |p| self.patch(p))
    }
}

impl PatchView<'_> {
    /// Number of nodes, boundary and interior.
    pub fn nodes(&self) -> usize {
        self.boundary.len() + self.interior.len()
    }

    /// Positions of all its nodes into `places`, local metres; `boundary` are those of the frame.
    pub fn place_into(&self, boundary: &[Xy], places: &mut Vec<Xy>) {
        places.clear();
        places.extend(self.boundary.iter().map(|&id| boundary[id as usize]));
        places.extend_from_slice(self.interior);
    }

    /// Global id of `local`, where `base` is the patch's `patch_node_base`.
    pub fn global(&self, local: u32, base: u64) -> u64 {
        match self.boundary.get(local as usize) {
            Some(&id) => u64::from(id),
            None => base + u64::from(local) - self.boundary.len() as u64,
        }
    }
}
