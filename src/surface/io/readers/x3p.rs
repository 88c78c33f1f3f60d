//! X3P archives of ISO 25178-72: `main.xml`, which says what there is, and the heights as numbers in a member of their own or
//! as text in the XML.
//!
//! x and y must be incremental (`I`), which makes a regular grid; z is absolute: height = increment x number, metres. Without
//! data are NaN, an empty `Datum`, and points whose bit in the member of valid points is 0 (first bit lowest). Source:
//! ISO 25178-72:2017 and Amd 1:2020, as the reader `x3pio` (PyPI) documents them.

use std::io::{Cursor, Read};

use quick_xml::Reader;
use quick_xml::events::Event;
use zip::ZipArchive;

use super::MapReader;
use super::raw::{Number, short};
use crate::error::Checked;
use crate::files::memory;
use crate::surface::io::samples::{MapSamples, Stored};
use crate::text_decoding::decode_xml;

/// How an archive of files begins.
const ZIP: &[u8] = b"PK\x03\x04";
/// Deflate shrinks at most 1032-fold.
const MAX_RATIO: u64 = 1032;
/// Members that no such archive exceeds.
const MOST_MEMBERS: usize = 4096;
/// Elements deeper than any such file has.
const DEEPEST: usize = 32;

pub struct X3p;

impl MapReader for X3p {
    fn name(&self) -> &'static str {
        "X3P"
    }

    fn accepts(&self, bytes: &[u8]) -> bool {
        bytes.starts_with(ZIP)
    }

    fn needed(&self, bytes: &[u8]) -> Checked<u64> {
        let mut archive = Archive::open(bytes)?;
        // Numbers of two bytes become heights of eight and a copy of them; text in the XML takes more bytes than that.
        Ok(archive.inflated()?.saturating_mul(9))
    }

    fn read(&self, bytes: &[u8], _: Option<&str>) -> Checked<MapSamples> {
        Ok(read(bytes).map_err(|why| format!("X3P: {why}"))?)
    }
}

/// The archive while it is read.
struct Archive<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    /// No member can hold more.
    limit: u64,
}

impl<'a> Archive<'a> {
    fn open(bytes: &'a [u8]) -> Result<Self, String> {
        let zip = ZipArchive::new(Cursor::new(bytes))
            .map_err(|why| format!("no archive that can be read: {}", short(why)))?;
        if zip.len() > MOST_MEMBERS {
            return Err(format!("{} members; at most {MOST_MEMBERS} are read", zip.len()));
        }
        Ok(Archive { zip, limit: MAX_RATIO.saturating_mul(bytes.len() as u64) })
    }

    /// Bytes of all members, by what the archive says.
    fn inflated(&mut self) -> Result<u64, String> {
        let mut all = 0u64;
        for index in 0..self.zip.len() {
            all = all.saturating_add(self.zip.by_index_raw(index).map_err(short)?.size());
        }
        Ok(all)
    }

    fn member(&mut self, name: &str) -> Result<Vec<u8>, String> {
        let found = self.zip.by_name(name.trim_start_matches("./"));
        let mut member = found.map_err(|why| format!("member `{name:.60}`: {}", short(why)))?;
        let size = member.size();
        if size > self.limit {
            return Err(format!("member `{name:.60}` claims {size} bytes, more than the file can hold"));
        }
        let mut bytes = memory::room(usize::try_from(size).unwrap_or(usize::MAX))?;
        // What the archive says is not believed beyond what the data give.
        let read = member.by_ref().take(size + 1).read_to_end(&mut bytes);
        read.map_err(|why| format!("member `{name:.60}`: {}", short(why)))?;
        Ok(bytes)
    }
}

fn read(bytes: &[u8]) -> Result<MapSamples, String> {
    let mut archive = Archive::open(bytes)?;
    let main = archive.member("main.xml").map_err(|why| format!("no X3P archive: {why}"))?;
    let document = Document::read(&main)?;
    let [columns, rows] = document.counts()?;
    let pitch = [document.increment("CX")?, document.increment("CY")?];
    let number = document.number()?;
    let increment = match document.number_at("CZ/Increment")? {
        Some(value) if value > 0.0 && value.is_finite() => value,
        Some(value) => return Err(format!("CZ Increment {value}: must be positive and finite")),
        None => 1.0,
    };
    if let Some(wrong) = &document.wrong_datum {
        return Err(wrong.clone());
    }
    let heights = if document.data.is_empty() {
        let data = archive.member(document.need("DataLink/PointDataLink")?)?;
        let mut heights = number.read(&data, [columns, rows], |value| increment * value)?;
        if let Some(valid) = document.text("DataLink/ValidPointsLink").filter(|link| !link.is_empty()) {
            without_data(&mut heights, &archive.member(valid)?)?;
        }
        heights
    } else if columns.checked_mul(rows) == Some(document.data.len()) {
        document.data.iter().map(|value| increment * value).collect()
    } else {
        return Err(format!("{} heights do not make {columns} x {rows}", document.data.len()));
    };
    let stored = if number == Number::F32 { Stored::Single } else { Stored::Exact };
    Ok(MapSamples::new(columns, rows, heights, stored).with_units("X3P", pitch, ["m", "m"], "m"))
}

/// Takes the heights away whose bit is 0.
fn without_data(heights: &mut [f64], valid: &[u8]) -> Result<(), String> {
    if valid.len() < heights.len().div_ceil(8) {
        return Err(format!("{} bytes of valid points for {} heights", valid.len(), heights.len()));
    }
    for (index, height) in heights.iter_mut().enumerate() {
        if valid[index / 8] >> (index % 8) & 1 == 0 {
            *height = f64::NAN;
        }
    }
    Ok(())
}

/// What `main.xml` says.
#[derive(Default)]
struct Document {
    /// Texts by the last two elements of their path, such as `CX/Increment`.
    texts: Vec<(String, String)>,
    /// Heights as text.
    data: Vec<f64>,
    /// The first that is none.
    wrong_datum: Option<String>,
}

impl Document {
    fn read(bytes: &[u8]) -> Result<Self, String> {
        let text = decode_xml(bytes)?;
        let mut reader = Reader::from_str(&text);
        let (mut document, mut path, mut content) =
            (Document::default(), Vec::<String>::new(), String::new());
        loop {
            let event = reader.read_event();
            match event
                .map_err(|why| format!("main.xml at byte {}: {}", reader.buffer_position(), short(why)))?
            {
                Event::Start(start) => {
                    path.push(start.local_name().as_ref().to_string());
                    if path.len() > DEEPEST {
                        return Err(format!("main.xml: elements {DEEPEST} deep: no such file is"));
                    }
                    content.clear();
                }
                Event::Empty(empty) if empty.local_name().as_ref() == "Datum" => document.data.push(f64::NAN),
                Event::Text(text) => content.push_str(&text),
                Event::End(_) => {
                    document.close(&path, content.trim());
                    path.pop();
                    content.clear();
                }
                Event::Eof if path.is_empty() => return Ok(document),
                Event::Eof => return Err("main.xml is cut off".into()),
                _ => {}
            }
        }
    }

    /// Takes in an element that ends.
    fn close(&mut self, path: &[String], text: &str) {
        const PARENTS: [&str; 6] = ["CX", "CY", "CZ", "Record1", "MatrixDimension", "DataLink"];
        let [.., parent, name] = path else { return };
        if name == "Datum" {
            let height = if text.is_empty() { Ok(f64::NAN) } else { text.parse() };
            if height.is_err() && self.wrong_datum.is_none() {
                self.wrong_datum = Some(format!("height {}: `{text:.40}` is no number", self.data.len() + 1));
            }
            self.data.push(height.unwrap_or(f64::NAN));
        } else if PARENTS.contains(&parent.as_str()) {
            self.texts.push((format!("{parent}/{name}"), text.into()));
        }
    }

    fn text(&self, path: &str) -> Option<&str> {
        self.texts.iter().find(|(known, _)| known == path).map(|(_, text)| text.as_str())
    }

    fn need(&self, path: &str) -> Result<&str, String> {
        self.text(path).ok_or_else(|| format!("main.xml: no {path}"))
    }

    fn number_at(&self, path: &str) -> Result<Option<f64>, String> {
        let parse =
            |text: &str| text.parse().map_err(|_| format!("main.xml: {path} `{text:.40}` is no number"));
        self.text(path).map(parse).transpose()
    }

    /// Columns and rows of the only layer of a surface.
    fn counts(&self) -> Result<[usize; 2], String> {
        match self.need("Record1/FeatureType")? {
            "SUR" => {}
            "PRF" => return Err("a profile (PRF); a height map is a surface (SUR)".into()),
            "PCL" => {
                return Err(
                    "a cloud of points (PCL); resample it to a surface (SUR) on a regular grid".into()
                );
            }
            other => return Err(format!("FeatureType `{other:.40}`: SUR needed")),
        }
        let count = |name: &str| {
            let text = self.need(&format!("MatrixDimension/{name}"))?;
            let count: usize =
                text.parse().map_err(|_| format!("{name} `{text:.40}`: must be a whole number"))?;
            if count > 0 { Ok(count) } else { Err(format!("{name} = 0")) }
        };
        match count("SizeZ")? {
            1 => Ok([count("SizeX")?, count("SizeY")?]),
            layers => Err(format!("{layers} layers; save one of them")),
        }
    }

    /// Metres between samples along an axis.
    fn increment(&self, axis: &str) -> Result<f64, String> {
        match self.need(&format!("{axis}/AxisType"))? {
            "I" => self
                .number_at(&format!("{axis}/Increment"))?
                .ok_or_else(|| format!("main.xml: no {axis}/Increment")),
            "A" => Err(format!(
                "{axis} is absolute: the points need not lie on a grid; resample them to a regular one"
            )),
            other => Err(format!("{axis} AxisType `{other:.40}`: I or A needed")),
        }
    }

    fn number(&self) -> Result<Number, String> {
        match self.need("CZ/DataType")? {
            "I" => Ok(Number::I16),
            "L" => Ok(Number::I32),
            "F" => Ok(Number::F32),
            "D" => Ok(Number::F64),
            other => Err(format!("CZ DataType `{other:.40}`: I, L, F or D needed")),
        }
    }
}
