//! Partition + SizeWish -> Goals: wished real counts, bounds and costs, a curve each.

pub mod goals;
