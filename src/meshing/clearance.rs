//! Distance to the walks, and to points set so far: what decides where a new node may lie.
//!
//! Both are lists in the cells of a hash grid; a question looks at the cells within its reach, so
//! its cost does not depend on the size of the sub-domain.

use crate::geometry::point::Xy;
use crate::geometry::quad::distance;
use rustc_hash::FxHashMap;

/// End of a list.
const END: u32 = u32::MAX;

/// Segments in a hash grid.
pub(crate) struct Clearance {
    cell_m: f64,
    /// Cell -> its first entry.
    first: FxHashMap<(i32, i32), u32>,
    /// Segment and following entry.
    entries: Vec<(u32, u32)>,
    segments: Vec<[Xy; 2]>,
}

/// What of the walks is nearest to a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    /// Metres.
    pub distance_m: f64,
    /// True if the point is on the left of the walks there.
    pub inside: bool,
    /// The segment that decided.
    pub segment: u32,
}

impl Clearance {
    /// Files the segments under all cells of side `cell_m` that their boxes touch.
    pub fn of(segments: Vec<[Xy; 2]>, cell_m: f64) -> Clearance {
        let mut index = Clearance {
            cell_m,
            first: FxHashMap::default(),
            entries: Vec::with_capacity(2 * segments.len()),
            segments,
        };
        for s in 0..index.segments.len() {
            let [a, b] = index.segments[s];
            let low = index.cell([a[0].min(b[0]), a[1].min(b[1])]);
            let high = index.cell([a[0].max(b[0]), a[1].max(b[1])]);
            for x in low.0..=high.0 {
                for y in low.1..=high.1 {
                    let first = index.first.entry((x, y)).or_insert(END);
                    index.entries.push((s as u32, *first));
                    *first = index.entries.len() as u32 - 1;
                }
            }
        }
        index
    }

    fn cell(&self, p: Xy) -> (i32, i32) {
        let at = p.map(|v| (v / self.cell_m).floor() as i32);
        (at[0], at[1])
    }

    /// The nearest segment within `reach_m` of `p`.
    pub fn nearest(&self, p: Xy, reach_m: f64) -> Option<Nearest> {
        let low = self.cell([p[0] - reach_m, p[1] - reach_m]);
        let high = self.cell([p[0] + reach_m, p[1] + reach_m]);
        let mut least = reach_m;
        let mut best: Option<(u32, f64)> = None;
        for x in low.0..=high.0 {
            for y in low.1..=high.1 {
                let mut at = self.first.get(&(x, y)).copied().unwrap_or(END);
                while at != END {
                    let (s, following) = self.entries[at as usize];
                    at = following;
                    let (distance, sine) = side_of(self.segments[s as usize], p);
                    if distance > least * (1.0 + 1e-9) {
                        continue;
                    }
                    // Of two segments that meet in the nearest point, the one seen at the larger
                    // sine decides; of the two banks of a slit, the one toward the point. Straight
                    // ahead of a slit's tip both sines are zero, and that is inside.
                    let ahead = distance < least * (1.0 - 1e-9)
                        || best.is_none_or(|(_, sine0): (u32, f64)| {
                            sine.abs() > sine0.abs() + 1e-9
                                || (sine.abs() > sine0.abs() - 1e-9 && sine > sine0)
                        });
                    if ahead {
                        best = Some((s, sine));
                    }
                    least = least.min(distance);
                }
            }
        }
        best.map(|(segment, sine)| Nearest {
            distance_m: least,
            inside: sine >= 0.0,
            segment,
        })
    }
}

/// Distance from `p` to a segment, and the sine of the angle under which its line is seen from the
/// nearest point: positive on the left.
fn side_of([a, b]: [Xy; 2], p: Xy) -> (f64, f64) {
    let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
    let (px, py) = (p[0] - a[0], p[1] - a[1]);
    let length2 = ex * ex + ey * ey;
    let t = ((px * ex + py * ey) / length2).clamp(0.0, 1.0);
    let distance = distance([px, py], [t * ex, t * ey]);
    let cross = ex * py - ey * px;
    (
        distance,
        cross / (length2.sqrt() * distance.max(f64::MIN_POSITIVE)),
    )
}

/// Points in a hash grid, added one by one.
pub(crate) struct Spacing {
    cell_m: f64,
    first: FxHashMap<(i32, i32), u32>,
    /// Point and following entry.
    points: Vec<(Xy, u32)>,
}

impl Spacing {
    /// An empty grid with cells of side `cell_m`.
    pub fn new(cell_m: f64) -> Spacing {
        Spacing {
            cell_m,
            first: FxHashMap::default(),
            points: Vec::new(),
        }
    }

    fn cell(&self, p: Xy) -> (i32, i32) {
        let at = p.map(|v| (v / self.cell_m).floor() as i32);
        (at[0], at[1])
    }

    /// Adds a point.
    pub fn add(&mut self, p: Xy) {
        let cell = self.cell(p);
        let first = self.first.entry(cell).or_insert(END);
        self.points.push((p, *first));
        *first = self.points.len() as u32 - 1;
    }

    /// True if no point is nearer to `p` than `gap_m`.
    pub fn is_free(&self, p: Xy, gap_m: f64) -> bool {
        let low = self.cell([p[0] - gap_m, p[1] - gap_m]);
        let high = self.cell([p[0] + gap_m, p[1] + gap_m]);
        for x in low.0..=high.0 {
            for y in low.1..=high.1 {
                let mut at = self.first.get(&(x, y)).copied().unwrap_or(END);
                while at != END {
                    let (other, following) = self.points[at as usize];
                    if distance(p, other) < gap_m {
                        return false;
                    }
                    at = following;
                }
            }
        }
        true
    }
}
