//! Tests of `spill`.
