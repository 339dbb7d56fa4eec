//! Promise `lines`: each constraint line is there from end to end, as itself.

use crate::check::segments::nearest_m;
use crate::check::verdict::Promise;
use crate::check::verdict::projected;
use crate::chunk::chains::LineEdges;
use crate::chunk::chains::Step;
use crate::chunk::reader::Mesh;
use crate::chunk::views::LinesView;
use crate::geometry::point::Xy;

/// Samples lie this fraction of the mesh size apart.
const SAMPLE: f64 = 0.1;

/// `slack_m`: what rounding adds to the tolerance of each line.
pub(crate) fn check(mesh: &Mesh, slack_m: f64) -> Promise {
    let mut promise = Promise::new("lines");
    let lines = mesh.lines();
    let edges = LineEdges::of(mesh);
    let dropped = Stretches::of(&lines);
    let mut totals = Totals::default();
    for line in (0..lines.lines()).filter(|&line| lines.role[line] == 0) {
        let chains = edges.chains_of(line);
        totals.chains += chains.len() as u64;
        totals.steps += chains.iter().map(|chain| chain.len() as u64).sum::<u64>();
        let follow = Follow {
            origin_m: mesh.index().grid.origin_m,
            nodes: mesh.frame().nodes,
            places: lines.local_m(line).collect(),
            stations_m: lines.stations_m(line),
            steps: chains.concat(),
            dropped: dropped.of_line(line as u32),
            allowed_m: lines.tolerance_m(line) + slack_m,
            step_m: SAMPLE * mesh.index().size_m,
        };
        let name = || format!("line {line} (feature {})", lines.source[line]);
        follow.tears(&chains, &name, &mut promise);
        follow.directions(&chains, &name, &mut promise);
        let there_m = follow.line_to_mesh(&name, &mut promise);
        let back_m = follow.mesh_to_line(&name, &mut promise);
        let farthest_m = there_m.max(back_m);
        totals.farthest_m = totals.farthest_m.max(farthest_m);
        totals.used = totals.used.max(farthest_m / follow.allowed_m);
    }
    promise.says(format!(
        "{} edges in {} chains, farthest {:.3} m, at most {:.1} % of what is allowed",
        totals.steps,
        totals.chains,
        totals.farthest_m,
        100.0 * totals.used
    ));
    promise
}

#[derive(Default)]
struct Totals {
    chains: u64,
    steps: u64,
    farthest_m: f64,
    /// Largest share of a line's own tolerance.
    used: f64,
}

/// Dropped stretches by line.
struct Stretches {
    /// (line, from, to), sorted by line.
    rows: Vec<(u32, f64, f64)>,
}

impl Stretches {
    fn of(lines: &LinesView) -> Stretches {
        let mut rows: Vec<(u32, f64, f64)> = (0..lines.dropped_line.len())
            .map(|k| {
                (
                    lines.dropped_line[k],
                    lines.dropped_from_m[k],
                    lines.dropped_to_m[k],
                )
            })
            .collect();
        rows.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        Stretches { rows }
    }

    fn of_line(&self, line: u32) -> &[(u32, f64, f64)] {
        let from = self.rows.partition_point(|row| row.0 < line);
        let to = self.rows.partition_point(|row| row.0 <= line);
        &self.rows[from..to]
    }
}

/// One line and the mesh edges that carry it.
struct Follow<'a> {
    origin_m: Xy,
    nodes: &'a [Xy],
    /// Points of the line as read, local metres, and their stations.
    places: Vec<Xy>,
    stations_m: Vec<f64>,
    /// Its mesh edges, by station.
    steps: Vec<Step>,
    dropped: &'a [(u32, f64, f64)],
    allowed_m: f64,
    step_m: f64,
}

impl Follow<'_> {
    /// True if a dropped stretch reaches into `from_m .. to_m`, give or take the tolerance.
    fn is_dropped(&self, from_m: f64, to_m: f64) -> bool {
        (self.dropped.iter())
            .any(|&(_, a, b)| a - self.allowed_m <= to_m && b + self.allowed_m >= from_m)
    }

    /// Chains may only end where the line ends or where a stretch was dropped.
    fn tears(&self, chains: &[Vec<Step>], name: &dyn Fn() -> String, promise: &mut Promise) {
        for pair in chains.windows(2) {
            let (before, after) = (pair[0][pair[0].len() - 1], pair[1][0]);
            let (low, high) = (before.to_m.min(after.from_m), before.to_m.max(after.from_m));
            if !self.is_dropped(low, high) {
                let at_m = projected(self.nodes[before.to as usize], self.origin_m);
                promise.broken(at_m, || {
                    format!("{}: torn at station {:.3} m", name(), before.to_m)
                });
            }
        }
    }

    /// Chains run as the line was digitised. Asked over stretches that are long beside the
    /// tolerance, since within it nodes may lie anywhere.
    fn directions(&self, chains: &[Vec<Step>], name: &dyn Fn() -> String, promise: &mut Promise) {
        let long_m = 4.0 * self.allowed_m;
        for chain in chains {
            let mut begin = 0;
            for end in 0..chain.len() {
                let (a, b) = (&chain[begin], &chain[end]);
                let line = minus(self.place_at(b.to_m), self.place_at(a.from_m));
                if line[0].hypot(line[1]) < long_m {
                    continue;
                }
                let (p, q) = (self.nodes[a.from as usize], self.nodes[b.to as usize]);
                let mesh = minus(q, p);
                if line[0] * mesh[0] + line[1] * mesh[1] <= 0.0 {
                    promise.broken(projected(p, self.origin_m), || {
                        format!(
                            "{}: against its direction at station {:.3} m",
                            name(),
                            a.from_m
                        )
                    });
                }
                begin = end + 1;
                if begin == chain.len() {
                    break;
                }
            }
        }
    }

    /// The point of the line at a station, local metres.
    fn place_at(&self, station_m: f64) -> Xy {
        let after = self.stations_m.partition_point(|&s| s <= station_m);
        let k = after.clamp(1, self.places.len() - 1);
        let (a, b) = (self.places[k - 1], self.places[k]);
        let length = self.stations_m[k] - self.stations_m[k - 1];
        let t = ((station_m - self.stations_m[k - 1]) / length).clamp(0.0, 1.0);
        [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
    }

    /// Largest distance of the line's samples from its mesh edges; those too far are defects.
    fn line_to_mesh(&self, name: &dyn Fn() -> String, promise: &mut Promise) -> f64 {
        let mut farthest = 0.0_f64;
        for k in 0..self.places.len() - 1 {
            let [a, b] = [self.places[k], self.places[k + 1]];
            let length = self.stations_m[k + 1] - self.stations_m[k];
            let parts = (length / self.step_m).ceil().max(1.0) as usize;
            // The end of a segment is the begin of the next, but for the last one.
            let last = parts + usize::from(k + 2 == self.places.len());
            for part in 0..last {
                let t = part as f64 / parts as f64;
                let p = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
                let station = self.stations_m[k] + t * length;
                if self.is_dropped(station, station) {
                    continue;
                }
                let distance = self.to_steps_m(p, station);
                farthest = farthest.max(distance.min(self.allowed_m));
                if distance > self.allowed_m {
                    promise.broken(projected(p, self.origin_m), || {
                        format!(
                            "{}: lost at station {station:.3} m ({distance:.3} m)",
                            name()
                        )
                    });
                    // One defect a segment says enough.
                    break;
                }
            }
        }
        farthest
    }

    /// Distance from `p` to the mesh edges of the line: those near `station` first, since lines
    /// are long and the right edge is nearly always there.
    fn to_steps_m(&self, p: Xy, station: f64) -> f64 {
        let at = |step: &Step| [step.from, step.to].map(|node| self.nodes[node as usize]);
        let nearest = |steps: &[Step]| nearest_m(p, steps.iter().map(at));
        let reach = 2.0 * self.allowed_m;
        let from = self.steps.partition_point(|s| s.from_m < station - reach);
        let to = self.steps.partition_point(|s| s.from_m <= station + reach);
        let local = nearest(&self.steps[from.saturating_sub(2)..to]);
        if local <= self.allowed_m {
            local
        } else {
            nearest(&self.steps)
        }
    }

    /// Largest distance of the mesh edges' samples from the line; those too far are defects.
    fn mesh_to_line(&self, name: &dyn Fn() -> String, promise: &mut Promise) -> f64 {
        let mut farthest = 0.0_f64;
        for step in &self.steps {
            let [a, b] = [step.from, step.to].map(|node| self.nodes[node as usize]);
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            let parts = (length / self.step_m).ceil().max(1.0) as usize;
            for part in 0..=parts {
                let t = part as f64 / parts as f64;
                let p = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
                let distance = self.to_line_m(p, step);
                farthest = farthest.max(distance.min(self.allowed_m));
                if distance > self.allowed_m {
                    promise.broken(projected(p, self.origin_m), || {
                        let station = step.from_m;
                        format!(
                            "{}: its mesh edge at station {station:.3} m lies {distance:.3} m \
                                 beside it",
                            name()
                        )
                    });
                    break;
                }
            }
        }
        farthest
    }

    /// Distance from `p` to the line, near the stations of `step` first.
    fn to_line_m(&self, p: Xy, step: &Step) -> f64 {
        let segment = |k: usize| [self.places[k], self.places[k + 1]];
        let nearest = |from: usize, to: usize| nearest_m(p, (from..to).map(segment));
        let segments = self.places.len() - 1;
        let reach = 2.0 * self.allowed_m;
        let before = |m: f64| self.stations_m.partition_point(|&s| s < m);
        let from = before(step.from_m - reach).saturating_sub(1);
        let to = before(step.to_m + reach).clamp(from + 1, segments);
        let local = nearest(from.min(segments - 1), to);
        if local <= self.allowed_m {
            local
        } else {
            nearest(0, segments)
        }
    }
}

fn minus(a: Xy, b: Xy) -> Xy {
    [a[0] - b[0], a[1] - b[1]]
}
