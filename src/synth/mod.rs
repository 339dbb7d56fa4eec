//! A seed and a number of lines -> a realistic synthetic city.
//!
//! The embedded default of the demo and the source of scale benchmarks: what real street data does
//! to a mesher, without anybody's licence. A bent street grid with merged blocks inside an ellipse,
//! avenues at angles across it, a meandering river with two banks, cul-de-sacs, isolated walls,
//! building outlines, and open country with a few roads around.
//!
//! # Promises
//! 1. Exactly `lines` constraint lines (at least [`LEAST_LINES`]) and one rectangular boundary.
//! 2. Same seed, same bytes: integers from splitmix64, no platform-dependent order.
//! 3. Lines are not noded: streets cross avenues and banks without common vertices, as in the
//!    wild.
//!
//! # Cost
//! O(lines) time and memory; a city has about 1.3 lines a block of 100 m x 80 m.

mod blocks;
mod random;
mod river;
mod streets;

use crate::geometry::point::Xy;
use crate::synth::random::Random;

/// Fewest lines that make a city.
pub const LEAST_LINES: usize = 20;

/// One feature of the city.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// `road`, `avenue`, `river`, `wall`, `building`, ...
    pub kind: &'static str,
    /// A name that says what it is.
    pub name: String,
    /// Metres; a building repeats its first point.
    pub points: Vec<Xy>,
}

/// A city: its boundary ring (counter-clockwise, closed) and its lines.
#[derive(Clone, Debug, PartialEq)]
pub struct City {
    /// The domain, metres.
    pub boundary: Vec<Xy>,
    /// Constraint lines.
    pub features: Vec<Feature>,
}

/// The shape that all parts of a city share.
struct Plan {
    /// Blocks a side.
    blocks: usize,
    /// Half the side of the square domain, metres.
    half_m: f64,
    /// Phases and amplitudes of the bends of the street grid.
    bends: [f64; 6],
}

/// Pitch of the street grid east-west and north-south, metres.
const BLOCK_M: Xy = [100.0, 80.0];

impl Plan {
    /// Where the street grid's node (i, j) lies: bent by slow waves, so that streets curve.
    fn node(&self, i: f64, j: f64) -> Xy {
        let centre = self.blocks as f64 / 2.0;
        let (x, y) = ((i - centre) * BLOCK_M[0], (j - centre) * BLOCK_M[1]);
        let wave = 9.0 * BLOCK_M[0];
        let [a, b, c, d, e, f] = self.bends;
        let bent_x = x + 45.0 * (y / wave + a).sin() + 20.0 * ((x + y) / (0.6 * wave) + b).sin();
        let bent_y = y + 40.0 * (x / wave + c).sin() + 18.0 * ((x - y) / (0.7 * wave) + d).sin();
        let turn = 0.12 * (e - 0.5) * std::f64::consts::PI + 0.1 * f;
        let (sin, cos) = turn.sin_cos();
        [bent_x * cos - bent_y * sin, bent_x * sin + bent_y * cos]
    }

    /// True if the street grid's node (i, j) is inside the built-up ellipse.
    fn is_built(&self, i: f64, j: f64) -> bool {
        let centre = self.blocks as f64 / 2.0;
        let (u, v) = ((i - centre) / centre, (j - centre) / centre);
        u * u + v * v <= 1.02
    }
}

/// Makes the city of about `lines` blocks' worth of streets and exactly `lines` lines.
pub fn city(lines: usize, seed: u64) -> City {
    let lines = lines.max(LEAST_LINES);
    let mut random = Random::new(seed);
    let blocks = ((lines as f64 / 1.05).sqrt().round() as usize).max(4);
    let half_m = 0.5 * blocks as f64 * BLOCK_M[0] * 1.25 + 150.0;
    let plan = Plan {
        blocks,
        half_m,
        bends: std::array::from_fn(|_| random.real()),
    };
    let mut features = river::banks(&plan, &mut random);
    features.extend(streets::avenues(&plan, &mut random));
    features.extend(streets::streets(&plan, &mut random));
    features.truncate(lines);
    let missing = lines - features.len();
    features.extend(blocks::details(&plan, missing, &mut random));
    for feature in &mut features {
        for point in &mut feature.points {
            *point = point.map(|it| (it * 100.0).round() / 100.0);
        }
    }
    let h = half_m.round();
    City {
        boundary: vec![[-h, -h], [h, -h], [h, h], [-h, h], [-h, -h]],
        features,
    }
}
