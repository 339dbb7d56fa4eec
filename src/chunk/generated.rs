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
#[path = "generated/chunk_generated.rs"]
pub mod chunk;
#[rustfmt::skip]
#[path = "generated/frame_generated.rs"]
pub mod frame;
#[rustfmt::skip]
#[path = "generated/index_generated.rs"]
pub mod index;
#[rustfmt::skip]
#[path = "generated/lines_generated.rs"]
pub mod lines;
