//! A walk laid on a square lattice: each of its edges is one of the lattice.

use crate::geometry::point::Xy;
use crate::geometry::turns::quarter_turns;
use crate::meshing::visits::Visits;

/// Unit steps of the four directions.
pub(crate) const STEP: [[i32; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];

/// The walks on the lattice, each from [0, 0] on; `None` if one is no polygon there.
pub(crate) fn courses(visits: &Visits) -> Option<Vec<Course>> {
    (0..visits.walk_start.len() - 1)
        .map(|walk| Course::of(visits, walk))
        .collect()
}

/// A walk on the lattice.
pub(crate) struct Course {
    pub visits: std::ops::Range<usize>,
    /// Direction of the edge from each visit on.
    pub direction: Vec<usize>,
    /// Places of the visits.
    pub at: Vec<[i32; 2]>,
    /// Where the last edge ends: [0, 0] if the walk closes.
    pub end: [i32; 2],
}

impl Course {
    fn of(visits: &Visits, walk: usize) -> Option<Course> {
        let range = visits.walk_start[walk]..visits.walk_start[walk + 1];
        let turn_deg = |visit| 180.0 - visits.angle(visit).to_degrees();
        let turns_deg: Vec<f64> = range.clone().map(turn_deg).collect();
        let quarters = quarter_turns(&turns_deg, if walk == 0 { 4 } else { -4 })?;
        let mut direction = Vec::with_capacity(quarters.len());
        let mut ahead = 0;
        for (k, &quarter) in quarters.iter().enumerate() {
            if k > 0 {
                ahead = (ahead + i32::from(quarter)).rem_euclid(4);
            }
            direction.push(ahead as usize);
        }
        Some(Course::along(range.start as usize, direction))
    }

    /// The walk from `first` on that goes in these directions.
    pub fn along(first: usize, direction: Vec<usize>) -> Course {
        let mut at = Vec::with_capacity(direction.len());
        let mut end = [0, 0];
        for &ahead in &direction {
            at.push(end);
            end = plus(end, STEP[ahead]);
        }
        let visits = first..first + direction.len();
        Course {
            visits,
            direction,
            at,
            end,
        }
    }

    /// True if the walk ends where it starts.
    pub fn is_closed(&self) -> bool {
        self.end == [0, 0]
    }

    /// Where direction 0 points on average, radians.
    pub fn axis_rad(&self, visits: &Visits) -> f64 {
        let mut sum = [0.0, 0.0];
        for (visit, &direction) in self.visits.clone().zip(&self.direction) {
            let [a, b] =
                [visit as u32, visits.next(visit as u32)].map(|it| visits.nodes[it as usize]);
            let along = turned([b[0] - a[0], b[1] - a[1]], 4 - direction);
            sum = [sum[0] + along[0], sum[1] + along[1]];
        }
        f64::atan2(sum[1], sum[0])
    }

    /// Turns the walk counter-clockwise by quarters.
    pub fn turn(&mut self, quarters: usize) {
        for direction in &mut self.direction {
            *direction = (*direction + quarters) % 4;
        }
        for at in &mut self.at {
            for _ in 0..quarters {
                *at = [-at[1], at[0]];
            }
        }
    }
}

/// `a` + `b`.
pub(crate) fn plus(a: [i32; 2], b: [i32; 2]) -> [i32; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// `a` - `b`.
pub(crate) fn minus(a: [i32; 2], b: [i32; 2]) -> [i32; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn turned(v: Xy, quarters: usize) -> Xy {
    match quarters % 4 {
        0 => v,
        1 => [-v[1], v[0]],
        2 => [-v[0], -v[1]],
        _ => [v[1], -v[0]],
    }
}
