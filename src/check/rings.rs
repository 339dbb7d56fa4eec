//! The domain from its rings: is a point inside?

use crate::chunk::views::LinesView;
use crate::geometry::point::Xy;
use crate::geometry::quad::cross;

/// Role of a ring of a boundary polygon, as stored.
pub(crate) const BOUNDARY: u8 = 1;
/// Role of a ring of a hole polygon, as stored.
pub(crate) const HOLE: u8 = 2;

/// The segments of all rings in horizontal slabs, for winding numbers.
pub(crate) struct Rings {
    low_m: f64,
    slab_m: f64,
    /// Slab -> entries, CSR.
    start: Vec<u32>,
    /// Segment and whether it is of a hole, slab by slab.
    entries: Vec<([Xy; 2], bool)>,
}

impl Rings {
    pub fn of(lines: &LinesView) -> Rings {
        let mut segments: Vec<([Xy; 2], bool)> = Vec::new();
        for line in 0..lines.lines() {
            let role = lines.role[line];
            if role == BOUNDARY || role == HOLE {
                let places: Vec<Xy> = lines.local_m(line).collect();
                let pairs = places.windows(2).map(|w| ([w[0], w[1]], role == HOLE));
                segments.extend(pairs);
            }
        }
        let ends = || segments.iter().flat_map(|(s, _)| s.iter().map(|p| p[1]));
        let low_m = ends().fold(f64::INFINITY, f64::min);
        let high_m = ends().fold(f64::NEG_INFINITY, f64::max);
        let slabs = (segments.len() / 4).clamp(1, 1 << 16);
        let slab_m = ((high_m - low_m) / slabs as f64).max(1e-3);
        let mut placed: Vec<(u32, u32)> = Vec::new();
        for (k, (s, _)) in segments.iter().enumerate() {
            let slab = |y: f64| ((y - low_m) / slab_m) as u32;
            let (from, to) = (slab(s[0][1].min(s[1][1])), slab(s[0][1].max(s[1][1])));
            placed.extend((from..=to).map(|slab| (slab, k as u32)));
        }
        placed.sort_unstable();
        let last = placed.last().map_or(0, |it| it.0);
        let start = (0..=last + 1)
            .map(|slab| placed.partition_point(|it| it.0 < slab) as u32)
            .collect();
        let entries = placed.iter().map(|&(_, k)| segments[k as usize]).collect();
        Rings {
            low_m,
            slab_m,
            start,
            entries,
        }
    }

    /// True if `p` is in a boundary polygon and in no hole polygon. Polygons lie on the left of
    /// their rings, so the winding number counts the polygons that hold `p`.
    pub fn holds(&self, p: Xy) -> bool {
        let slab = ((p[1] - self.low_m) / self.slab_m).floor();
        if slab < 0.0 || slab as usize + 1 >= self.start.len() {
            return false;
        }
        let slab = slab as usize;
        let mut winding = [0_i32; 2];
        for &([a, b], is_hole) in
            &self.entries[self.start[slab] as usize..self.start[slab + 1] as usize]
        {
            let up = a[1] <= p[1] && p[1] < b[1];
            let down = b[1] <= p[1] && p[1] < a[1];
            let side = cross(a, b, p);
            if up && side > 0.0 {
                winding[usize::from(is_hole)] += 1;
            } else if down && side < 0.0 {
                winding[usize::from(is_hole)] -= 1;
            }
        }
        winding[0] > 0 && winding[1] <= 0
    }
}
