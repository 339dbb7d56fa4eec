#![doc = include_str!("README.md")]

/// Points, exact predicates, the integer grid, quad shape.
pub mod geometry;

/// What is to be meshed: lines, kinds, size wish; findings.
pub mod domain;

/// Seed, number of lines -> a realistic synthetic city.
pub mod synth;

/// GIS files -> (Domain, Findings).
pub mod ingest;

/// Domain, tile by tile -> Arrangement.
pub mod noding;

/// Arrangement + SizeWish -> Arrangement, Changes.
pub mod cleanup;

/// Arrangement -> Partition: curves, sub-domains, free lines, nesting.
pub mod partition;

/// Partition + SizeWish -> Arrangement with large sub-domains cut into parts.
pub mod seams;

/// Partition + SizeWish -> Arrangement with rungs across narrow places.
pub mod rungs;

/// Partition + SizeWish -> Goals: real counts, bounds, costs.
pub mod intervals;

/// Partition + Goals -> Counts: the one global integer linear programme.
pub mod parity;

/// One curve + count -> its nodes, the same from both sides.
pub mod boundary;

/// One sub-domain -> (Patch, Method).
pub mod meshing;

/// Trial meshes + Arrangement -> Arrangement whose nodes lie where elements are better.
pub mod settling;

/// What is parked between phases; the journal of a run.
pub mod spill;

/// Patch <-> chunk file.
pub mod chunk;

/// Chunk files -> Verdict: every promise, from the output alone.
pub mod check;

/// Chunk files -> solver formats.
pub mod export;

/// Findings + qualities -> Report (text, json, html, pictures).
pub mod report;

/// Job -> Outcome: phases, threads, queues, progress.
pub mod pipeline;

/// Words -> Args -> Job; the only module that prints.
pub mod cli;
