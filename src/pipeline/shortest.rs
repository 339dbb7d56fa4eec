//! Mesh edges below the least length that were made after clean-up, as findings: by counts and seams
//! on lines, by meshing inside patches.

use crate::chunk::linework::Limits;
use crate::chunk::views::FrameView;
use crate::chunk::views::PatchView;
use crate::domain::finding::Finding;
use crate::domain::line::Domain;
use crate::domain::line::LineId;
use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use crate::partition::subdomains::OUTSIDE;

/// Finds them, patch by patch.
pub(super) struct Shortest<'a> {
    domain: &'a Domain,
    limits: &'a Limits,
    /// Least length inside each sub-domain: the least of its lines and of open ground, metres.
    inside_m: Vec<f64>,
    /// Middles of the edges that are listed, sorted.
    listed: Vec<[u64; 2]>,
    places: Vec<Xy>,
    pub(super) findings: Vec<Finding>,
}

impl<'a> Shortest<'a> {
    /// Lists the edges on lines; those that clean-up left are among `known`.
    pub(super) fn on_lines(
        domain: &'a Domain,
        limits: &'a Limits,
        known: &[Finding],
        frame: &FrameView,
    ) -> Shortest<'a> {
        let known = known.iter().filter(|it| it.what == "short-edge");
        let mut made = Shortest {
            domain,
            limits,
            inside_m: vec![limits.min_edge_m; frame.subdomains()],
            listed: known.filter_map(|it| it.at_m.map(key)).collect(),
            places: Vec::new(),
            findings: Vec::new(),
        };
        made.listed.sort_unstable();
        for curve in 0..frame.curves() {
            for (edge, pair) in frame.edges_of(curve).zip(frame.nodes_of(curve).windows(2)) {
                let lines = &frame.piece_line[frame.pieces_of(edge)];
                let limit_m = made.limit_m(lines);
                for side in [frame.left[curve], frame.right[curve]] {
                    if side != OUTSIDE {
                        let inside_m = &mut made.inside_m[side as usize];
                        *inside_m = inside_m.min(limit_m);
                    }
                }
                let ends = [pair[0], pair[1]].map(|node| frame.nodes[node as usize]);
                made.list_on_lines(ends, lines, limit_m);
            }
        }
        made.listed
            .extend(made.findings.iter().filter_map(|it| it.at_m.map(key)));
        made.listed.sort_unstable();
        made
    }

    /// Least length of an edge along these lines, metres.
    fn limit_m(&self, lines: &[LineId]) -> f64 {
        let kinds = lines
            .iter()
            .map(|&line| self.domain.lines[line as usize].kind);
        let limits = kinds.map(|kind| self.limits.min_edge_by_kind_m[usize::from(kind)]);
        limits.reduce(f64::min).unwrap_or(self.limits.min_edge_m)
    }

    fn list_on_lines(&mut self, [a, b]: [Xy; 2], lines: &[LineId], limit_m: f64) {
        let length_m = distance(a, b);
        let at_m = self.middle_m(a, b);
        if length_m >= limit_m || self.listed.binary_search(&key(at_m)).is_ok() {
            return;
        }
        self.findings.push(Finding {
            what: "short-interval",
            text: format!(
                "A mesh edge of {length_m:.3} m on {} is shorter than {limit_m:.3} m: an even number \
                 of edges around a sub-domain, or the end of a seam, asks for it.",
                self.named(lines)
            ),
            feature: self.feature(lines),
            at_m: Some(at_m),
        });
    }

    /// Lists the edges inside one patch.
    pub(super) fn add(&mut self, frame: &FrameView, patch: &PatchView) {
        let mut places = std::mem::take(&mut self.places);
        patch.place_into(frame.nodes, &mut places);
        let limit_m = self.inside_m[patch.subdomain as usize];
        let mut short: Vec<([u32; 2], f64)> = Vec::new();
        for quad in patch.quads {
            for k in 0..4 {
                let [u, v] = [quad[k], quad[(k + 1) % 4]];
                let length_m = distance(places[u as usize], places[v as usize]);
                if length_m < limit_m {
                    short.push(([u.min(v), u.max(v)], length_m));
                }
            }
        }
        short.sort_by_key(|it| it.0);
        short.dedup_by_key(|it| it.0);
        for ([u, v], length_m) in short {
            let (a, b) = (places[u as usize], places[v as usize]);
            let at_m = self.middle_m(a, b);
            if self.listed.binary_search(&key(at_m)).is_err() {
                let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
                self.list_inside(frame, patch.subdomain, middle, [length_m, limit_m]);
            }
        }
        self.places = places;
    }

    fn list_inside(
        &mut self,
        frame: &FrameView,
        subdomain: u32,
        middle: Xy,
        [length_m, limit_m]: [f64; 2],
    ) {
        let (away_m, lines) = nearest_line(frame, subdomain, middle);
        let origin_m = self.domain.grid.origin_m;
        self.findings.push(Finding {
            what: "short-inside",
            text: format!(
                "A mesh edge of {length_m:.3} m inside sub-domain {subdomain} is shorter than \
                 {limit_m:.3} m; the nearest line, {away_m:.3} m away, is {}.",
                self.named(lines)
            ),
            feature: self.feature(lines),
            at_m: Some([middle[0] + origin_m[0], middle[1] + origin_m[1]]),
        });
    }

    fn middle_m(&self, a: Xy, b: Xy) -> Xy {
        let origin_m = self.domain.grid.origin_m;
        [0, 1].map(|k| 0.5 * (a[k] + b[k]) + origin_m[k])
    }

    fn named(&self, lines: &[LineId]) -> String {
        let words = lines
            .iter()
            .take(3)
            .map(|&line| self.domain.words_for(line));
        match lines {
            [] => "a seam".to_string(),
            _ => words.collect::<Vec<_>>().join(", "),
        }
    }

    fn feature(&self, lines: &[LineId]) -> Option<u32> {
        lines
            .first()
            .map(|&line| self.domain.lines[line as usize].source)
    }
}

/// Positions as they sort and compare exactly: middles are always computed in the same way.
fn key(at_m: Xy) -> [u64; 2] {
    at_m.map(f64::to_bits)
}

/// Distance to the nearest edge of the walks of a sub-domain that carries lines, and the lines.
fn nearest_line<'a>(frame: &FrameView<'a>, subdomain: u32, p: Xy) -> (f64, &'a [LineId]) {
    let mut best: (f64, &[LineId]) = (f64::INFINITY, &[]);
    for walk in frame.walks_of(subdomain as usize) {
        for &half in frame.halves_of(walk) {
            let curve = (half >> 1) as usize;
            for (edge, pair) in frame.edges_of(curve).zip(frame.nodes_of(curve).windows(2)) {
                let lines = &frame.piece_line[frame.pieces_of(edge)];
                let [a, b] = [pair[0], pair[1]].map(|node| frame.nodes[node as usize]);
                let away_m = to_segment_m(p, a, b);
                if !lines.is_empty() && away_m < best.0 {
                    best = (away_m, lines);
                }
            }
        }
    }
    best
}

fn to_segment_m(p: Xy, a: Xy, b: Xy) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let along = (p[0] - a[0]) * dx + (p[1] - a[1]) * dy;
    let t = (along / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    distance(p, [a[0] + t * dx, a[1] + t * dy])
}
