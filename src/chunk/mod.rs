//! Patch <-> chunk files.
