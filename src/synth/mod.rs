//! A seed and a number of lines -> a realistic synthetic city.
