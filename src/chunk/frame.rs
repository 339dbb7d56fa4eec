//! What two patches share: boundary nodes, curves, pieces, sub-domains, the certificate.

use crate::geometry::point::Xy;
use crate::intervals::goals::Goals;
use crate::noding::arrangement::Piece;
use crate::parity::balance::Balance;
use crate::parity::balance::Solved;
use crate::parity::balance::Structure;
use crate::parity::programme::COST_UNIT;
use crate::parity::programme::units;
use crate::partition::subdomains::Subdomain;
use crate::partition::subdomains::SubdomainId;

/// Proof of how good the interval counts are, in whole cost units; see `schemas/frame.fbs`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Certificate {
    /// One cost unit.
    pub cost_unit: f64,
    /// Cost of the counts.
    pub objective: i64,
    /// Cost if each curve took its own cheapest count.
    pub base: i64,
    /// Lower bound of the cost of any counts that make every sub-domain even.
    pub bound: i64,
    /// What HiGHS solved; costs are not in units.
    pub solved: Solved,
    /// Odd set -> the next larger set around it, or `u32::MAX`; parents precede children.
    pub set_parent: Vec<u32>,
    /// Odd set -> twice its dual, positive.
    pub set_dual2: Vec<i64>,
    /// Sub-domain -> the least set that holds it, or `u32::MAX`.
    pub set_of: Vec<u32>,
}

impl From<Balance> for Certificate {
    fn from(balance: Balance) -> Certificate {
        // Costs in a balance are whole multiples of the unit.
        Certificate {
            cost_unit: COST_UNIT,
            objective: units(balance.objective),
            base: units(balance.base),
            bound: units(balance.bound),
            solved: balance.solved,
            set_parent: balance.cuts.parent,
            set_dual2: balance.cuts.value2,
            set_of: balance.cuts.set_of,
        }
    }
}

/// Proof of cost and patterns' price together; its blocks are those of the goals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Patterns {
    /// Price of an excess of one, cost units.
    pub worth: i64,
    /// Price of all blocks, cost units.
    pub price: i64,
    /// Lower bound of cost and price of any even counts, cost units.
    pub bound: i64,
    /// What HiGHS solved of the programme that the multipliers tilt.
    pub solved: Solved,
    /// T-joins that the multipliers took.
    pub rounds: u32,
    /// Neighbourhoods that HiGHS found better counts for.
    pub improved: u32,
    /// A multiplier for each rule of each block, cost units.
    pub multipliers: Vec<i64>,
    /// Odd set -> the next larger set around it, or `u32::MAX`; parents precede children.
    pub set_parent: Vec<u32>,
    /// Odd set -> twice its dual, positive.
    pub set_dual2: Vec<i64>,
    /// Sub-domain, then second half of a block -> the least set that holds it, or `u32::MAX`.
    pub set_of: Vec<u32>,
}

impl Patterns {
    /// The proof of `made`; `None` if no patterns were wished for.
    pub fn of(made: &Structure) -> Option<Patterns> {
        (!made.multipliers.is_empty()).then(|| Patterns {
            worth: units(made.worth),
            price: units(made.price),
            bound: units(made.bound),
            solved: made.solved,
            rounds: made.rounds,
            improved: made.improved,
            multipliers: made.multipliers.clone(),
            set_parent: made.cuts.parent.clone(),
            set_dual2: made.cuts.value2.clone(),
            set_of: made.cuts.set_of.clone(),
        })
    }
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
    /// The same for patterns.
    pub patterns: Option<Patterns>,
}
