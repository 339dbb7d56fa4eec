//! Lines -> the planar arrangement: nodes, edges between them, and the pieces of lines on each edge.

pub mod arrangement;
