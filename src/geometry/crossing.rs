//! Where two segments cross, rounded to the grid.
