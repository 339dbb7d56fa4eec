//! One sub-domain with its boundary nodes -> Patch: an all-quad mesh that keeps those nodes.

mod clearance;
mod core;
mod core_quads;
mod corridor;
mod draft;
mod join;
mod lattice;
mod pairing;
pub mod patch;
mod rows;
mod strip;
mod strip_border;
#[cfg(test)]
mod strip_tests;
mod triangulate;
mod visits;
