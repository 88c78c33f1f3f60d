//! The tensor file: named arrays in one container, as Mitsuba and the RGL material database use it.
//!
//! `tensor_file` and a zero byte; version 1, 0; u32 number of fields; for each u16 length and name, u16 axes, u8 type,
//! u64 offset, u64 sides; then the data, each at a multiple of 8. Little-endian.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::error::wrong;
use crate::interchange::Checked;

const MAGIC: &[u8] = b"tensor_file\0";
/// More than any file seen has.
const MOST_FIELDS: u32 = 256;
const MOST_AXES: u16 = 8;

/// The values of a field.
#[derive(Debug, Clone, PartialEq)]
pub enum TensorData {
    /// Type 10.
    F32(Vec<f32>),
    /// Type 1.
    U8(Vec<u8>),
}

/// A field to write: name, sides, values.
pub type TensorField = (&'static str, Vec<usize>, TensorData);

/// The bytes of a file.
pub fn encode(fields: &[TensorField]) -> Vec<u8> {
    let header: usize =
        18 + fields.iter().map(|(name, sides, _)| 13 + name.len() + 8 * sides.len()).sum::<usize>();
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0]);
    bytes.extend((fields.len() as u32).to_le_bytes());
    let mut offset = header.next_multiple_of(8);
    for (name, sides, data) in fields {
        let (kind, size) = match data {
            TensorData::F32(values) => (10, 4 * values.len()),
            TensorData::U8(values) => (1, values.len()),
        };
        bytes.extend((name.len() as u16).to_le_bytes());
        bytes.extend(name.as_bytes());
        bytes.extend((sides.len() as u16).to_le_bytes());
        bytes.push(kind);
        bytes.extend((offset as u64).to_le_bytes());
        sides.iter().for_each(|&side| bytes.extend((side as u64).to_le_bytes()));
        offset = (offset + size).next_multiple_of(8);
    }
    for (_, _, data) in fields {
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        match data {
            TensorData::F32(values) => values.iter().for_each(|value| bytes.extend(value.to_le_bytes())),
            TensorData::U8(values) => bytes.extend(values),
        }
    }
    bytes
}

/// Where a field lies in the bytes of its file.
struct FieldRange {
    sides: Vec<usize>,
    kind: u8,
    data: Range<usize>,
}

/// The fields of a file.
pub struct TensorFile<'a> {
    bytes: &'a [u8],
    fields: BTreeMap<String, FieldRange>,
}

/// Reads numbers one after the other.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize) -> Checked<&'a [u8]> {
        let found =
            self.bytes.get(self.at..).and_then(|rest| rest.get(..count)).ok_or("the header is cut off")?;
        self.at += count;
        Ok(found)
    }

    fn number(&mut self, count: usize) -> Checked<u64> {
        let bytes = self.take(count)?;
        Ok(bytes.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte)))
    }
}

impl<'a> TensorFile<'a> {
    /// Reads the header; every field must lie within the file.
    pub fn open(bytes: &'a [u8]) -> Checked<Self> {
        if !bytes.starts_with(MAGIC) {
            return Err(if bytes.is_empty() { "the file is empty" } else { "not a tensor file" }.into());
        }
        let mut cursor = Cursor { bytes, at: MAGIC.len() };
        let version = cursor.number(2)?;
        if version != 1 {
            return Err(wrong!(
                "version {}.{} of the tensor file is not read, only 1.0",
                version & 255,
                version >> 8
            ));
        }
        let count = cursor.number(4)? as u32;
        if count > MOST_FIELDS {
            return Err(wrong!("{count} fields, at most {MOST_FIELDS} are read"));
        }
        let mut fields = BTreeMap::new();
        for _ in 0..count {
            let (name, place) = Self::place(&mut cursor)?;
            if fields.insert(name.clone(), place).is_some() {
                return Err(wrong!("field `{name}` is there twice"));
            }
        }
        // Fields over the same bytes would make more values than the file has.
        let all = fields.values().fold(0usize, |sum, place| sum.saturating_add(place.data.len()));
        if all > bytes.len() {
            return Err(wrong!("fields of {all} bytes in a file of {}: they overlap", bytes.len()));
        }
        Ok(TensorFile { bytes, fields })
    }

    fn place(cursor: &mut Cursor) -> Checked<(String, FieldRange)> {
        let length = cursor.number(2)? as usize;
        // Shown in messages: no control characters.
        let name = String::from_utf8_lossy(cursor.take(length)?).escape_debug().to_string();
        if name.len() > 255 {
            return Err("a field's name is longer than any".into());
        }
        let axes = cursor.number(2)? as u16;
        if axes > MOST_AXES {
            return Err(wrong!("field `{name}` has {axes} axes, at most {MOST_AXES} are read"));
        }
        let kind = cursor.number(1)? as u8;
        let size = match kind {
            1 | 2 => 1,
            3 | 4 | 9 => 2,
            5 | 6 | 10 => 4,
            7 | 8 | 11 => 8,
            _ => return Err(wrong!("field `{name}` has the unknown type {kind}")),
        };
        let offset = usize::try_from(cursor.number(8)?).unwrap_or(usize::MAX);
        let sides = (0..axes).map(|_| cursor.number(8)).collect::<Checked<Vec<u64>>>()?;
        let sides: Vec<usize> =
            sides.iter().map(|&side| usize::try_from(side).unwrap_or(usize::MAX)).collect();
        let length = sides.iter().try_fold(size, |length: usize, &side| length.checked_mul(side));
        let end =
            length.and_then(|length| offset.checked_add(length)).filter(|&end| end <= cursor.bytes.len());
        let end =
            end.ok_or_else(|| format!("field `{name}` of sides {sides:?} reaches beyond the file's end"))?;
        Ok((name, FieldRange { sides, kind, data: offset..end }))
    }

    /// Whether there is such a field.
    pub fn has(&self, name: &str) -> bool {
        self.fields.contains_key(name)
    }

    /// Sides and values of an f32 field with so many axes, all finite and none empty.
    pub fn f32(&self, name: &str, axes: usize) -> Checked<(Vec<usize>, Vec<f32>)> {
        let place = self.fields.get(name).ok_or_else(|| format!("no field `{name}`"))?;
        if place.kind != 10 || place.sides.len() != axes || place.data.is_empty() {
            return Err(wrong!("field `{name}`: f32 with {axes} axes needed, none of them empty"));
        }
        let values: Vec<f32> = self.bytes[place.data.clone()]
            .as_chunks::<4>()
            .0
            .iter()
            .map(|chunk| f32::from_le_bytes(*chunk))
            .collect();
        match values.iter().position(|value| !value.is_finite()) {
            Some(at) => Err(wrong!("field `{name}`, value {at}: {} is not a finite number", values[at])),
            None => Ok((place.sides.clone(), values)),
        }
    }
}
