//! One sub-domain with its boundary nodes -> Patch: an all-quad mesh that keeps those nodes.

pub mod patch;
