//! What a user may ask of clean-up for lines of one kind.

use crate::cleanup::Options;
use crate::domain::size::SizeWish;

/// What becomes of closed lines that are too small to hold elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SmallLoops {
    /// They may be closed or dropped.
    Collapse,
    /// They stay loops: their interior may shrink or grow within the tolerance, but not go.
    Keep,
}

/// The rule for lines of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// How far such a line may be from its edges, metres; [`Options::tolerance`] if not given.
    pub tolerance_m: Option<f64>,
    /// When two lines merge, the one of higher priority stays where it is. Ties go to the longer
    /// line; the outline stays before all lines.
    pub priority: i32,
    /// What becomes of its small loops.
    pub small_loops: SmallLoops,
    /// Such a line is never moved farther than this, metres, and stays before all that are not
    /// held.
    pub hold_m: Option<f64>,
}

impl Rule {
    /// No wish.
    pub const FREE: Rule = Rule {
        tolerance_m: None,
        priority: 0,
        small_loops: SmallLoops::Collapse,
        hold_m: None,
    };
}

/// Largest priority, and least negative.
pub const PRIORITY_MAX: i32 = 100;

/// How far a line is moved that is held without saying how far, metres.
pub const HOLD_M: f64 = 0.05;

impl Options {
    /// How far lines of kind `kind` may be from their edges, metres.
    pub fn tolerance_m(&self, sizes: &SizeWish, kind: usize) -> f64 {
        let rule = &self.by_kind[kind];
        let usual_m = self.tolerance.at_m(sizes.by_kind_m[kind]);
        let asked_m = rule.tolerance_m.unwrap_or(usual_m);
        rule.hold_m.map_or(asked_m, |hold_m| hold_m.min(asked_m))
    }

    /// Least length of an edge along lines of kind `kind`, metres.
    pub fn min_edge_m(&self, sizes: &SizeWish, kind: usize) -> f64 {
        self.min_edge * sizes.by_kind_m[kind]
    }
}
