//! Points, exact predicates, the integer grid and the shape of a quad.
//!
//! Everything up to `boundary` is **integer grid points**
//! ([`Point`](crate::geometry::point::Point), i32): orientation is exact in i64, crossings round
//! exactly in i128, so the same input gives the same bits in any tile and in any order. From
//! `boundary` on, positions are [`Xy`](crate::geometry::point::Xy): f64 metres relative to the
//! grid's origin.

pub mod crossing;
pub mod grid;
pub mod point;
pub mod predicates;
pub mod quad;
pub mod turns;
pub mod window;
