//! Tests of `noding`.
