//! Chunk files -> Verdict: every promise, verified from the output alone.
