//! What two patches share: boundary nodes, curves, pieces, sub-domains, the certificate.

use crate::geometry::point::Xy;
use crate::intervals::goals::Goals;
use crate::noding::arrangement::Piece;
use crate::partition::subdomains::Subdomain;
use crate::partition::subdomains::SubdomainId;

/// Proof of how good the interval counts are; see `schemas/frame.fbs`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Certificate {
    /// Cost of the counts.
    pub objective: f64,
    /// Cost if each curve took its own cheapest count.
    pub base: f64,
    /// Lower bound of the cost of any counts that make every sub-domain even, as claimed.
    pub bound: f64,
    /// Odd sets of sub-domains with the dual (>= 0) of each.
    pub odd_sets: Vec<(Vec<SubdomainId>, f64)>,
}

/// The frame of a mesh, with all its nodes on curves.
///
/// Global ids of boundary nodes are their rows in `nodes`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Boundary nodes, local metres.
    pub nodes: Vec<Xy>,
    /// How many of them (the first ones) are nodes of the cleaned arrangement; the others were
    /// placed between them.
    pub fixed_nodes: u32,
    /// `curve_nodes[curve_start[c]..curve_start[c + 1]]` are the nodes of curve `c` in order, both
    /// ends included.
    pub curve_start: Vec<u32>,
    /// Node ids, curve by curve.
    pub curve_nodes: Vec<u32>,
    /// Sub-domain on the left of each curve.
    pub left: Vec<SubdomainId>,
    /// Sub-domain on the right of each curve.
    pub right: Vec<SubdomainId>,
    /// True for curves that were added to cut a large sub-domain.
    pub is_seam: Vec<bool>,
    /// `pieces[piece_start[e]..piece_start[e + 1]]` are the pieces of edge `e`, where edge `k` of
    /// curve `c` is `e = curve_start[c] - c + k`. Stations run in the direction of the curve.
    pub piece_start: Vec<u32>,
    /// Pieces, edge by edge.
    pub pieces: Vec<Piece>,
    /// The sub-domains with their walks over these curves.
    pub subdomains: Vec<Subdomain>,
    /// Wished edge length inside each sub-domain, metres.
    pub size_m: Vec<f64>,
    /// What the sizes wished of each curve.
    pub goals: Goals,
    /// How good the counts are.
    pub certificate: Option<Certificate>,
}
