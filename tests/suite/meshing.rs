//! Tests of `meshing`.
