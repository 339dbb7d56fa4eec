//! What is parked between phases; the journal of a run.
