//! GeoJSON, one feature at a time.

use crate::ingest::error::Error;
use crate::ingest::feature::Content;
use crate::ingest::feature::Feature;
use crate::ingest::feature::take;
use serde::de::DeserializeSeed;
use serde::de::Error as _;
use serde::de::IgnoredAny;
use serde::de::MapAccess;
use serde::de::SeqAccess;
use serde::de::Visitor;
use serde_json::Map;
use serde_json::Value;
use serde_json::error::Category;
use std::fmt;
use std::io::BufReader;
use std::io::ErrorKind;
use std::io::Read;
use std::path::Path;

/// Reads a FeatureCollection, a Feature or a geometry to its end.
pub fn parse(path: &Path, bytes: Box<dyn Read>) -> Result<Content, Error> {
    let mut reader = Reader {
        path,
        content: Content::default(),
        is_inside: false,
        failure: None,
    };
    let mut json = serde_json::Deserializer::from_reader(BufReader::new(bytes));
    let parsed = Top(&mut reader)
        .deserialize(&mut json)
        .and_then(|()| json.end());
    match (reader.failure.take(), parsed) {
        (Some(failure), _) => Err(failure),
        (None, Err(error)) => Err(explain(&reader, error)),
        (None, Ok(())) => Ok(reader.content),
    }
}

/// What a failure of the JSON reader means.
fn explain(reader: &Reader, error: serde_json::Error) -> Error {
    let file = reader.path.to_path_buf();
    let features = reader.content.features;
    let reason = error.to_string();
    match (error.classify(), error.io_error_kind()) {
        (
            Category::Io,
            Some(ErrorKind::UnexpectedEof | ErrorKind::InvalidInput | ErrorKind::InvalidData),
        ) => Error::Damaged {
            file,
            features,
            reason,
        },
        (Category::Io, _) => Error::Io {
            file,
            source: error.into(),
        },
        (Category::Eof, _) if error.line() <= 1 && error.column() == 0 => Error::Empty { file },
        (Category::Eof, _) => Error::Damaged {
            file,
            features,
            reason,
        },
        _ if reader.is_inside => Error::Feature {
            file,
            feature: features,
            at: None,
            reason,
            advice: "mend or remove it",
        },
        _ => Error::NotGeoJson { file, reason },
    }
}

/// Takes features as they come; keeps the first failure, since the JSON reader carries only text.
struct Reader<'a> {
    path: &'a Path,
    content: Content,
    /// True within the array of features.
    is_inside: bool,
    failure: Option<Error>,
}

impl Reader<'_> {
    fn take<E: serde::de::Error>(&mut self, feature: Feature) -> Result<(), E> {
        take(self.path, feature, &mut self.content).map_err(|failure| {
            self.failure = Some(failure);
            E::custom("stopped")
        })
    }
}

/// The outermost object.
struct Top<'a, 'b>(&'a mut Reader<'b>);

impl<'de> DeserializeSeed<'de> for Top<'_, '_> {
    type Value = ();

    fn deserialize<D: serde::Deserializer<'de>>(self, json: D) -> Result<(), D::Error> {
        json.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Top<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a GeoJSON object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let reader = self.0;
        let mut rest = Map::new();
        let mut has_features = false;
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "features" => {
                    map.next_value_seed(Features(&mut *reader))?;
                    has_features = true;
                }
                "polder_left" => reader.content.left = map.next_value()?,
                "crs" => reader.content.crs = Some(map.next_value()?),
                "type" | "geometry" | "properties" | "coordinates" | "geometries" => {
                    rest.insert(key, map.next_value()?);
                }
                _ => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
        }
        match rest.get("type").and_then(Value::as_str) {
            Some("FeatureCollection") if has_features => Ok(()),
            Some("FeatureCollection") => Err(A::Error::custom("it has no `features`")),
            Some("Feature") => take_bare(reader, rest, serde_json::from_value),
            Some(_) => take_bare(reader, rest, |value| {
                serde_json::from_value(value).map(Feature::from_geometry)
            }),
            None => Err(A::Error::custom("the outermost object has no `type`")),
        }
    }
}

/// A file that is a single Feature or geometry.
fn take_bare<E: serde::de::Error>(
    reader: &mut Reader,
    rest: Map<String, Value>,
    feature: impl FnOnce(Value) -> Result<Feature, serde_json::Error>,
) -> Result<(), E> {
    reader.take(feature(Value::Object(rest)).map_err(E::custom)?)
}

/// The array of features.
struct Features<'a, 'b>(&'a mut Reader<'b>);

impl<'de> DeserializeSeed<'de> for Features<'_, '_> {
    type Value = ();

    fn deserialize<D: serde::Deserializer<'de>>(self, json: D) -> Result<(), D::Error> {
        json.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Features<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an array of features")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        self.0.is_inside = true;
        while let Some(feature) = seq.next_element::<Feature>()? {
            self.0.take(feature)?;
        }
        self.0.is_inside = false;
        Ok(())
    }
}
