//! GeoJSON of every source line: as meshed, or as cleaned.

use crate::chunk::chains::LineEdges;
use crate::chunk::chains::Step;
use crate::chunk::reader::Mesh;
use crate::chunk::views::FrameView;
use crate::chunk::views::LinesView;
use crate::export::Stats;
use crate::export::destination::Destination;
use crate::export::error::Error;
use crate::export::outline;
use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::partition::subdomains::OUTSIDE;
use smallvec::SmallVec;
use std::io;
use std::io::Write;

/// Which nodes a line is drawn through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Along {
    /// All nodes of its mesh edges.
    MeshNodes,
    /// Those that the cleaned line work has; the others lie on straight edges between them. The
    /// outline comes with them.
    CleanedNodes,
}

pub(crate) fn write(mesh: &Mesh, to: &mut Destination, along: Along) -> Result<Stats, Error> {
    let (frame, lines) = (mesh.frame(), mesh.lines());
    let edges = LineEdges::of(mesh);
    let draw = Drawing {
        frame,
        lines,
        origin_m: mesh.index().grid.origin_m,
        shows: shown(&frame, along, mesh.index().grid.cell_m),
    };
    let mut features = 0;
    to.write(|file| open_collection(file, mesh.index().epsg))?;
    for line in (0..lines.lines()).filter(|&line| lines.role[line] == 0) {
        for chain in edges.chains_of(line) {
            to.write(|file| {
                separate(file, &mut features)?;
                draw.feature(file, line, &chain)
            })?;
        }
    }
    if along == Along::CleanedNodes {
        for polygon in outline::polygons(&frame) {
            to.write(|file| {
                separate(file, &mut features)?;
                draw.polygon(file, &polygon)
            })?;
        }
    }
    to.write(|file| match along {
        Along::MeshNodes => writeln!(file, "\n]}}"),
        Along::CleanedNodes => left(file, &lines),
    })?;
    Ok(Stats {
        features,
        ..Stats::default()
    })
}

/// Ends the collection with the places that clean-up had to leave.
fn left(file: &mut dyn Write, lines: &LinesView) -> io::Result<()> {
    let words = ["short-edge", "narrow-gap", "sharp-angle"];
    let findings = lines.findings().filter(|it| words.contains(&it.what));
    let places: Vec<Xy> = findings.filter_map(|it| it.at_m).collect();
    write!(file, "\n],\n\"polder_left\":")?;
    coordinates(file, &places, [0.0, 0.0])?;
    writeln!(file, "}}")
}

/// Which boundary nodes are drawn.
///
/// Of the nodes of the cleaned line work, those where a seam ends on a straight edge are not: they
/// were made after clean-up, at the grid point nearest to the edge.
fn shown(frame: &FrameView, along: Along, cell_m: f64) -> Vec<bool> {
    if along == Along::MeshNodes {
        return vec![true; frame.nodes.len()];
    }
    let fixed = frame.fixed_nodes;
    let mut neighbours: Vec<SmallVec<[u32; 3]>> = vec![SmallVec::new(); fixed as usize];
    let mut is_on_seam = vec![false; fixed as usize];
    for curve in 0..frame.curves() {
        let nodes = frame.nodes_of(curve).iter().copied();
        let nodes: Vec<u32> = nodes.filter(|&node| node < fixed).collect();
        for pair in nodes.windows(2) {
            for (node, other) in [(pair[0], pair[1]), (pair[1], pair[0])] {
                match frame.is_seam(curve) {
                    true => is_on_seam[node as usize] = true,
                    false => neighbours[node as usize].push(other),
                }
            }
        }
    }
    let at = |node: u32| frame.nodes[node as usize];
    let passes = |node: usize| match neighbours[node][..] {
        [a, b] => a != b && nearest_m(at(node as u32), [at(a), at(b)]) <= cell_m,
        _ => false,
    };
    let is_shown = |node| node < fixed as usize && !(is_on_seam[node] && passes(node));
    (0..frame.nodes.len()).map(is_shown).collect()
}

/// Distance from `p` to the segment.
fn nearest_m(p: Xy, [a, b]: [Xy; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let along = (p[0] - a[0]) * dx + (p[1] - a[1]) * dy;
    let t = (along / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    distance(p, [a[0] + t * dx, a[1] + t * dy])
}

/// The head of a feature collection, with the reference system where GDAL and QGIS look for it.
pub(crate) fn open_collection(file: &mut dyn Write, epsg: Option<u32>) -> io::Result<()> {
    writeln!(file, "{{\"type\":\"FeatureCollection\",")?;
    if let Some(epsg) = epsg {
        writeln!(
            file,
            "\"crs\":{{\"type\":\"name\",\"properties\":{{\"name\":\"urn:ogc:def:crs:EPSG::{epsg}\"}}}},"
        )?;
    }
    write!(file, "\"features\":[")
}

/// The comma before all features but the first.
pub(crate) fn separate(file: &mut dyn Write, features: &mut u64) -> io::Result<()> {
    *features += 1;
    writeln!(file, "{}", if *features > 1 { "," } else { "" })
}

/// `text` as JSON.
pub(crate) fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// `[[x, y], ..]`. Numbers are the shortest that read back as the same bits.
pub(crate) fn coordinates(file: &mut dyn Write, places: &[Xy], origin_m: Xy) -> io::Result<()> {
    write!(file, "[")?;
    for (k, p) in places.iter().enumerate() {
        let comma = if k > 0 { "," } else { "" };
        write!(
            file,
            "{comma}[{},{}]",
            p[0] + origin_m[0],
            p[1] + origin_m[1]
        )?;
    }
    write!(file, "]")
}

struct Drawing<'a> {
    frame: FrameView<'a>,
    lines: LinesView<'a>,
    origin_m: Xy,
    /// Node -> is it drawn?
    shows: Vec<bool>,
}

impl Drawing<'_> {
    fn feature(&self, file: &mut dyn Write, line: usize, chain: &[Step]) -> io::Result<()> {
        write!(
            file,
            "{{\"type\":\"Feature\",\"properties\":{{\"source\":{},\"kind\":{},\"name\":{},",
            self.lines.source[line],
            quoted(self.lines.kind(line)),
            quoted(self.lines.name(line))
        )?;
        let (from_m, to_m) = (chain[0].from_m, chain[chain.len() - 1].to_m);
        write!(file, "\"from_m\":{from_m:.3},\"to_m\":{to_m:.3},")?;
        self.sides(file, chain)?;
        write!(
            file,
            "}},\"geometry\":{{\"type\":\"LineString\",\"coordinates\":"
        )?;
        let nodes = std::iter::once(chain[0].from).chain(chain.iter().map(|step| step.to));
        let last = chain.len();
        let places: Vec<Xy> = (nodes.enumerate())
            .filter(|&(k, node)| {
                // The ends stay, whatever they are.
                k == 0 || k == last || self.shows[node as usize]
            })
            .map(|(_, node)| self.frame.nodes[node as usize])
            .collect();
        coordinates(file, &places, self.origin_m)?;
        write!(file, "}}}}")
    }

    /// A polygon of the outline.
    fn polygon(&self, file: &mut dyn Write, polygon: &[Vec<u32>]) -> io::Result<()> {
        write!(
            file,
            "{{\"type\":\"Feature\",\"properties\":{{\"role\":\"boundary\"}},\
             \"geometry\":{{\"type\":\"Polygon\",\"coordinates\":["
        )?;
        for (k, ring) in polygon.iter().enumerate() {
            let nodes = &ring[..ring.len() - 1];
            let shown = nodes.iter().filter(|&&node| self.shows[node as usize]);
            let mut places: Vec<Xy> = shown.map(|&node| self.frame.nodes[node as usize]).collect();
            places.extend(places.first().copied());
            write!(file, "{}", if k > 0 { "," } else { "" })?;
            coordinates(file, &places, self.origin_m)?;
        }
        write!(file, "]}}}}")
    }

    /// The sub-domains left and right of the chain, run by run: `left[i]` and `right[i]` hold for
    /// `edges[i]` mesh edges; null is the outside.
    fn sides(&self, file: &mut dyn Write, chain: &[Step]) -> io::Result<()> {
        let sides_of = |step: &Step| {
            let curve = step.curve as usize;
            let (left, right) = (self.frame.left[curve], self.frame.right[curve]);
            if step.forward {
                (left, right)
            } else {
                (right, left)
            }
        };
        let runs: Vec<&[Step]> = chain.chunk_by(|a, b| sides_of(a) == sides_of(b)).collect();
        let name = |side: u32| match side {
            OUTSIDE => "null".to_string(),
            side => side.to_string(),
        };
        let list = |pick: &dyn Fn(&[Step]) -> String| {
            let picked: Vec<String> = runs.iter().map(|run| pick(run)).collect();
            picked.join(",")
        };
        write!(
            file,
            "\"left\":[{}],\"right\":[{}],\"edges\":[{}]",
            list(&|run| name(sides_of(&run[0]).0)),
            list(&|run| name(sides_of(&run[0]).1)),
            list(&|run| run.len().to_string())
        )
    }
}
