//! What the check found, promise by promise.

use crate::check::quality::Quality;
use crate::geometry::point::Xy;

/// One place where a promise is broken.
#[derive(Clone, Debug, PartialEq)]
pub struct Defect {
    /// What is wrong.
    pub text: String,
    /// Projected coordinates, metres, if there is a place.
    pub at_m: Option<Xy>,
}

/// How many defects of a promise are kept; the others are counted.
const KEPT: usize = 20;

/// One promise and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Promise {
    /// Its name; stable.
    pub name: &'static str,
    /// What was measured, one line.
    pub found: String,
    /// The first defects, in the order of the files.
    pub defects: Vec<Defect>,
    /// Number of defects.
    pub broken: u64,
}

impl Promise {
    pub(crate) fn new(name: &'static str) -> Promise {
        Promise {
            name,
            found: String::new(),
            defects: Vec::new(),
            broken: 0,
        }
    }

    pub(crate) fn says(&mut self, found: String) {
        self.found = found;
    }

    /// Notes a defect; `text` is only made for those that are kept.
    pub(crate) fn broken(&mut self, at_m: Option<Xy>, text: impl FnOnce() -> String) {
        self.broken += 1;
        if self.defects.len() < KEPT {
            let text = text();
            self.defects.push(Defect { text, at_m });
        }
    }

    /// True if no defect was found.
    pub fn holds(&self) -> bool {
        self.broken == 0
    }
}

/// The result of a check.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// All promises in the order of the contract page.
    pub promises: Vec<Promise>,
    /// How good the cells are.
    pub quality: Quality,
}

impl Verdict {
    /// True if every promise holds.
    pub fn holds(&self) -> bool {
        self.promises.iter().all(Promise::holds)
    }

    /// The promises that do not hold.
    pub fn broken(&self) -> impl Iterator<Item = &Promise> {
        self.promises.iter().filter(|it| !it.holds())
    }
}

/// The projected position of `local`.
pub(crate) fn projected(local: Xy, origin_m: Xy) -> Option<Xy> {
    Some([local[0] + origin_m[0], local[1] + origin_m[1]])
}
