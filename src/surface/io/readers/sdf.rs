//! Surface data files (`.sdf`) of ISO 25178-71, and of the BCR proposal before it: as text or binary, metres.
//!
//! The first characters say which: `a` or `b` for text or binary, `ISO-1.0`, `ISO-2.0` or `BCR-1.0`. A binary header has the
//! fields of [`FIELDS`] at fixed places, a text the same ones as lines `Name = value` up to a line `*`, behind which are the
//! heights up to another. Points that were not measured are the smallest value of the type (ISO), the largest (BCR), or
//! `BAD`. Source: ISO 25178-71:2017, clause 5, as the reader `sdfio` (PyPI) documents it.

use super::MapReader;
use super::raw::{Number, at};
use crate::error::Checked;
use crate::files::memory;
use crate::surface::io::samples::{MapSamples, Stored};
use crate::text_decoding::decode_text_or_latin1;

/// Longest header of a text that is looked through.
const LONGEST_HEADER: usize = 1 << 16;
/// The fields of a header that are read.
const FIELDS: [&str; 8] =
    ["NumPoints", "NumProfiles", "Xscale", "Yscale", "Zscale", "Compression", "DataType", "CheckType"];

pub struct Sdf;

impl MapReader for Sdf {
    fn name(&self) -> &'static str {
        "SDF"
    }

    fn accepts(&self, bytes: &[u8]) -> bool {
        matches!(bytes.first(), Some(b'a' | b'A' | b'b' | b'B'))
            && bytes.get(1..5).is_some_and(|family| family == b"ISO-" || family == b"BCR-")
    }

    fn needed(&self, bytes: &[u8]) -> Checked<u64> {
        let text = matches!(bytes.first(), Some(b'a' | b'A'));
        // One byte a height at least, eight of a height and of its copy; a text besides.
        Ok(if text { 2 * bytes.len() as u64 + 3 * 8 * memory::words(bytes) } else { 16 * bytes.len() as u64 })
    }

    fn read(&self, bytes: &[u8], _: Option<&str>) -> Checked<MapSamples> {
        Ok(read(bytes).map_err(|why| format!("SDF: {why}"))?)
    }
}

/// What a header says.
struct Header {
    columns: usize,
    rows: usize,
    /// Metres between samples, and in a unit of height.
    scale: [f64; 3],
    number: Number,
    /// The value that no height has.
    missing: f64,
}

fn read(bytes: &[u8]) -> Result<MapSamples, String> {
    let magic: [u8; 8] = at(bytes, 0, "its version")?;
    let revision = String::from_utf8_lossy(&magic[1..]).into_owned();
    if !matches!(revision.as_str(), "ISO-1.0" | "ISO-2.0" | "BCR-1.0") {
        return Err(format!("version {revision:?} is not read; ISO-1.0, ISO-2.0 and BCR-1.0 are"));
    }
    if magic[0].eq_ignore_ascii_case(&b'b') { binary(bytes, &revision) } else { text(bytes, &revision) }
}

/// Magic 8, maker 10, two dates 12 each, two counts, four scales of 8 and three codes of 1.
fn binary(bytes: &[u8], revision: &str) -> Result<MapSamples, String> {
    const COUNTS: usize = 8 + 10 + 12 + 12;
    let wide = revision == "ISO-2.0";
    let width = if wide { 4 } else { 2 };
    let count = |k: usize| -> Result<f64, String> {
        let place = COUNTS + k * width;
        Ok(if wide {
            f64::from(u32::from_le_bytes(at(bytes, place, FIELDS[k])?))
        } else {
            f64::from(u16::from_le_bytes(at(bytes, place, FIELDS[k])?))
        })
    };
    let scales = COUNTS + 2 * width;
    let scale = |k: usize| at(bytes, scales + 8 * k, FIELDS[2 + k]).map(f64::from_le_bytes);
    let [compression, kind, check] = at(bytes, scales + 32, "DataType")?.map(f64::from);
    let values = [count(0)?, count(1)?, scale(0)?, scale(1)?, scale(2)?, compression, kind, check];
    let header = Header::of(values, revision)?;
    let start = scales + 35;
    // What follows the heights is a trailer.
    let length = header.columns.saturating_mul(header.rows).saturating_mul(header.number.size());
    let data = bytes.get(start..).unwrap_or_default();
    let [_, _, z] = header.scale;
    let to = |height: f64| if header.is_missing(height) { f64::NAN } else { z * height };
    let data = &data[..length.min(data.len())];
    let heights = header.number.read(data, [header.columns, header.rows], to)?;
    Ok(header.map(heights))
}

fn text(bytes: &[u8], revision: &str) -> Result<MapSamples, String> {
    let whole = decode_text_or_latin1(bytes)?;
    let mut values = [f64::NAN; FIELDS.len()];
    let mut length = 0;
    let mut ended = false;
    for line in whole.split_inclusive(['\n', '\r']) {
        length += line.len();
        let line = line.split(';').next().unwrap_or_default().trim();
        if line == "*" {
            ended = true;
            break;
        }
        if length > LONGEST_HEADER {
            break;
        }
        let Some((name, value)) = line.split_once('=') else { continue };
        if let Some(field) = FIELDS.iter().position(|field| field.eq_ignore_ascii_case(name.trim())) {
            values[field] = value_of(field, value.trim())?;
        }
    }
    if !ended {
        return Err("no line `*` ends the header".into());
    }
    if let Some(field) = values.iter().position(|value| value.is_nan()) {
        return Err(format!("no {}", FIELDS[field]));
    }
    let header = Header::of(values, revision)?;
    let [_, _, z] = header.scale;
    let mut heights = Vec::new();
    let lines = whole[length..].split(['\n', '\r']).take_while(|line| line.trim() != "*");
    for word in lines.flat_map(|line| line.split(';').next().unwrap_or_default().split_whitespace()) {
        let height = match word {
            word if word.eq_ignore_ascii_case("bad") || word.eq_ignore_ascii_case("nan") => f64::NAN,
            word => word
                .parse()
                .map_err(|_| format!("height {}: `{word:.40}` is no number", heights.len() + 1))?,
        };
        heights.push(if header.is_missing(height) { f64::NAN } else { z * height });
    }
    if header.columns.checked_mul(header.rows) != Some(heights.len()) {
        return Err(format!("{} heights do not make {} x {}", heights.len(), header.columns, header.rows));
    }
    Ok(header.map(heights))
}

/// A value of a text's header; BCR files may name their codes.
fn value_of(field: usize, value: &str) -> Result<f64, String> {
    const NAMES: [&str; 8] =
        ["UCHAR", "UINTEGER", "ULONGINT", "FLOAT", "CHAR", "INTEGER", "LONGINT", "DOUBLE"];
    let named = match FIELDS[field] {
        "DataType" => NAMES.iter().position(|name| name.eq_ignore_ascii_case(value)),
        "Compression" | "CheckType" if matches!(value.to_ascii_uppercase().as_str(), "NULL" | "NONE") => {
            Some(0)
        }
        _ => None,
    };
    let number =
        named.map(|code| code as f64).or_else(|| value.parse().ok()).filter(|value: &f64| !value.is_nan());
    number.ok_or_else(|| format!("{} = {value:.40}: must be a number", FIELDS[field]))
}

impl Header {
    /// From the values of [`FIELDS`].
    fn of(values: [f64; 8], revision: &str) -> Result<Self, String> {
        const NUMBERS: [Number; 8] = [
            Number::U8,
            Number::U16,
            Number::U32,
            Number::F32,
            Number::I8,
            Number::I16,
            Number::I32,
            Number::F64,
        ];
        let [columns, rows, x, y, z, compression, kind, check] = values;
        let count = |name: &str, value: f64| {
            let whole = value.fract() == 0.0 && (1.0..=f64::from(u32::MAX)).contains(&value);
            if whole {
                Ok(value as usize)
            } else {
                Err(format!("{name} = {value}: must be a whole number above 0"))
            }
        };
        let (columns, rows) = (count("NumPoints", columns)?, count("NumProfiles", rows)?);
        if rows == 1 {
            return Err("a single profile; a height map has several".into());
        }
        if compression != 0.0 || check != 0.0 {
            return Err(format!(
                "Compression = {compression}, CheckType = {check}: compressed data and those with checksums are not read; \
                 save without"
            ));
        }
        let number =
            NUMBERS.iter().enumerate().find(|(code, _)| *code as f64 == kind).map(|(_, number)| *number);
        let number = number.ok_or_else(|| format!("DataType = {kind}: 0 to 7 are known"))?;
        if !(z > 0.0 && z.is_finite()) {
            return Err(format!("Zscale = {z}: must be positive and finite"));
        }
        let [lowest, highest] = number.ends();
        let missing = if revision == "BCR-1.0" { highest } else { lowest };
        Ok(Header { columns, rows, scale: [x, y, z], number, missing })
    }

    /// Whether a number is none. Writers do not agree on the largest float (1.7e308, 1.797e308): no height comes near it.
    fn is_missing(&self, height: f64) -> bool {
        match self.number {
            Number::F32 | Number::F64 => height / self.missing > 0.9,
            _ => height == self.missing,
        }
    }

    fn map(&self, heights: Vec<f64>) -> MapSamples {
        let stored = match self.number {
            Number::F32 => Stored::Single,
            Number::U8 | Number::I8 => Stored::Byte,
            _ => Stored::Exact,
        };
        let [x, y, _] = self.scale;
        MapSamples::new(self.columns, self.rows, heights, stored).with_units("SDF", [x, y], ["m", "m"], "m")
    }
}
