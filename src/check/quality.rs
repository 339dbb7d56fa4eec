//! How good the cells are, streamed: histograms, valences, the worst places.
//!
//! Shape measures are those of [`geometry::quad`](crate::geometry::quad). Quantiles come from bins
//! of fixed width (their resolution is said with each), extremes are exact.

use crate::check::seam_rows::SeamRows;
use crate::check::seam_rows::a_row_on;
use crate::chunk::views::FrameView;
use crate::chunk::views::PatchView;
use crate::geometry::point::Xy;
use crate::geometry::quad::area;
use crate::geometry::quad::corner_angles_deg;
use crate::geometry::quad::corner_jacobians;
use crate::geometry::quad::distance;
use crate::partition::subdomains::OUTSIDE;

/// Counts in bins of equal width; what lies outside falls into the first or last bin.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Lower end of the first bin.
    pub low: f64,
    /// Upper end of the last bin.
    pub high: f64,
    /// Count of each bin.
    pub bins: Vec<u64>,
    /// Least value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Sum of all values, in the order of the files.
    pub sum: f64,
    /// Number of values.
    pub count: u64,
}

impl Histogram {
    fn new(low: f64, high: f64, bins: usize) -> Histogram {
        Histogram {
            low,
            high,
            bins: vec![0; bins],
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            sum: 0.0,
            count: 0,
        }
    }

    fn add(&mut self, value: f64) {
        let bins = self.bins.len();
        let at = (value - self.low) / (self.high - self.low) * bins as f64;
        // A cast saturates, so whatever lies below falls into bin 0.
        self.bins[(at as usize).min(bins - 1)] += 1;
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        self.sum += value;
        self.count += 1;
    }

    /// Mean of all values; NaN without any.
    pub fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }

    /// The value below which the fraction `q` of all lies, to a bin's width; exact at 0 and 1.
    pub fn quantile(&self, q: f64) -> f64 {
        let wanted = q * self.count as f64;
        if self.count == 0 || wanted <= 0.0 {
            return self.min;
        }
        let width = (self.high - self.low) / self.bins.len() as f64;
        let mut below = 0.0;
        for (k, &n) in self.bins.iter().enumerate() {
            let n = n as f64;
            if n > 0.0 && below + n >= wanted {
                let value = self.low + (k as f64 + (wanted - below) / n) * width;
                return value.clamp(self.min, self.max);
            }
            below += n;
        }
        self.max
    }

    /// The fraction of values below `limit`, to a bin's width.
    pub fn share_below(&self, limit: f64) -> f64 {
        let bins = self.bins.len() as f64;
        let upto = (limit - self.low) / (self.high - self.low) * bins;
        let upto = (upto.round().max(0.0) as usize).min(self.bins.len());
        self.bins[..upto].iter().sum::<u64>() as f64 / self.count.max(1) as f64
    }
}

/// A cell worth looking at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Its corners, projected metres.
    pub corners_m: [Xy; 4],
    /// Its scaled Jacobian.
    pub scaled_jacobian: f64,
    /// Its hydraulic size, metres.
    pub hydraulic_m: f64,
    /// Its sub-domain.
    pub subdomain: u32,
    /// How its patch was made, as in `Method`.
    pub method: u8,
}

impl Place {
    /// The middle of the cell, projected metres.
    pub fn centre_m(&self) -> Xy {
        [0, 1].map(|k| 0.25 * self.corners_m.iter().map(|p| p[k]).sum::<f64>())
    }
}

/// What one method made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MethodShare {
    /// Sub-domains.
    pub subdomains: u64,
    /// Quads.
    pub quads: u64,
    /// Area, m².
    pub area_m2: f64,
    /// Sum of the scaled Jacobians.
    pub scaled_jacobian_sum: f64,
    /// Least scaled Jacobian; infinite without quads.
    pub scaled_jacobian_min: f64,
}

/// What the last resort made, in patches of its own and in holes of others.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LastResortShare {
    /// Sub-domains with at least one quad of it.
    pub subdomains: u64,
    /// Quads.
    pub quads: u64,
}

/// How many of the worst places are kept.
pub const WORST: usize = 20;

/// The quality of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// Scaled Jacobian of each cell; bins of 0.001.
    pub scaled_jacobian: Histogram,
    /// All corner angles, degrees; bins of half a degree.
    pub angle_deg: Histogram,
    /// Length of each edge over the size wished in its sub-domain; bins of 0.005. An edge between
    /// two sub-domains counts half with each.
    pub edge_over_size: Histogram,
    /// The same for edges between two nodes inside patches alone: open ground, no line near.
    pub edge_open_over_size: Histogram,
    /// Of these, edges beside no cell that touches a line: at least a row away.
    pub edge_far_over_size: Histogram,
    /// Scaled Jacobian of the cells within two rows of a seam, rungs apart; bins of 0.001.
    pub seam_scaled_jacobian: Histogram,
    /// The same of all other cells of their patches.
    pub off_seam_scaled_jacobian: Histogram,
    /// Hydraulic size (4 area / perimeter) of each cell over the size wished; bins of 0.001.
    pub hydraulic_over_size: Histogram,
    /// Hydraulic size of each cell, metres, least only (bins are relative to the default size).
    pub hydraulic_min_m: f64,
    /// Area of all cells, m².
    pub area_m2: f64,
    /// Area of each cell over the size wished squared, summed: the quads that were asked for.
    pub quads_wished: f64,
    /// Interior nodes of the mesh (not on its outline) by number of cells around them; the last
    /// entry stands for 15 and more.
    pub valence: [u64; 16],
    /// The same for those that are on no line: inside patches and on seams.
    pub valence_free: [u64; 16],
    /// By method, as in `Method`.
    pub methods: [MethodShare; 5],
    /// The last resort, wherever it was needed.
    pub last_resort: LastResortShare,
    /// Cells of the largest patch, and its sub-domain.
    pub largest_patch: (u64, u32),
    /// The cells of least scaled Jacobian, worst first.
    pub worst: Vec<Place>,
    /// The cells of least hydraulic size: they set an explicit time step.
    pub smallest: Vec<Place>,
}

impl Quality {
    /// Share of interior nodes with other than four cells.
    pub fn irregular(&self) -> f64 {
        share_irregular(&self.valence)
    }

    /// The same over nodes that are on no line.
    pub fn irregular_free(&self) -> f64 {
        share_irregular(&self.valence_free)
    }
}

fn share_irregular(valence: &[u64; 16]) -> f64 {
    let all: u64 = valence.iter().sum();
    (all - valence[4]) as f64 / all.max(1) as f64
}

/// The measures of [`geometry::quad`](crate::geometry::quad) for one cell, all from one set of side
/// lengths: roots are most of the cost of a check.
struct Shape {
    sides_m: [f64; 4],
    area_m2: f64,
    scaled_jacobian: f64,
    hydraulic_m: f64,
}

impl Shape {
    fn of(corners: &[Xy; 4]) -> Shape {
        let sides_m = std::array::from_fn(|k| {
            let (p, q) = (corners[k], corners[(k + 1) % 4]);
            let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
            (dx * dx + dy * dy).sqrt()
        });
        let mut scaled_jacobian = 1.0_f64;
        for (k, jacobian) in corner_jacobians(corners).into_iter().enumerate() {
            let scale: f64 = sides_m[k] * sides_m[(k + 3) % 4];
            let sine = if scale > 0.0 { jacobian / scale } else { 0.0 };
            scaled_jacobian = scaled_jacobian.min(sine);
        }
        let area_m2 = area(corners);
        let perimeter: f64 = sides_m.iter().sum();
        let hydraulic_m = if perimeter > 0.0 {
            4.0 * area_m2.abs() / perimeter
        } else {
            0.0
        };
        Shape {
            sides_m,
            area_m2,
            scaled_jacobian,
            hydraulic_m,
        }
    }
}

/// Quality in the making: patches are added one by one.
pub(crate) struct Measuring<'a> {
    frame: FrameView<'a>,
    origin_m: Xy,
    quality: Quality,
    /// Cells around each boundary node so far.
    around: Vec<u8>,
    /// The same for the nodes of the patch at hand.
    inside: Vec<u8>,
    seam_rows: SeamRows,
    pub area_m2: f64,
}

impl<'a> Measuring<'a> {
    pub fn new(frame: FrameView<'a>, origin_m: Xy) -> Measuring<'a> {
        let empty = MethodShare {
            scaled_jacobian_min: f64::INFINITY,
            ..MethodShare::default()
        };
        Measuring {
            frame,
            origin_m,
            quality: Quality {
                scaled_jacobian: Histogram::new(-1.0, 1.0, 2000),
                angle_deg: Histogram::new(0.0, 360.0, 720),
                edge_over_size: Histogram::new(0.0, 4.0, 800),
                edge_open_over_size: Histogram::new(0.0, 4.0, 800),
                edge_far_over_size: Histogram::new(0.0, 4.0, 800),
                seam_scaled_jacobian: Histogram::new(-1.0, 1.0, 2000),
                off_seam_scaled_jacobian: Histogram::new(-1.0, 1.0, 2000),
                hydraulic_over_size: Histogram::new(0.0, 2.0, 2000),
                hydraulic_min_m: f64::INFINITY,
                area_m2: 0.0,
                quads_wished: 0.0,
                valence: [0; 16],
                valence_free: [0; 16],
                methods: [empty; 5],
                last_resort: LastResortShare::default(),
                largest_patch: (0, OUTSIDE),
                worst: Vec::new(),
                smallest: Vec::new(),
            },
            around: vec![0; frame.nodes.len()],
            inside: Vec::new(),
            seam_rows: SeamRows::of(&frame),
            area_m2: 0.0,
        }
    }

    /// Adds a patch whose cells all name nodes of it.
    pub fn add(&mut self, patch: &PatchView, places: &[Xy]) {
        let size_m = self.frame.size_m[patch.subdomain as usize];
        self.inside.clear();
        self.inside.resize(patch.nodes(), 0);
        let mut on_line = vec![true; patch.boundary.len()];
        on_line.resize(patch.nodes(), false);
        let beside = a_row_on(patch, &on_line);
        let near_seams = self.seam_rows.near(patch);
        let mut share = self.quality.methods[usize::from(patch.method).min(4)];
        for quad in patch.quads {
            let corners = quad.map(|node| places[node as usize]);
            for &node in quad {
                let around = &mut self.inside[node as usize];
                *around = around.saturating_add(1);
            }
            let shape = Shape::of(&corners);
            self.measure(&corners, &shape, size_m);
            if let Some(near) = &near_seams {
                let near = quad.iter().any(|&node| near[node as usize]);
                let cells = match near {
                    true => &mut self.quality.seam_scaled_jacobian,
                    false => &mut self.quality.off_seam_scaled_jacobian,
                };
                cells.add(shape.scaled_jacobian);
            }
            let is_open = quad.map(|node| node as usize >= patch.boundary.len());
            for k in (0..4).filter(|&k| is_open[k] && is_open[(k + 1) % 4]) {
                let length = shape.sides_m[k];
                self.quality.edge_open_over_size.add(length / size_m);
                if quad.iter().all(|&node| !beside[node as usize]) {
                    self.quality.edge_far_over_size.add(length / size_m);
                }
            }
            share.area_m2 += shape.area_m2;
            share.scaled_jacobian_sum += shape.scaled_jacobian;
            share.scaled_jacobian_min = share.scaled_jacobian_min.min(shape.scaled_jacobian);
            self.keep_worst(&corners, &shape, patch);
        }
        share.subdomains += 1;
        share.quads += patch.quads.len() as u64;
        let method = usize::from(patch.method).min(4);
        self.area_m2 += share.area_m2 - self.quality.methods[method].area_m2;
        self.quality.methods[method] = share;
        let last_resort = &mut self.quality.last_resort;
        last_resort.subdomains += u64::from(patch.last_resort_quads > 0);
        last_resort.quads += u64::from(patch.last_resort_quads);
        let cells = patch.quads.len() as u64;
        if cells > self.quality.largest_patch.0 {
            self.quality.largest_patch = (cells, patch.subdomain);
        }
        let (boundary, interior) = self.inside.split_at(patch.boundary.len());
        for &around in interior {
            self.quality.valence[usize::from(around.min(15))] += 1;
            self.quality.valence_free[usize::from(around.min(15))] += 1;
        }
        for (&id, &around) in patch.boundary.iter().zip(boundary) {
            let sum = &mut self.around[id as usize];
            *sum = sum.saturating_add(around);
        }
    }

    fn measure(&mut self, corners: &[Xy; 4], shape: &Shape, size_m: f64) {
        let quality = &mut self.quality;
        quality.scaled_jacobian.add(shape.scaled_jacobian);
        quality.hydraulic_over_size.add(shape.hydraulic_m / size_m);
        quality.hydraulic_min_m = quality.hydraulic_min_m.min(shape.hydraulic_m);
        quality.quads_wished += shape.area_m2 / (size_m * size_m);
        for angle in corner_angles_deg(corners) {
            quality.angle_deg.add(angle);
        }
        // Each side once a cell: an inner edge comes twice, one on the outline is added again later.
        for length in shape.sides_m {
            quality.edge_over_size.add(length / size_m);
        }
    }

    fn keep_worst(&mut self, corners: &[Xy; 4], shape: &Shape, patch: &PatchView) {
        let o = self.origin_m;
        let place = || Place {
            corners_m: corners.map(|p| [p[0] + o[0], p[1] + o[1]]),
            scaled_jacobian: shape.scaled_jacobian,
            hydraulic_m: shape.hydraulic_m,
            subdomain: patch.subdomain,
            method: patch.method,
        };
        let (worst, smallest) = (&mut self.quality.worst, &mut self.quality.smallest);
        keep(worst, |it| it.scaled_jacobian, shape.scaled_jacobian, place);
        keep(smallest, |it| it.hydraulic_m, shape.hydraulic_m, place);
    }

    /// What can only be said when all patches were added.
    pub fn finished(mut self) -> Quality {
        let frame = self.frame;
        let mut on_rim = vec![false; frame.nodes.len()];
        let mut on_line = vec![false; frame.nodes.len()];
        for curve in 0..frame.curves() {
            let (left, right) = (frame.left[curve], frame.right[curve]);
            for &node in frame.nodes_of(curve) {
                on_rim[node as usize] |= left == OUTSIDE || right == OUTSIDE;
                on_line[node as usize] |= !frame.is_seam(curve);
            }
            let side = if left == OUTSIDE { right } else { left };
            if (left == OUTSIDE) != (right == OUTSIDE) {
                let size_m = frame.size_m[side as usize];
                for pair in frame.nodes_of(curve).windows(2) {
                    let [a, b] = [pair[0], pair[1]].map(|node| frame.nodes[node as usize]);
                    self.quality.edge_over_size.add(distance(a, b) / size_m);
                }
            }
        }
        for node in (0..frame.nodes.len()).filter(|&node| !on_rim[node]) {
            let around = usize::from(self.around[node].min(15));
            self.quality.valence[around] += 1;
            self.quality.valence_free[around] += u64::from(!on_line[node]);
        }
        self.quality.area_m2 = self.area_m2;
        self.quality
    }
}

/// Puts a place into the sorted list of the least ones, if it belongs there.
fn keep(
    list: &mut Vec<Place>,
    measure: impl Fn(&Place) -> f64,
    value: f64,
    place: impl FnOnce() -> Place,
) {
    if list.len() == WORST && value >= measure(&list[WORST - 1]) {
        return;
    }
    let at = list.partition_point(|it| measure(it) <= value);
    list.insert(at, place());
    list.truncate(WORST);
}
