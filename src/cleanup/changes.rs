//! The table of changes: what clean-up did to the line work, for the user to argue with.

use crate::domain::line::LineId;
use crate::geometry::point::Point;

/// Why a stretch of a line is not in the mesh any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Reason {
    /// Outside the domain (boundary or hole).
    Clipped,
    /// A free line, or an end of one, shorter than the mesh can show.
    ShortEnd,
    /// A closed loop too small to hold elements.
    SmallLoop,
    /// No place within the tolerance could be found for it.
    BeyondTolerance,
    /// Not lost, but a node now: shorter than the mesh size, and within tolerance of a node that
    /// joins what it joined.
    Shrunk,
}

impl Reason {
    /// Short stable words, in the order of the reasons.
    pub const WORDS: [&str; 5] = [
        "clipped",
        "short-end",
        "small-loop",
        "beyond-tolerance",
        "shrunk",
    ];
}

/// A stretch of a line that was dropped. What was only moved, joined or merged (all within the
/// tolerance) is counted in [`Tally`].
#[derive(Clone, Debug, PartialEq)]
pub struct Dropped {
    /// The line.
    pub line: LineId,
    /// Why.
    pub reason: Reason,
    /// Stations of the stretch, metres, `from_m < to_m`.
    pub from_m: f64,
    /// End of the stretch.
    pub to_m: f64,
}

/// Length of some stretches together, metres.
pub fn length_m<'a>(stretches: impl Iterator<Item = &'a Dropped>) -> f64 {
    // a sum of nothing would be -0.0, and be printed so
    stretches.fold(0.0, |sum, it| sum + (it.to_m - it.from_m))
}

/// One place where clean-up changed the topology: for the layer of changes.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// A short stable word: `joined-end`, `merged-nodes`, `merged-line`, `zipped`, ...
    pub what: &'static str,
    /// Where, on the grid.
    pub at: Point,
    /// How far something moved, metres.
    pub moved_m: f64,
}

/// How often each kind of change happened and how far it moved things.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// (what, how often, largest displacement in metres), sorted by `what`.
    pub rows: Vec<(&'static str, u64, f64)>,
    /// Largest displacement of any input sample from the mesh edge that represents it, metres.
    pub displacement_max_m: f64,
    /// 99 % quantile of the same, by length.
    pub displacement_p99_m: f64,
    /// The largest as a share of the wished size along each line.
    pub displacement_max_over_size: f64,
    /// 99 % quantile of that share, by length.
    pub displacement_p99_over_size: f64,
    /// Length of all lines inside the domain, metres.
    pub length_m: f64,
    /// Length dropped inside the domain ([`Reason::Clipped`] and [`Reason::Shrunk`] not counted),
    /// metres.
    pub length_dropped_m: f64,
    /// Angles between neighbouring edges at a node below [`SHARP_DEG`](crate::cleanup::SHARP_DEG),
    /// in the input and in the result.
    pub sharp_angles: [u64; 2],
}
