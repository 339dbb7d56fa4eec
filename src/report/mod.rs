//! Figures, tables and pictures -> one self-contained page.
//!
//! Pure: what to show comes in as a [`page::Page`], what to draw cell by cell goes into a
//! [`picture::Picture`]; out come a string and PNG bytes. Nothing is fetched when the page is
//! opened: pictures are embedded, histograms are inline SVG.
//!
//! # Cost
//! A picture costs what it shows: cells below a pixel and a half are one dot each. The page holds
//! its pictures as base64, about 4/3 of their bytes.

pub mod html;
pub mod page;
pub mod picture;
