//! Arrangement -> Partition: curves between junctions, sub-domains with their walks, free lines.

pub mod subdomains;
