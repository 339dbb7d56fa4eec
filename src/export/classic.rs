//! The header of a classic NetCDF file (CDF-2 or CDF-5), and where each variable begins.
//!
//! After the "NetCDF Classic Format Specification" of Unidata: big-endian, names and values padded
//! to four bytes, variables one after the other in the order of the header. CDF-5 differs in that
//! counts have eight bytes.

/// Type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Type {
    Byte = 1,
    Int = 4,
    Double = 6,
}

impl Type {
    fn bytes(self) -> u64 {
        match self {
            Type::Byte => 1,
            Type::Int => 4,
            Type::Double => 8,
        }
    }
}

/// Value of an attribute.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Text(String),
    Int(i32),
    Double(f64),
    Bytes(Vec<u8>),
}

/// An attribute of text.
pub(crate) fn text(name: &'static str, value: &str) -> (&'static str, Value) {
    (name, Value::Text(value.to_string()))
}

/// A variable.
pub(crate) struct Variable {
    pub name: &'static str,
    pub kind: Type,
    /// Indices into the dimensions; empty for a single value.
    pub dimensions: Vec<usize>,
    pub attributes: Vec<(&'static str, Value)>,
}

/// All that a header says.
pub(crate) struct Header {
    pub dimensions: Vec<(&'static str, u64)>,
    pub attributes: Vec<(&'static str, Value)>,
    pub variables: Vec<Variable>,
}

/// A variable of CDF-2 must stay below this, bytes.
const CDF2_LARGEST: u64 = (1 << 32) - 4;

impl Header {
    /// The bytes of the header, and the place of each variable in the file.
    pub fn encode(&self) -> (Vec<u8>, Vec<u64>) {
        let wide = self
            .variables
            .iter()
            .any(|v| self.bytes_of(v) > CDF2_LARGEST)
            || self.dimensions.iter().any(|it| it.1 > i32::MAX as u64);
        // Places depend on the header's length, which does not depend on places.
        let length = self.bytes(wide, &vec![0; self.variables.len()]).len() as u64;
        let mut at = length;
        let mut places = Vec::new();
        for variable in &self.variables {
            places.push(at);
            at += self.bytes_of(variable);
        }
        (self.bytes(wide, &places), places)
    }

    /// Length of a variable with its padding.
    fn bytes_of(&self, variable: &Variable) -> u64 {
        let values: u64 = variable
            .dimensions
            .iter()
            .map(|&d| self.dimensions[d].1)
            .product();
        (values * variable.kind.bytes()).next_multiple_of(4)
    }

    fn bytes(&self, wide: bool, places: &[u64]) -> Vec<u8> {
        let mut to = Bytes {
            made: Vec::new(),
            wide,
        };
        to.made.extend(b"CDF");
        to.made.push(if wide { 5 } else { 2 });
        // No record dimension, so no records.
        to.count(0);
        to.list(0x0a, self.dimensions.len());
        for &(name, length) in &self.dimensions {
            to.name(name);
            to.count(length);
        }
        to.attributes(&self.attributes);
        to.list(0x0b, self.variables.len());
        for (variable, place) in self.variables.iter().zip(places) {
            to.name(variable.name);
            to.count(variable.dimensions.len() as u64);
            for &dimension in &variable.dimensions {
                to.count(dimension as u64);
            }
            to.attributes(&variable.attributes);
            to.int(variable.kind as u32);
            to.count(self.bytes_of(variable));
            to.made.extend(place.to_be_bytes());
        }
        to.made
    }
}

struct Bytes {
    made: Vec<u8>,
    wide: bool,
}

impl Bytes {
    fn int(&mut self, value: u32) {
        self.made.extend(value.to_be_bytes());
    }

    fn count(&mut self, value: u64) {
        if self.wide {
            self.made.extend(value.to_be_bytes());
        } else {
            self.int(value as u32);
        }
    }

    /// The head of a list; an absent one has no tag.
    fn list(&mut self, tag: u32, length: usize) {
        self.int(if length == 0 { 0 } else { tag });
        self.count(length as u64);
    }

    fn padded(&mut self, bytes: &[u8]) {
        self.made.extend(bytes);
        let length = bytes.len().next_multiple_of(4) - bytes.len();
        self.made.extend(&[0; 3][..length]);
    }

    fn name(&mut self, name: &str) {
        self.count(name.len() as u64);
        self.padded(name.as_bytes());
    }

    fn attributes(&mut self, attributes: &[(&'static str, Value)]) {
        self.list(0x0c, attributes.len());
        for (name, value) in attributes {
            self.name(name);
            match value {
                Value::Text(text) => {
                    self.int(2);
                    self.count(text.len() as u64);
                    self.padded(text.as_bytes());
                }
                Value::Int(value) => {
                    self.int(4);
                    self.count(1);
                    self.made.extend(value.to_be_bytes());
                }
                Value::Double(value) => {
                    self.int(6);
                    self.count(1);
                    self.made.extend(value.to_be_bytes());
                }
                Value::Bytes(values) => {
                    self.int(1);
                    self.count(values.len() as u64);
                    self.padded(values);
                }
            }
        }
    }
}
