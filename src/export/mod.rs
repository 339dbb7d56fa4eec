//! Chunk files -> solver formats.
