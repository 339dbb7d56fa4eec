//! Promise `edges`: no mesh edge is shorter than it may be, but for those that are listed.

use crate::check::verdict::Promise;
use crate::chunk::reader::Mesh;
use crate::chunk::views::PatchView;
use crate::geometry::point::Xy;
use crate::partition::subdomains::OUTSIDE;

/// A finding lies in the middle of its edge, give or take rounding, metres.
const SAME_M: f64 = 1e-6;

/// The check in the making: patches are added one by one.
pub(crate) struct Shortest {
    /// Least length inside each sub-domain, metres.
    inside_m: Vec<f64>,
    origin_m: Xy,
    /// Places of the findings, by their first coordinate.
    listed: Vec<Xy>,
    found: u64,
    least_m: f64,
    promise: Promise,
}

impl Shortest {
    /// Looks at the edges on curves.
    pub fn new(mesh: &Mesh) -> Shortest {
        let (frame, lines) = (mesh.frame(), mesh.lines());
        let findings = lines.findings().filter(|it| it.what.starts_with("short-"));
        let mut listed: Vec<Xy> = findings.filter_map(|it| it.at_m).collect();
        listed.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut made = Shortest {
            inside_m: vec![lines.min_edge_m; frame.subdomains()],
            origin_m: mesh.index().grid.origin_m,
            listed,
            found: 0,
            least_m: f64::INFINITY,
            promise: Promise::new("edges"),
        };
        for curve in 0..frame.curves() {
            for (edge, pair) in frame.edges_of(curve).zip(frame.nodes_of(curve).windows(2)) {
                let limit_m = lines.min_edge_along_m(&frame.piece_line[frame.pieces_of(edge)]);
                let sides = [frame.left[curve], frame.right[curve]];
                for side in sides.into_iter().filter(|&side| side != OUTSIDE) {
                    let inside_m = &mut made.inside_m[side as usize];
                    *inside_m = inside_m.min(limit_m);
                }
                made.look(
                    [pair[0], pair[1]].map(|node| frame.nodes[node as usize]),
                    limit_m,
                );
            }
        }
        made
    }

    /// Looks at the edges of a patch whose cells all name nodes of it.
    pub fn add(&mut self, patch: &PatchView, places: &[Xy]) {
        let limit_m = self.inside_m[patch.subdomain as usize];
        for quad in patch.quads {
            for k in 0..4 {
                let ends = [quad[k], quad[(k + 1) % 4]].map(|node| places[node as usize]);
                self.look(ends, limit_m);
            }
        }
    }

    fn look(&mut self, [a, b]: [Xy; 2], limit_m: f64) {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length_m = (dx * dx + dy * dy).sqrt();
        self.least_m = self.least_m.min(length_m);
        if length_m >= limit_m {
            return;
        }
        self.found += 1;
        let at_m = [0, 1].map(|k| 0.5 * (a[k] + b[k]) + self.origin_m[k]);
        if !self.is_listed(at_m) {
            self.promise.broken(Some(at_m), || {
                format!("an edge of {length_m:.4} m is below {limit_m:.4} m and not listed")
            });
        }
    }

    fn is_listed(&self, [x, y]: Xy) -> bool {
        let from = self.listed.partition_point(|it| it[0] < x - SAME_M);
        (self.listed[from..].iter())
            .take_while(|it| it[0] <= x + SAME_M)
            .any(|it| (it[1] - y).abs() <= SAME_M)
    }

    pub fn promise(mut self) -> Promise {
        let (listed, found, least_m) = (self.listed.len(), self.found, self.least_m);
        self.promise.says(format!(
            "least {least_m:.3} m; {listed} shorter than they should be are listed, seen {found} times"
        ));
        self.promise
    }
}
