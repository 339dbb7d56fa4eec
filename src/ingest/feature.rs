//! One feature -> lines and rings, in the file's coordinates.

use crate::domain::finding::Finding;
use crate::domain::line::Role;
use crate::geometry::point::Xy;
use crate::ingest::error::Error;
use ::geojson::Geometry;
use ::geojson::GeometryValue;
use ::geojson::Position;
use serde::Deserialize;
use serde_json::Map;
use serde_json::Value;
use std::path::Path;

/// No projected coordinate on Earth is as large, metres; what is must be a mistake.
const ABSURD_M: f64 = 1e9;

/// A feature, without the members that nobody needs.
#[derive(Deserialize)]
pub struct Feature {
    r#type: Option<String>,
    geometry: Option<Geometry>,
    properties: Option<Map<String, Value>>,
}

impl Feature {
    /// A feature of which only the geometry is known.
    pub fn from_geometry(geometry: Geometry) -> Feature {
        Feature {
            r#type: None,
            geometry: Some(geometry),
            properties: None,
        }
    }
}

/// One line or ring as the file has it.
pub struct Part {
    /// Index of the feature.
    pub feature: u32,
    /// What for.
    pub role: Role,
    /// How the points are meant.
    pub shape: Shape,
    /// The `kind` property, or empty.
    pub kind: String,
    /// The `name` property, or empty.
    pub name: String,
    /// Finite positions; of a ring at least four with equal first and last.
    pub points: Vec<Xy>,
}

/// How the points of a part are meant.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// As they come.
    Line,
    /// The outer ring of a polygon.
    Exterior,
    /// A ring around a gap of a polygon.
    Interior,
}

/// All that a file says.
#[derive(Default)]
pub struct Content {
    /// Lines and rings in order.
    pub parts: Vec<Part>,
    /// The `crs` member.
    pub crs: Option<Value>,
    /// Features seen.
    pub features: u32,
    /// Positions seen.
    pub points: u64,
    /// The `polder_left` member: the places that an earlier clean-up left as they are.
    pub left: Option<Vec<Xy>>,
    /// What was not used, by feature.
    pub findings: Vec<Finding>,
    sum: Xy,
    is_beyond_degrees: bool,
}

impl Content {
    /// True if all positions could be longitude and latitude.
    pub fn could_be_degrees(&self) -> bool {
        self.points > 0 && !self.is_beyond_degrees
    }

    /// The mean of all positions.
    pub fn mean(&self) -> Xy {
        self.sum.map(|sum| sum / self.points.max(1) as f64)
    }

    fn count(&mut self, [x, y]: Xy) {
        self.points += 1;
        self.sum = [self.sum[0] + x, self.sum[1] + y];
        self.is_beyond_degrees |= x.abs() > 180.0 || y.abs() > 90.0;
    }
}

/// What the parts of one feature have in common.
struct Labels<'a> {
    path: &'a Path,
    feature: u32,
    role: String,
    kind: String,
    name: String,
}

/// Adds the lines and rings of the next feature to `content`.
pub fn take(path: &Path, feature: Feature, content: &mut Content) -> Result<(), Error> {
    let properties = feature.properties.unwrap_or_default();
    let text = |key: &str| match properties.get(key) {
        None | Some(Value::Null) => String::new(),
        Some(Value::String(text)) => text.clone(),
        Some(other) => other.to_string(),
    };
    let labels = Labels {
        path,
        feature: content.features,
        role: text("role"),
        kind: text("kind"),
        name: text("name"),
    };
    if let Some(found) = feature.r#type.filter(|found| found != "Feature") {
        let reason = format!("its type is `{found}`, not `Feature`");
        return Err(labels.wrong(None, reason, "mend or remove it"));
    }
    content.features += 1;
    match feature.geometry {
        Some(geometry) => take_geometry(&labels, geometry.value, content),
        None => {
            labels.find(
                content,
                "no-geometry",
                "A feature without geometry was left out.",
            );
            Ok(())
        }
    }
}

impl Labels<'_> {
    fn wrong(&self, at: Option<Xy>, reason: String, advice: &'static str) -> Error {
        Error::Feature {
            file: self.path.to_path_buf(),
            feature: self.feature,
            at,
            reason,
            advice,
        }
    }

    fn find(&self, content: &mut Content, what: &'static str, text: &str) {
        content.findings.push(Finding {
            what,
            text: text.to_string(),
            feature: Some(self.feature),
            at_m: None,
        });
    }

    fn part(&self, role: Role, shape: Shape, points: Vec<Xy>) -> Part {
        Part {
            feature: self.feature,
            role,
            shape,
            kind: self.kind.clone(),
            name: self.name.clone(),
            points,
        }
    }
}

fn take_geometry(
    labels: &Labels,
    value: GeometryValue,
    content: &mut Content,
) -> Result<(), Error> {
    let before = (content.parts.len(), content.findings.len());
    match value {
        GeometryValue::LineString { coordinates } => take_line(labels, &coordinates, content)?,
        GeometryValue::MultiLineString { coordinates } => {
            for line in &coordinates {
                take_line(labels, line, content)?;
            }
        }
        GeometryValue::Polygon { coordinates } => take_polygon(labels, &coordinates, content)?,
        GeometryValue::MultiPolygon { coordinates } => {
            for polygon in &coordinates {
                take_polygon(labels, polygon, content)?;
            }
        }
        GeometryValue::GeometryCollection { geometries } => {
            for geometry in geometries {
                take_geometry(labels, geometry.value, content)?;
            }
        }
        GeometryValue::Point { .. } | GeometryValue::MultiPoint { .. } => {
            labels.find(
                content,
                "point",
                "A point was left out: only lines and polygons count.",
            );
        }
    }
    if before == (content.parts.len(), content.findings.len()) {
        labels.find(
            content,
            "empty-geometry",
            "A geometry without coordinates was left out.",
        );
    }
    Ok(())
}

fn take_line(labels: &Labels, line: &[Position], content: &mut Content) -> Result<(), Error> {
    let points = positions(labels, line, content)?;
    if matches!(labels.role.as_str(), "boundary" | "domain" | "hole") {
        labels.find(
            content,
            "line-with-polygon-role",
            "A line has the role of a polygon; it is taken as a constraint line.",
        );
    }
    if !points.is_empty() {
        content
            .parts
            .push(labels.part(Role::Constraint, Shape::Line, points));
    }
    Ok(())
}

fn take_polygon(
    labels: &Labels,
    rings: &[Vec<Position>],
    content: &mut Content,
) -> Result<(), Error> {
    let role = match labels.role.as_str() {
        "" | "boundary" | "domain" => Role::Boundary,
        "hole" => Role::Hole,
        _ => Role::Constraint,
    };
    for (index, ring) in rings.iter().enumerate() {
        let points = positions(labels, ring, content)?;
        let Some((&first, &last)) = points.first().zip(points.last()) else {
            continue;
        };
        if first != last {
            let reason = format!("ring {index} of the polygon is not closed");
            let advice = "repeat its first coordinate at the end, or make it a line";
            return Err(labels.wrong(Some(last), reason, advice));
        }
        if points.len() < 4 {
            let reason = format!("ring {index} of the polygon has {} points", points.len());
            return Err(labels.wrong(Some(first), reason, "a ring needs at least four"));
        }
        let shape = if index == 0 {
            Shape::Exterior
        } else {
            Shape::Interior
        };
        content.parts.push(labels.part(role, shape, points));
    }
    Ok(())
}

/// Drops heights; refuses what is no place on a map.
fn positions(labels: &Labels, given: &[Position], content: &mut Content) -> Result<Vec<Xy>, Error> {
    let mut points = Vec::with_capacity(given.len());
    for position in given {
        let &[x, y, ..] = position.as_slice() else {
            let reason = format!("a coordinate has {} number(s)", position.len());
            let before = points.last().copied();
            return Err(labels.wrong(before, reason, "it needs two or three"));
        };
        if !(x.abs() < ABSURD_M && y.abs() < ABSURD_M) {
            let reason = "the coordinate is not a place on Earth".to_string();
            return Err(labels.wrong(Some([x, y]), reason, "mend or remove it"));
        }
        content.count([x, y]);
        points.push([x, y]);
    }
    Ok(points)
}
