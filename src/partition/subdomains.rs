//! The partition: curves, half-curves and the sub-domains that they bound.

/// Index of a sub-domain; [`OUTSIDE`] is everything that is not meshed.
pub type SubdomainId = u32;

/// The outside of the domain.
pub const OUTSIDE: SubdomainId = u32::MAX;

/// A curve and a direction along it: `curve << 1 | reversed`. The sub-domain in question lies on
/// its left.
pub type HalfCurve = u32;

/// A maximal chain of edges between junctions.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Its nodes in order (indices into `Arrangement::points`), at least two; equal first and last
    /// for a closed curve. **Each of them becomes a mesh node.**
    pub nodes: Vec<u32>,
    /// Its edges in order (indices into `Arrangement::edges`), one fewer than nodes.
    pub edges: Vec<u32>,
    /// Sub-domain on the left of the chain.
    pub left: SubdomainId,
    /// Sub-domain on the right; equal to `left` for a free line.
    pub right: SubdomainId,
    /// True if it was added to cut a large sub-domain (its edges have no pieces).
    pub is_seam: bool,
}

/// A face of the arrangement inside the domain.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Subdomain {
    /// Outer walk first, then inner walks (holes, islands, free lines and trees not attached to the
    /// outer walk), each a closed sequence of half-curves with this sub-domain on the left. Outer
    /// walks run counter-clockwise, inner ones clockwise. A free line occurs in both directions.
    pub walks: Vec<Vec<HalfCurve>>,
    /// Area, m².
    pub area_m2: f64,
}

/// The faces of the arrangement and the curves between them.
///
/// Invariants (`partition::check`): each half-curve occurs in exactly one walk, or its side is
/// `OUTSIDE`; Euler's formula holds; areas sum to the domain's. Curves are numbered by their least
/// edge, sub-domains by their least half-curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Partition {
    /// All curves.
    pub curves: Vec<Curve>,
    /// All sub-domains.
    pub subdomains: Vec<Subdomain>,
}
