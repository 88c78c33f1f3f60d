//! The XML that Radiance and LBNL WINDOW exchange BSDFs in: the frame round a matrix (klems.rs) or a tensor tree
//! (tensor_tree.rs).

use quick_xml::Reader;
use quick_xml::events::{BytesRef, Event};

use crate::error::wrong;
use crate::interchange::Checked;
use crate::text_decoding::decode_xml;

/// Elements deeper than any such file has.
const DEEPEST: usize = 32;

/// Rings of a basis, and characters of a name, that no file exceeds.
const MOST_RINGS: usize = 360;
const LONGEST_NAME: usize = 1 << 10;

/// Elements whose text is kept as a name; `Wavelength` is copied to each block.
const NAMES: [&str; 7] = [
    "IncidentDataStructure",
    "AngleBasisName",
    "WavelengthDataDirection",
    "ColumnAngleBasis",
    "RowAngleBasis",
    "AngleBasis",
    "Wavelength",
];

pub use crate::instrument::klems::Ring;

/// What a file says.
#[derive(Debug, Default, PartialEq)]
pub struct Document {
    /// `Columns`, `Rows`, `TensorTree3`, `TensorTree4`.
    pub structure: String,
    /// Angle bases by name; a tensor tree's has no rings.
    pub bases: Vec<(String, Vec<Ring>)>,
    /// The blocks.
    pub blocks: Vec<DataBlock>,
}

/// One block of values.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct DataBlock {
    /// `Visible`, `CIE-X`, ..
    pub wavelength: String,
    /// `Reflection Back`, ..
    pub direction: String,
    /// Basis of the columns and rows, or the only one.
    pub bases: Vec<String>,
    /// The values as text.
    pub data: String,
}

/// Reads a file. Its text is held about twice.
pub fn read(bytes: &[u8]) -> Checked<Document> {
    if bytes.is_empty() {
        return Err("the file is empty".into());
    }
    let text = decode_xml(bytes)?;
    let mut reader = Reader::from_str(&text);
    // A bare `&` in a name is common, and harmless.
    reader.config_mut().allow_dangling_amp = true;
    let (mut document, mut path, mut content) = (Document::default(), Vec::new(), String::new());
    let (mut ring, mut wavelength) = ((0.0, 0.0, 0), String::new());
    let mut root_seen = false;
    // The last entity of the element that nothing declares.
    let mut undeclared = None;
    loop {
        let event = reader
            .read_event()
            .map_err(|e| format!("XML at byte {}: {}", reader.buffer_position(), flat(&e)))?;
        match event {
            Event::Start(start) => {
                let name = start.local_name().as_ref().to_string();
                if path.is_empty() && name != "WindowElement" {
                    return Err("no WindowElement: not a BSDF of Radiance or WINDOW".into());
                }
                root_seen = true;
                match name.as_str() {
                    "AngleBasis" => document.bases.push(Default::default()),
                    "WavelengthDataBlock" => {
                        document
                            .blocks
                            .push(DataBlock { wavelength: wavelength.clone(), ..DataBlock::default() });
                    }
                    _ => {}
                }
                path.push(name);
                if path.len() > DEEPEST {
                    return Err(wrong!("elements {DEEPEST} deep: no such file is"));
                }
                content.clear();
                undeclared = None;
            }
            Event::Text(text) => content.push_str(&text),
            Event::CData(text) => content.push_str(&text),
            Event::GeneralRef(name) if push_reference(&mut content, &name) => {}
            Event::GeneralRef(name) => undeclared = Some(name.to_string()),
            Event::End(_) => {
                let name = path.pop().unwrap_or_default();
                let text = content.trim();
                if let Some(entity) = undeclared.take().filter(|_| is_read(&name)) {
                    let entity = short(&entity);
                    return Err(wrong!("{name}: nothing declares `&{entity};`; write the character itself"));
                }
                let is_name = NAMES.contains(&name.as_str());
                if is_name && text.len() > LONGEST_NAME {
                    return Err(wrong!("{name} of {} bytes; at most {LONGEST_NAME} are read", text.len()));
                }
                if name == "Wavelength" {
                    wavelength = text.into();
                }
                close(&mut document, &mut ring, &name, text)?;
                content.clear();
            }
            Event::Eof if path.is_empty() && root_seen => break,
            Event::Eof => return Err("the file is cut off".into()),
            _ => {}
        }
    }
    if document.blocks.is_empty() {
        return Err("no WavelengthDataBlock".into());
    }
    Ok(document)
}

/// Takes in an element that ends.
fn close(document: &mut Document, ring: &mut Ring, name: &str, text: &str) -> Checked<()> {
    let angle = || -> Checked<f64> {
        let value: f64 = text.parse().map_err(|_| format!("{name}: {:?} is no number", short(text)))?;
        if (0.0..=90.0).contains(&value) {
            Ok(value)
        } else {
            Err(wrong!("{name} = {value} lies outside [0, 90]"))
        }
    };
    match name {
        "IncidentDataStructure" => document.structure = text.into(),
        "AngleBasisName" => {
            if let Some(basis) = document.bases.last_mut() {
                basis.0 = text.into();
            }
        }
        "LowerTheta" => ring.0 = angle()?,
        "UpperTheta" => ring.1 = angle()?,
        "nPhis" => {
            ring.2 = text.parse().ok().filter(|n| (1..=360).contains(n)).ok_or("nPhis: 1 to 360 needed")?
        }
        "AngleBasisBlock" => {
            if let Some(basis) = document.bases.last_mut() {
                basis.1.push(*ring);
                if basis.1.len() > MOST_RINGS {
                    return Err(wrong!("AngleBasisBlock: a basis of more than {MOST_RINGS} rings"));
                }
            }
        }
        _ => {
            let Some(block) = document.blocks.last_mut() else { return Ok(()) };
            match name {
                "WavelengthDataDirection" => block.direction = text.into(),
                "ColumnAngleBasis" | "RowAngleBasis" | "AngleBasis" => block.bases.push(text.into()),
                "ScatteringDataType" if text != "BRDF" && text != "BTDF" && text != "BSDF" => {
                    return Err(wrong!("ScatteringDataType {:?} is not read", short(text)));
                }
                "ScatteringData" => block.data = text.into(),
                _ => {}
            }
        }
    }
    Ok(())
}

/// Appends the character that a reference names; false where no declaration explains it. In elements that are not read
/// ([`is_read`]), such as names of products, that does no harm.
fn push_reference(content: &mut String, name: &BytesRef) -> bool {
    match (name.resolve_char_ref(), quick_xml::escape::resolve_predefined_entity(name)) {
        (Ok(Some(character)), _) => content.push(character),
        (_, Some(known)) => content.push_str(known),
        _ => return false,
    }
    true
}

/// Whether anything follows from the text of an element.
fn is_read(name: &str) -> bool {
    let others = ["LowerTheta", "UpperTheta", "nPhis", "ScatteringDataType", "ScatteringData"];
    NAMES.contains(&name) || others.contains(&name)
}

/// The beginning of a text, for messages.
pub fn short(text: &str) -> String {
    text.chars().take(40).collect()
}

fn flat(error: &quick_xml::Error) -> String {
    error.to_string()
}

/// The note on negative values; `None` where there are none.
pub fn negative_note(count: usize, of: usize, least: f64) -> Option<String> {
    (count > 0).then(|| format!("{count} of {of} values are negative (the least {least:.3e}) and become 0"))
}
