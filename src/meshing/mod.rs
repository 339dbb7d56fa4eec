//! One sub-domain with its boundary nodes -> Patch: an all-quad mesh that keeps those nodes.

mod draft;
pub mod patch;
mod triangulate;
mod visits;
