//! All tests in one binary, so that HiGHS is linked once. In the order of the data flow.

mod boundary;
mod check;
mod chunk;
mod cleanup;
mod cleanup_twin;
mod cli;
mod domain;
mod export;
mod geometry;
mod ingest;
mod intervals;
mod layers;
mod meshing;
mod noding;
mod parity;
mod partition;
mod pipeline;
mod report;
mod rungs;
mod seams;
mod settling;
mod spill;
mod synth;
mod tidy;
