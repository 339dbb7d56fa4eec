//! How large elements shall be.

/// The wished edge length and rows, by kind of line.
#[derive(Clone, Debug, PartialEq)]
pub struct SizeWish {
    /// Wished edge length where nothing else is said, metres.
    pub default_m: f64,
    /// Wished edge length along lines of each kind, metres; as long as
    /// [`Domain::kinds`](crate::domain::line::Domain::kinds).
    pub by_kind_m: Vec<f64>,
    /// Rows of quads wished in narrow places beside lines of each kind, 1 or more.
    pub rows_by_kind: Vec<u32>,
}

impl SizeWish {
    /// One size everywhere.
    pub fn uniform(size_m: f64, kinds: usize) -> SizeWish {
        SizeWish {
            default_m: size_m,
            by_kind_m: vec![size_m; kinds],
            rows_by_kind: vec![1; kinds],
        }
    }
}
