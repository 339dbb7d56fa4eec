//! GIS files -> (Domain, Findings).

/// What the coordinates mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CrsChoice {
    /// As the file says.
    FromFile,
    /// Plane metres without a reference system.
    Local,
    /// This EPSG code, whatever the file says.
    Epsg(u32),
}
