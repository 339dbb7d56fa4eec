//! What a report shows, before it is a page.

/// A table with a head.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Its title.
    pub title: String,
    /// A sentence under the title, or empty.
    pub note: String,
    /// Names of the columns, with units.
    pub head: Vec<String>,
    /// Rows, each as long as the head.
    pub rows: Vec<Vec<String>>,
}

/// A histogram over bins of equal width.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Its title, with the unit.
    pub title: String,
    /// Where the first bin begins.
    pub from: f64,
    /// Where the last bin ends.
    pub to: f64,
    /// Counts, a bin each.
    pub counts: Vec<u64>,
}

/// A picture with its caption.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    /// What is shown, where, how wide.
    pub caption: String,
    /// PNG bytes.
    pub png: Vec<u8>,
}

/// A whole report.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// Its title.
    pub title: String,
    /// One line under the title: does every promise hold?
    pub verdict: String,
    /// True if it does.
    pub holds: bool,
    /// The first picture stands alone; the others side by side.
    pub plates: Vec<Plate>,
    /// Histograms, side by side.
    pub histograms: Vec<Histogram>,
    /// Tables, one under the other.
    pub tables: Vec<Table>,
}
