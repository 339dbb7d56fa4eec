//! A synthetic city as GeoJSON.

use crate::pipeline::error::Error;
use crate::synth;
use crate::synth::City;
use std::fs::File;
use std::io::BufWriter;
use std::io::Write;
use std::path::Path;

/// The plane that synthetic cities pretend to lie in: UTM zone 32 north.
const EPSG: u32 = 32632;

/// Where a synthetic city's middle lies there, metres.
const MIDDLE_M: [f64; 2] = [500_000.0, 5_000_000.0];

/// Makes a city and writes it to `out`.
pub(super) fn write(lines: usize, seed: u64, out: &Path) -> Result<City, Error> {
    if lines < synth::LEAST_LINES {
        let least = synth::LEAST_LINES;
        return Err(Error::Job(format!(
            "--lines {lines}: a city needs at least {least} lines"
        )));
    }
    let city = synth::city(lines, seed);
    let refused = |it| Error::Write(out.to_path_buf(), it);
    let mut file = BufWriter::new(File::create(out).map_err(refused)?);
    write_city(&city, &mut file)
        .and_then(|()| file.flush())
        .map_err(refused)?;
    Ok(city)
}

fn write_city(city: &City, to: &mut impl Write) -> std::io::Result<()> {
    let ring = positions(&city.boundary);
    write!(
        to,
        "{{\"type\":\"FeatureCollection\",\"crs\":{{\"type\":\"name\",\"properties\":{{\"name\":\"urn:ogc:def:crs:EPSG::{EPSG}\"}}}},\n\
         \"features\":[\n{{\"type\":\"Feature\",\"properties\":{{\"role\":\"boundary\"}},\"geometry\":{{\"type\":\"Polygon\",\"coordinates\":[{ring}]}}}}"
    )?;
    for feature in &city.features {
        write!(
            to,
            ",\n{{\"type\":\"Feature\",\"properties\":{{\"role\":\"constraint\",\"kind\":\"{}\",\"name\":\"{}\"}},\"geometry\":{{\"type\":\"LineString\",\"coordinates\":{}}}}}",
            feature.kind,
            feature.name,
            positions(&feature.points)
        )?;
    }
    writeln!(to, "\n]}}")
}

fn positions(points: &[[f64; 2]]) -> String {
    let each = points
        .iter()
        .map(|p| format!("[{:.2},{:.2}]", p[0] + MIDDLE_M[0], p[1] + MIDDLE_M[1]));
    format!("[{}]", each.collect::<Vec<_>>().join(","))
}
