//! The line work of a domain, on the grid.

use crate::geometry::grid::Grid;
use crate::geometry::point::Point;

/// What a line is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// Element sides must lie on it.
    Constraint,
    /// A ring of a boundary polygon; the polygon lies on its left. Their union is the domain.
    Boundary,
    /// A ring of a hole polygon; the hole polygon lies on its left. Their union is cut out.
    Hole,
}

/// One line or ring, as read (on the grid, neither noded nor clipped).
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Index of the input feature that it comes from.
    pub source: u32,
    /// What it is for.
    pub role: Role,
    /// Index into [`Domain::kinds`].
    pub kind: u16,
    /// The feature's `name`, or empty.
    pub name: String,
    /// At least two points in digitised order, consecutive ones different; rings repeat the first
    /// point at the end.
    pub points: Vec<Point>,
}

/// Index of a [`Line`] in [`Domain::lines`]. Everything downstream names lines by it.
pub type LineId = u32;

/// All that is to be meshed.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    /// Metres to cells.
    pub grid: Grid,
    /// EPSG code of the projected reference system, if the input names one.
    pub epsg: Option<u32>,
    /// Names of kinds, sorted; `kinds[line.kind]`. The empty name stands for "no kind".
    pub kinds: Vec<String>,
    /// Lines and rings in the order of the input.
    pub lines: Vec<Line>,
    /// FNV-1a digest of the input's bytes as stored (compressed, if it is), 64 bits.
    pub digest: u64,
}

impl Domain {
    /// A line in words: kind, name, input feature.
    pub fn words_for(&self, id: LineId) -> String {
        let line = &self.lines[id as usize];
        let said = [
            self.kinds[usize::from(line.kind)].as_str(),
            line.name.as_str(),
        ];
        let said: Vec<&str> = said.into_iter().filter(|it| !it.is_empty()).collect();
        match line.source {
            u32::MAX => "the box around all lines".to_string(),
            source if said.is_empty() => format!("feature {source}"),
            source => format!("{} (feature {source})", said.join(" ")),
        }
    }

    /// Cumulative length at each point of line `id`, metres: `[0, .., length]`. Every stage that
    /// turns positions along a line into points uses this one, so that the bits agree.
    pub fn stations_m(&self, id: LineId) -> Vec<f64> {
        let points = &self.lines[id as usize].points;
        let mut at = 0.0;
        let mut stations = Vec::with_capacity(points.len());
        stations.push(0.0);
        for pair in points.windows(2) {
            at += pair[0].distance(pair[1]) * self.grid.cell_m;
            stations.push(at);
        }
        stations
    }
}
