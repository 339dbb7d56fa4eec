//! GIS files -> (Domain, Findings).
