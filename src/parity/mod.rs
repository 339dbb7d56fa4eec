//! Goals -> Counts: the one global integer linear programme that makes every sub-domain even.
