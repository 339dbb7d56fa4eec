//! Tests of `seams`.
