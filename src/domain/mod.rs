//! What is to be meshed: the line work, its kinds, the size wish; and what is wrong with it.

pub mod finding;
pub mod line;
pub mod size;
