//! One EXR image in memory: named channels, and text or number attributes.

use std::collections::BTreeMap;
use std::ops::Range;

use half::f16;

/// The values of a channel, row by row.
#[derive(Debug, Clone, PartialEq)]
pub enum Samples {
    /// FLOAT.
    F32(Vec<f32>),
    /// HALF.
    F16(Vec<f16>),
    /// UINT.
    U32(Vec<u32>),
}

impl Samples {
    /// Number of values.
    pub(crate) fn len(&self) -> usize {
        match self {
            Samples::F32(values) => values.len(),
            Samples::F16(values) => values.len(),
            Samples::U32(values) => values.len(),
        }
    }

    /// The bytes of some values, in the machine's order.
    pub(crate) fn bytes(&self, range: Range<usize>) -> Vec<u8> {
        match self {
            Samples::F32(values) => values[range].iter().flat_map(|value| value.to_ne_bytes()).collect(),
            Samples::F16(values) => values[range].iter().flat_map(|value| value.to_ne_bytes()).collect(),
            Samples::U32(values) => values[range].iter().flat_map(|value| value.to_ne_bytes()).collect(),
        }
    }

    /// Adds values of the channel's type, in the machine's order of bytes.
    pub(crate) fn extend(&mut self, bytes: &[u8]) {
        let fours = || bytes.as_chunks::<4>().0.iter();
        match self {
            Samples::F32(list) => list.extend(fours().map(|four| f32::from_ne_bytes(*four))),
            Samples::U32(list) => list.extend(fours().map(|four| u32::from_ne_bytes(*four))),
            Samples::F16(list) => {
                list.extend(bytes.as_chunks::<2>().0.iter().map(|two| f16::from_ne_bytes(*two)));
            }
        }
    }
}

/// The value of an attribute.
#[derive(Debug, Clone, PartialEq)]
pub enum Attribute {
    /// A string, UTF-8.
    Text(String),
    /// A double; floats and integers of other writers arrive here too.
    Number(f64),
}

/// One image of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ImagePart {
    /// Its name; needed where there are several.
    pub name: Option<String>,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The channels by name.
    pub channels: BTreeMap<String, Samples>,
    /// The custom attributes by name. Those of other types are left out on reading.
    pub attributes: BTreeMap<String, Attribute>,
}

impl ImagePart {
    /// The text of an attribute.
    pub fn text(&self, name: &str) -> Option<&str> {
        match self.attributes.get(name) {
            Some(Attribute::Text(text)) => Some(text),
            _ => None,
        }
    }

    /// The number of an attribute.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.attributes.get(name) {
            Some(Attribute::Number(number)) => Some(*number),
            _ => None,
        }
    }

    /// Takes out a channel of floats, HALF or FLOAT.
    pub fn take_floats(&mut self, name: &str) -> Option<Vec<f32>> {
        match self.channels.remove(name)? {
            Samples::F32(values) => Some(values),
            Samples::F16(values) => Some(values.iter().map(|value| value.to_f32()).collect()),
            Samples::U32(_) => None,
        }
    }

    /// Sets the text of an attribute; an empty one is left out.
    pub fn set_text(&mut self, name: &str, text: &str) {
        if !text.is_empty() {
            self.attributes.insert(name.into(), Attribute::Text(text.into()));
        }
    }
}
