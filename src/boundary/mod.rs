//! One curve and its count -> its nodes, bit-identical from both sides.
