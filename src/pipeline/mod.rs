//! Job -> Outcome: the phases, the threads, the queues, the progress. The one home of concurrency.

pub mod job;
pub mod ordered;
pub mod progress;
