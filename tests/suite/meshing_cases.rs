//! Random and named sub-domains for the tests of `meshing`.

use polder::geometry::point::Xy;
use polder::meshing::patch::Loops;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// A small generator of pseudo-random numbers (splitmix64), so that every case has a number.
pub struct Random(pub u64);

impl Random {
    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in 0..n.
    pub fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }
}

/// An L of three squares, 8 across.
pub const L: [Xy; 6] = [
    [0.0, 0.0],
    [8.0, 0.0],
    [8.0, 4.0],
    [4.0, 4.0],
    [4.0, 8.0],
    [0.0, 8.0],
];

/// Collects directed edges with the sub-domain on the left, then traces the walks.
#[derive(Default)]
pub struct Draw {
    nodes: Vec<Xy>,
    edges: Vec<(u32, u32)>,
}

impl Draw {
    fn node(&mut self, at: Xy) -> u32 {
        if let Some(old) = self.nodes.iter().position(|&p| p == at) {
            return old as u32;
        }
        self.nodes.push(at);
        self.nodes.len() as u32 - 1
    }

    /// A polyline cut into pieces of about `spacing(point)`; walked on both sides if `free`.
    pub fn line(&mut self, points: &[Xy], spacing: &dyn Fn(Xy) -> f64, free: bool) {
        for pair in points.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
            let count = (length / spacing(middle)).round().max(1.0) as usize;
            let mut from = self.node(a);
            for k in 1..=count {
                let t = k as f64 / count as f64;
                let p = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
                let to = self.node(if k == count { b } else { p });
                self.edges.push((from, to));
                if free {
                    self.edges.push((to, from));
                }
                from = to;
            }
        }
    }

    /// A closed polygon.
    pub fn ring(&mut self, points: &[Xy], spacing: &dyn Fn(Xy) -> f64) {
        let mut closed = points.to_vec();
        closed.push(points[0]);
        self.line(&closed, spacing, false);
    }

    /// Traces the walks. If their edges are odd in number, the longest one-sided edge is halved.
    pub fn loops(mut self, size_m: f64) -> Loops {
        if self.edges.len() % 2 == 1 {
            self.halve_longest();
        }
        let mut out: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for &(a, b) in &self.edges {
            out.entry(a).or_default().push(b);
        }
        let mut walks = Vec::new();
        let mut left: std::collections::BTreeSet<(u32, u32)> = self.edges.iter().copied().collect();
        while let Some(&first) = left.iter().next() {
            let mut walk = Vec::new();
            let mut edge = first;
            while left.remove(&edge) {
                walk.push(edge.0);
                edge = (edge.1, self.leftmost(edge, &out[&edge.1]));
            }
            walks.push(walk);
        }
        walks.sort_by(|a, b| self.area(b).total_cmp(&self.area(a)));
        let on_seam = walks
            .iter()
            .map(|walk: &Vec<u32>| vec![false; walk.len()])
            .collect();
        Loops {
            nodes: self.nodes,
            walks,
            size_m,
            lattice_origin: None,
            on_seam,
            across_m: Vec::new(),
        }
    }

    fn halve_longest(&mut self) {
        let length = |&(a, b): &(u32, u32)| {
            let (p, q) = (self.nodes[a as usize], self.nodes[b as usize]);
            (p[0] - q[0]).hypot(p[1] - q[1])
        };
        let single = |&&(a, b): &&(u32, u32)| !self.edges.contains(&(b, a));
        let longest = self.edges.iter().filter(single);
        let &(a, b) = longest
            .max_by(|x, y| length(x).total_cmp(&length(y)))
            .unwrap();
        let (p, q) = (self.nodes[a as usize], self.nodes[b as usize]);
        let middle = self.node([0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]);
        self.edges.retain(|&edge| edge != (a, b));
        self.edges.extend([(a, middle), (middle, b)]);
    }

    /// The edge out of the end of `edge` that comes first clockwise from its way back.
    fn leftmost(&self, (from, at): (u32, u32), ends: &[u32]) -> u32 {
        let angle = |end: u32| {
            let (p, q) = (self.nodes[at as usize], self.nodes[end as usize]);
            (q[1] - p[1]).atan2(q[0] - p[0])
        };
        let back = angle(from);
        let turn = |&end: &u32| {
            if end == from {
                TAU
            } else {
                (back - angle(end)).rem_euclid(TAU)
            }
        };
        *ends
            .iter()
            .min_by(|a, b| turn(a).total_cmp(&turn(b)))
            .unwrap()
    }

    fn area(&self, walk: &[u32]) -> f64 {
        let at = |k: usize| self.nodes[walk[k % walk.len()] as usize];
        let cross = |k: usize| at(k)[0] * at(k + 1)[1] - at(k)[1] * at(k + 1)[0];
        (0..walk.len()).map(cross).sum()
    }
}

/// A random star-shaped, mostly concave sub-domain with slits, trees, holes and free lines, one a
/// sector so that they never meet. Features may be far smaller than an edge and edges graded 1:20:
/// much harder than anything that comes out of `cleanup`.
pub fn cruel(seed: u64) -> Loops {
    let random = &mut Random(seed);
    let corners = 3 + random.below(12);
    let extent = [10.0, 20.0, 50.0, 120.0][random.below(4)];
    let grade = if random.unit() < 0.3 {
        random.between(1.0, 20.0)
    } else {
        1.0
    };
    star(random, corners, extent, grade)
}

/// The same with gaps of about an edge length or more.
pub fn fair(seed: u64) -> Loops {
    let random = &mut Random(seed);
    let corners = 3 + random.below(9);
    let extent = corners as f64 * 10.0 * random.between(0.8, 2.5);
    star(random, corners, extent, 1.0)
}

fn star(random: &mut Random, corners: usize, extent: f64, grade: f64) -> Loops {
    let size = 10.0;
    let shift = [random.between(-4e5, 4e5), random.between(-4e5, 4e5)];
    let spacing = move |p: Xy| {
        let t = ((p[0] - shift[0]) / extent + 1.0).clamp(0.0, 2.0) / 2.0;
        size / grade.powf(t)
    };
    let start = random.between(0.0, TAU);
    let roughness = random.unit();
    let ray = |angle: f64, r: f64| [shift[0] + r * angle.cos(), shift[1] + r * angle.sin()];
    let angle = |k: f64| start + TAU * k / corners as f64;
    let reach: Vec<f64> = (0..corners)
        .map(|_| extent * random.between(1.0 - 0.75 * roughness, 1.0))
        .collect();
    let corner = |k: usize| ray(angle(k as f64), reach[k]);
    let mut draw = Draw::default();
    let outline: Vec<Xy> = (0..corners).map(corner).collect();
    draw.ring(&outline, &spacing);
    if corners < 5 {
        return draw.loops(size);
    }
    for k in 0..corners {
        // The polygon holds the disc of this radius in the sector around corner k.
        let inner = reach[k]
            .min(reach[(k + 1) % corners])
            .min(reach[(k + corners - 1) % corners])
            * (std::f64::consts::PI / corners as f64).cos()
            * 0.55;
        let (from, to) = (0.35 * inner, inner);
        let a = angle(k as f64);
        let wing = 0.25 * TAU / corners as f64;
        match random.below(8) {
            0 | 1 => draw.line(&[corner(k), ray(a, from)], &spacing, true),
            2 => {
                draw.line(&[corner(k), ray(a, 0.7 * to)], &spacing, true);
                draw.line(&[ray(a, 0.7 * to), ray(a - wing, from)], &spacing, true);
                draw.line(&[ray(a, 0.7 * to), ray(a + wing, from)], &spacing, true);
            }
            3 => draw.line(&[ray(a, from), ray(a + wing, to)], &spacing, true),
            4 => {
                let half = 0.5 * (from + to);
                let hole = [
                    ray(a, from),
                    ray(a + wing, half),
                    ray(a, to),
                    ray(a - wing, half),
                ];
                draw.ring(&hole, &spacing);
            }
            5 => {
                draw.line(&[ray(a, from), ray(a, 0.7 * to)], &spacing, true);
                draw.line(&[ray(a, 0.7 * to), ray(a - wing, to)], &spacing, true);
                draw.line(&[ray(a, 0.7 * to), ray(a + wing, to)], &spacing, true);
            }
            _ => {}
        }
    }
    draw.loops(size)
}

fn even(_: Xy) -> f64 {
    10.0
}

/// Shapes that break meshers, with their names.
pub fn named() -> Vec<(&'static str, Loops)> {
    let mut cases = narrow_shapes();
    cases.extend(round_shapes());
    cases
}

fn square(s: f64) -> Vec<Xy> {
    vec![[0.0, 0.0], [s, 0.0], [s, s], [0.0, s]]
}

fn polygon(points: &[Xy]) -> Draw {
    let mut draw = Draw::default();
    draw.ring(points, &even);
    draw
}

fn with_lines(outline: &[Xy], lines: &[&[Xy]]) -> Draw {
    let mut draw = polygon(outline);
    for line in lines {
        draw.line(line, &even, true);
    }
    draw
}

/// Wedges, bands, combs, slits.
fn narrow_shapes() -> Vec<(&'static str, Loops)> {
    let mut cases = Vec::new();
    let mut add = |name: &'static str, draw: Draw| cases.push((name, draw.loops(10.0)));
    let tip = 5.0_f64.to_radians();
    add(
        "wedge of 5 degrees",
        polygon(&[[0.0, 0.0], [100.0, 0.0], [100.0, 100.0 * tip.tan()]]),
    );
    add(
        "wedge of 1 degree",
        polygon(&[[0.0, 0.0], [60.0, 0.0], [60.0, 1.05]]),
    );
    add(
        "triangle of four edges",
        polygon(&[[0.0, 0.0], [16.0, 0.0], [8.0, 9.0]]),
    );
    add(
        "thin band",
        polygon(&[[0.0, 0.0], [200.0, 0.0], [200.0, 1.0], [0.0, 1.0]]),
    );
    let mut comb = vec![[0.0, -20.0], [100.0, -20.0]];
    for k in (0..5).rev() {
        let x = 20.0 * f64::from(k);
        comb.extend([
            [x + 20.0, 60.0],
            [x + 11.0, 60.0],
            [x + 10.0, 0.0],
            [x + 9.0, 60.0],
        ]);
        comb.push([x + 1.0, 60.0]);
    }
    add("comb", polygon(&comb));
    add(
        "slit",
        with_lines(&square(60.0), &[&[[60.0, 30.0], [20.0, 30.0]]]),
    );
    let side = [
        [0.0, 0.0],
        [60.0, 0.0],
        [60.0, 3.0],
        [60.0, 60.0],
        [0.0, 60.0],
    ];
    add(
        "slit near a side",
        with_lines(&side, &[&[[60.0, 3.0], [20.0, 3.0]]]),
    );
    add(
        "isolated line of one edge",
        with_lines(&square(40.0), &[&[[15.0, 20.0], [25.0, 20.0]]]),
    );
    add(
        "line in a tight box",
        with_lines(&square(12.0), &[&[[4.0, 6.0], [8.0, 6.0]]]),
    );
    cases
}

/// Stars, rings, and single quads.
fn round_shapes() -> Vec<(&'static str, Loops)> {
    let mut cases = Vec::new();
    let mut add = |name: &'static str, draw: Draw| cases.push((name, draw.loops(10.0)));
    let rays: Vec<[Xy; 2]> = (0..24)
        .map(|k| {
            let a = TAU * f64::from(k) / 24.0;
            [[50.0, 50.0], [50.0 + 35.0 * a.cos(), 50.0 + 35.0 * a.sin()]]
        })
        .collect();
    let lines: Vec<&[Xy]> = rays.iter().map(|ray| &ray[..]).collect();
    add("star of 24 lines", with_lines(&square(100.0), &lines));
    let circle = |r: f64, n: u32, sign: f64| -> Vec<Xy> {
        let at = |k: u32| sign * TAU * f64::from(k) / f64::from(n);
        (0..n).map(|k| [r * at(k).cos(), r * at(k).sin()]).collect()
    };
    let mut annulus = Draw::default();
    annulus.ring(&circle(20.0, 17, 1.0), &|_| 100.0);
    annulus.ring(&circle(12.0, 11, -1.0), &|_| 100.0);
    add("roundabout with odd walks", annulus);
    let mut narrow = Draw::default();
    narrow.ring(&circle(20.0, 40, 1.0), &|_| 100.0);
    narrow.ring(&circle(19.0, 8, -1.0), &|_| 100.0);
    add("narrow annulus", narrow);
    let mut kissing = polygon(&square(40.0));
    kissing.ring(&[[40.0, 40.0], [30.0, 20.0], [20.0, 30.0]], &even);
    add("hole that touches a corner", kissing);
    add("one quad", polygon(&square(10.0)));
    add(
        "one bent quad",
        polygon(&[[0.0, 0.0], [10.0, 0.0], [3.0, 3.0], [0.0, 10.0]]),
    );
    add("disc", polygon(&circle(100.0, 62, 1.0)));
    cases
}
