//! What `tools/flatc` makes of `schemas/`; not edited by hand.
#![allow(
    clippy::all,
    dead_code,
    missing_docs,
    unused_imports,
    mismatched_lifetime_syntaxes,
    unsafe_op_in_unsafe_fn
)]

#[rustfmt::skip]
pub mod chunk;
#[rustfmt::skip]
pub mod frame;
#[rustfmt::skip]
pub mod index;
#[rustfmt::skip]
pub mod lines;
