//! One sub-domain with its boundary nodes -> Patch: an all-quad mesh that keeps those nodes.

mod bridges;
mod closures;
mod contour;
mod draft;
mod looping;
mod mapping;
pub mod patch;
mod patterns;
mod sheet;
mod splitting;
mod visits;
