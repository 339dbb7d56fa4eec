//! Arrangement + SizeWish -> Arrangement that can be meshed at that size, and the table of changes.

pub mod changes;
