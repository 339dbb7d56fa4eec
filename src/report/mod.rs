//! Findings + qualities -> Report (text, json, html, pictures).
