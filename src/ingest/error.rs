//! Why a file cannot be used, and what to do about it.

use crate::geometry::point::Xy;
use std::fmt;
use std::io;
use std::path::PathBuf;

/// A file that cannot be used.
#[derive(Debug)]
pub enum Error {
    /// It cannot be opened or read.
    Io {
        /// The file.
        file: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// It ends in the middle, or its compression is damaged.
    Damaged {
        /// The file.
        file: PathBuf,
        /// Features read before.
        features: u32,
        /// What the reader said.
        reason: String,
    },
    /// It holds nothing.
    Empty {
        /// The file.
        file: PathBuf,
    },
    /// It is not JSON, or not GeoJSON.
    NotGeoJson {
        /// The file.
        file: PathBuf,
        /// What is wrong, with line and column where known.
        reason: String,
    },
    /// One feature is wrong.
    Feature {
        /// The file.
        file: PathBuf,
        /// Index of the feature, from 0.
        feature: u32,
        /// Where, in the file's coordinates.
        at: Option<Xy>,
        /// What is wrong.
        reason: String,
        /// What to do.
        advice: &'static str,
    },
    /// The coordinates are degrees.
    Geographic {
        /// The file.
        file: PathBuf,
        /// How we know.
        reason: String,
        /// EPSG code of the UTM zone of the data's mean, if the values are degrees at all.
        fitting: Option<u32>,
    },
    /// Neither a polygon nor a line.
    NoLines {
        /// The file.
        file: PathBuf,
    },
    /// More kinds than a mesh can tell apart.
    TooManyKinds {
        /// The file.
        file: PathBuf,
        /// How many.
        kinds: usize,
    },
    /// The data do not fit the integer grid.
    TooWide {
        /// The file.
        file: PathBuf,
        /// Lowest and highest coordinates, metres.
        bounds_m: [Xy; 2],
        /// A cell that would do, metres.
        cell_needed_m: f64,
    },
}

impl Error {
    /// True if the world refused (permission, disk); false if the input is bad.
    pub fn is_world(&self) -> bool {
        let Error::Io { source, .. } = self else {
            return false;
        };
        !matches!(
            source.kind(),
            io::ErrorKind::NotFound | io::ErrorKind::IsADirectory | io::ErrorKind::NotADirectory
        )
    }
}

impl std::error::Error for Error {}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Io { file, source } => {
                write!(f, "{}: cannot be read: {source}", file.display())
            }
            Error::Damaged {
                file,
                features,
                reason,
            } => write!(
                f,
                "{}: ends in the middle, after {features} features ({reason}); fetch or write it \
                 again",
                file.display()
            ),
            Error::Empty { file } => {
                write!(f, "{}: is empty; a GeoJSON file is needed", file.display())
            }
            Error::NotGeoJson { file, reason } => write!(
                f,
                "{}: is not GeoJSON: {reason}; export the layer as a GeoJSON FeatureCollection",
                file.display()
            ),
            Error::Feature {
                file,
                feature,
                at,
                reason,
                advice,
            } => {
                write!(f, "{}: feature {feature}", file.display())?;
                if let Some([x, y]) = at {
                    write!(f, " at ({}, {})", Number(*x), Number(*y))?;
                }
                write!(f, ": {reason}; {advice}")
            }
            Error::Geographic {
                file,
                reason,
                fitting,
            } => write_geographic(f, file, reason, *fitting),
            Error::NoLines { file } => write!(
                f,
                "{}: has neither polygons nor lines; at least a boundary polygon is needed",
                file.display()
            ),
            Error::TooManyKinds { file, kinds } => write!(
                f,
                "{}: the property `kind` has {kinds} values, at most 65535 are possible; put what \
                 is special to a feature into `name`",
                file.display()
            ),
            Error::TooWide {
                file,
                bounds_m: [low, high],
                cell_needed_m,
            } => write!(
                f,
                "{}: spans ({}, {}) to ({}, {}), too wide for the grid; use a cell of at least \
                 {cell_needed_m} m, or look for a stray coordinate",
                file.display(),
                low[0],
                low[1],
                high[0],
                high[1]
            ),
        }
    }
}

/// A coordinate; one that is not a place on Earth in scientific notation.
struct Number(f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.abs() < 1e12 {
            write!(f, "{}", self.0)
        } else {
            write!(f, "{:e}", self.0)
        }
    }
}

fn write_geographic(
    f: &mut fmt::Formatter<'_>,
    file: &std::path::Path,
    reason: &str,
    fitting: Option<u32>,
) -> fmt::Result {
    write!(f, "{}: {reason}; meshing needs metres: ", file.display())?;
    match fitting {
        Some(epsg) => write!(
            f,
            "reproject, for example to EPSG:{epsg} (ogr2ogr -t_srs EPSG:{epsg} out.geojson {}), \
             or say that the coordinates are local metres",
            file.display()
        ),
        None => write!(
            f,
            "the values are beyond ±180, ±90, so the reference system that the file names is \
             wrong: name the right one"
        ),
    }
}
