//! Tests of `cleanup`.
