//! EXR images in memory: named channels and text or number attributes, one or more parts of scan lines.
//!
//! Enters and leaves: bytes. The same parts give the same bytes, in every process. The codec never sees a path.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds,
    Layer, LayerAttributes, ReadChannels, ReadLayers, Text, Vec2, WritableImage, f16, read,
};
use smallvec::SmallVec;

use super::exr_header;

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
pub struct Part {
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

impl Part {
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

    /// Sets the text of an attribute; an empty one is left out.
    pub fn set_text(&mut self, name: &str, text: &str) {
        if !text.is_empty() {
            self.attributes.insert(name.into(), Attribute::Text(text.into()));
        }
    }
}

/// The bytes of a file with these parts, ZIP in blocks of 16 rows, data and display window both from (0, 0).
///
/// Held by: `equal_tables_have_equal_bytes_whatever_the_hash_seed`.
pub fn encode(parts: Vec<Part>) -> Result<Vec<u8>, String> {
    let size = parts.first().map(|part| Vec2(part.width, part.height)).ok_or("no parts")?;
    let layers = parts.into_iter().map(layer).collect::<Result<SmallVec<_>, String>>()?;
    let image = Image::from_layers(ImageAttributes::new(IntegerBounds::from_dimensions(size)), layers);
    let mut out = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut out).map_err(|e| e.to_string())?;
    let mut bytes = out.into_inner();
    exr_header::sort_attributes(&mut bytes)?;
    Ok(bytes)
}

fn layer(part: Part) -> Result<Layer<AnyChannels<FlatSamples>>, String> {
    let pixels = part.width * part.height;
    let mut channels = SmallVec::new();
    for (name, samples) in part.channels {
        let samples = match samples {
            Samples::F32(values) => FlatSamples::F32(values),
            Samples::F16(values) => FlatSamples::F16(values),
            Samples::U32(values) => FlatSamples::U32(values),
        };
        if samples.len() != pixels || pixels == 0 {
            let (width, height) = (part.width, part.height);
            return Err(format!("channel `{name}` has {} values for {width} x {height}", samples.len()));
        }
        channels.push(AnyChannel::new(text(&name), samples));
    }
    let mut attributes = LayerAttributes { layer_name: part.name.as_deref().map(text), ..Default::default() };
    for (name, value) in part.attributes {
        let value = match value {
            Attribute::Text(value) => AttributeValue::Text(text(&value)),
            Attribute::Number(value) => AttributeValue::F64(value),
        };
        attributes.other.insert(text(&name), value);
    }
    let encoding = Encoding::SMALL_LOSSLESS;
    let encoding = Encoding { compression: exr::prelude::Compression::ZIP16, ..encoding };
    let size = Vec2(part.width, part.height);
    Ok(Layer::new(size, attributes, encoding, AnyChannels::sort(channels)))
}

pub(super) fn text(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

/// The parts of a file.
///
/// Memory is bounded by the file's size: a header that asks for more than the file can hold is refused first.
/// The codec checks most of what it reads; should a damaged file still trip one of its assertions, that is an
/// error of the file too.
pub fn decode(bytes: &[u8]) -> Result<Vec<Part>, String> {
    // Names of a damaged file reach the message: it stays one line.
    decode_raw(bytes).map_err(|why| why.replace(char::is_control, "?"))
}

fn decode_raw(bytes: &[u8]) -> Result<Vec<Part>, String> {
    exr_header::check(bytes)?;
    let image = catch_unwind(AssertUnwindSafe(|| {
        read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .non_parallel()
            .pedantic()
            .from_buffered(Cursor::new(bytes))
    }))
    .map_err(|_| "damaged: the decoder gave up")?
    .map_err(|e| format!("damaged or cut off: {e}"))?;
    image.layer_data.into_iter().map(part).collect()
}

fn part(layer: Layer<AnyChannels<FlatSamples>>) -> Result<Part, String> {
    let name_of = |text: &Text| String::from_utf8_lossy(text.as_slice()).into_owned();
    let mut channels = BTreeMap::new();
    for channel in layer.channel_data.list {
        let name = name_of(&channel.name);
        let samples = match channel.sample_data {
            FlatSamples::F32(values) => Samples::F32(values),
            FlatSamples::F16(values) => Samples::F16(values),
            FlatSamples::U32(values) => Samples::U32(values),
        };
        if channels.insert(name.clone(), samples).is_some() {
            return Err(format!("channel `{name}` is there twice"));
        }
    }
    let mut attributes = BTreeMap::new();
    for (name, value) in &layer.attributes.other {
        let value = match value {
            AttributeValue::Text(text) => Attribute::Text(name_of(text)),
            AttributeValue::F64(number) => Attribute::Number(*number),
            AttributeValue::F32(number) => Attribute::Number(f64::from(*number)),
            AttributeValue::I32(number) => Attribute::Number(f64::from(*number)),
            _ => continue,
        };
        attributes.insert(name_of(name), value);
    }
    Ok(Part {
        name: layer.attributes.layer_name.as_ref().map(name_of),
        width: layer.size.width(),
        height: layer.size.height(),
        channels,
        attributes,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Part {
        let mut part = Part { width: 5, height: 40, ..Part::default() };
        let values = (0..200u16).map(|i| f32::from(i).sqrt()).collect();
        part.channels.insert("height".into(), Samples::F32(values));
        part.attributes.insert("pitch_x".into(), Attribute::Number(0.1));
        part.set_text("note", "µm, δ");
        part
    }

    #[test]
    fn a_part_round_trips_with_its_doubles_and_its_utf8() {
        let part = sample();
        let back = decode(&encode(vec![part.clone()]).expect("encodes")).expect("decodes");
        assert_eq!(back, vec![part]);
    }

    #[test]
    fn parts_keep_their_names_and_order() {
        let parts: Vec<Part> =
            (0..3).rev().map(|i| Part { name: Some(format!("p{i}")), ..sample() }).collect();
        let back = decode(&encode(parts.clone()).expect("encodes")).expect("decodes");
        assert_eq!(back, parts);
    }

    #[test]
    fn a_header_that_asks_for_more_than_the_file_holds_is_refused() {
        let mut bytes = encode(vec![sample()]).expect("encodes");
        let at = bytes.windows(10).position(|w| w == b"dataWindow").expect("is there") + 10 + 1 + 6 + 4;
        bytes[at + 8..at + 12].copy_from_slice(&((1u32 << 24) - 1).to_le_bytes());
        assert!(decode(&bytes).expect_err("too wide").contains("asks for"));
        bytes[at + 8..at + 12].copy_from_slice(&i32::MAX.to_le_bytes());
        assert!(decode(&bytes).expect_err("absurd").contains("dataWindow"));
    }

    #[test]
    fn two_headers_that_run_into_each_other_are_refused() {
        let part = |i: usize| Part { name: Some(format!("p{i}")), ..sample() };
        let mut bytes = encode(vec![part(0), part(1)]).expect("encodes");
        // The zero byte between the headers becomes the first letter of one more attribute's name.
        let name = b"type\0string\0\x0d\0\0\0scanlineimage";
        let at = bytes.windows(name.len()).position(|w| w == name).expect("is there") + name.len();
        assert_eq!((bytes[at], bytes[at + 1]), (0, b'c'));
        bytes[at] = b'x';
        assert!(decode(&bytes).expect_err("fused").contains("is there twice"));
    }

    #[test]
    fn tiled_and_deep_images_are_refused_by_name() {
        let mut bytes = encode(vec![sample()]).expect("encodes");
        bytes[5] = 0b0010;
        assert!(decode(&bytes).expect_err("tiled").contains("tiled"));
        bytes[5] = 0b1000;
        assert!(decode(&bytes).expect_err("deep").contains("deep"));
    }
}
