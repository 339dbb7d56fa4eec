//! Is it metres?

use crate::domain::finding::Finding;
use crate::ingest::CrsChoice;
use crate::ingest::error::Error;
use crate::ingest::feature::Content;
use serde_json::Value;
use std::path::Path;

/// Geographic systems (degrees) that line work comes in: WGS 84 and 72, ETRS89, NAD83, NAD27 and
/// NAD83(CSRS), GDA94 and GDA2020, NZGD2000, CGCS2000, JGD2000 and JGD2011, SIRGAS 2000, OSGB36,
/// Pulkovo 1942, ED50, RGF93, Hong Kong 1980, NAD83(HARN, 2007); last the three-dimensional ones.
const GEOGRAPHIC: [u32; 23] = [
    4326, 4322, 4258, 4269, 4267, 4617, 4283, 7844, 4167, 4490, 4612, 6668, 4674, 4277, 4284, 4230,
    4171, 4611, 4152, 4759, 4979, 4937, 4955,
];

/// What a file or a user says about the reference system.
enum Named {
    Epsg(u32),
    /// OGC:CRS84 and its kin: degrees without an EPSG code.
    Degrees,
    Unknown(String),
    Nothing,
}

/// The EPSG code to go on with, or an error if the coordinates are degrees.
pub fn decide(
    path: &Path,
    choice: CrsChoice,
    content: &Content,
    findings: &mut Vec<Finding>,
) -> Result<Option<u32>, Error> {
    let named = match choice {
        CrsChoice::Local => return Ok(None),
        CrsChoice::Epsg(code) => Named::Epsg(code),
        CrsChoice::FromFile => named(content.crs.as_ref()),
    };
    let could_be_degrees = content.could_be_degrees();
    let refuse = |reason: String| {
        Err(Error::Geographic {
            file: path.to_path_buf(),
            reason,
            fitting: could_be_degrees.then(|| utm_zone(content.mean())),
        })
    };
    match named {
        Named::Epsg(code) if GEOGRAPHIC.contains(&code) => {
            refuse(format!("EPSG:{code} is in degrees"))
        }
        // the range in which EPSG keeps geographic systems, though not only these
        Named::Epsg(code @ 4001..=4999) if could_be_degrees => refuse(format!(
            "EPSG:{code} and values within ±180, ±90 look like degrees"
        )),
        Named::Epsg(code) => Ok(Some(code)),
        Named::Degrees => refuse("CRS84 is in degrees".to_string()),
        Named::Nothing if could_be_degrees => refuse(
            "no reference system is named and all values are within ±180, ±90: degrees, by the \
             GeoJSON standard"
                .to_string(),
        ),
        Named::Nothing => {
            findings.push(assumed("no reference system is named".to_string()));
            Ok(None)
        }
        Named::Unknown(name) if could_be_degrees => refuse(format!(
            "the reference system `{name}` is not known and all values are within ±180, ±90"
        )),
        Named::Unknown(name) => {
            findings.push(assumed(format!(
                "the reference system `{name}` is not known"
            )));
            Ok(None)
        }
    }
}

fn assumed(why: String) -> Finding {
    Finding {
        what: "assumed-metres",
        text: format!("In the input {why}; its coordinates are taken as metres."),
        feature: None,
        at_m: None,
    }
}

/// Reads a `crs` member: `{"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32632"}}`,
/// or the older `{"type": "EPSG", "properties": {"code": 32632}}`.
fn named(crs: Option<&Value>) -> Named {
    let Some(crs) = crs.filter(|crs| !crs.is_null()) else {
        return Named::Nothing;
    };
    let properties = &crs["properties"];
    if let Some(code) = properties["code"].as_u64() {
        return Named::Epsg(code as u32);
    }
    let name = properties["name"].as_str().or(crs.as_str());
    let Some(name) = name else {
        return Named::Unknown(crs.to_string());
    };
    let upper = name.to_uppercase();
    if upper.contains("CRS84") || upper.contains("CRS83") || upper.contains("CRS27") {
        return Named::Degrees;
    }
    let last = upper.rsplit([':', '/', '#']).next().unwrap_or_default();
    match last.parse() {
        Ok(code) if upper.contains("EPSG") => Named::Epsg(code),
        _ => Named::Unknown(name.to_string()),
    }
}

/// EPSG code of the WGS 84 / UTM zone that holds a longitude and latitude, degrees.
fn utm_zone([longitude, latitude]: [f64; 2]) -> u32 {
    let zone = (((longitude + 180.0) / 6.0).floor() as i32 + 1).clamp(1, 60) as u32;
    if latitude < 0.0 {
        32700 + zone
    } else {
        32600 + zone
    }
}
