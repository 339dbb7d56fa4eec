//! Tests of `boundary`.
