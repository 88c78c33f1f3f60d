//! The XML that Radiance and LBNL WINDOW exchange BSDFs in: the frame round a matrix (klems.rs) or a tensor tree
//! (tensor_tree.rs).
//!
//! WINDOW's `Back` (`Reflection Back`, `Transmission Back`: light from that side) is the side that Radiance calls front, +z;
//! files are written and preferably read so.

use std::str::FromStr;

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

/// Blocks that a message names at most.
const MOST_NAMED: usize = 6;

pub use crate::instrument::klems::Ring;

/// The side of the sample that light comes from, by the file's own words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleSide {
    /// `Reflection Back` and `Transmission Back`, light from +z: what Radiance calls front.
    Back,
    /// `Reflection Front` and `Transmission Front`, light from -z.
    Front,
}

impl SampleSide {
    /// The words for a block of light that comes back, or has gone through.
    pub fn direction(self, through: bool) -> &'static str {
        match (self, through) {
            (SampleSide::Back, false) => "Reflection Back",
            (SampleSide::Back, true) => "Transmission Back",
            (SampleSide::Front, false) => "Reflection Front",
            (SampleSide::Front, true) => "Transmission Front",
        }
    }
}

impl FromStr for SampleSide {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "back" => Ok(SampleSide::Back),
            "front" => Ok(SampleSide::Front),
            _ => {
                Err("front or back needed: the blocks of light from -z (`Front`) or from +z (`Back`)".into())
            }
        }
    }
}

/// The blocks that become a table, and notes on the others.
pub struct SideBlocks<'a> {
    /// Of light that comes back, and that has gone through: none, or Visible and the two of colour where both are there.
    pub halves: [Vec<&'a DataBlock>; 2],
    /// One sentence each.
    pub notes: Vec<String>,
}

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

impl Document {
    /// The blocks of light from one side: visible, and those of the colour `others` (all or none; a file with one of two is
    /// taken for one without colour, as Radiance has it). Without a wanted side it is +z where the file has it.
    // Tested by `a_missing_block_is_answered_with_those_that_are_there`, `the_wanted_side_is_read`
    // (tests/it/interchange/interchange_radiance.rs).
    pub fn side(&self, others: [&str; 2], side: Option<SampleSide>) -> Checked<SideBlocks<'_>> {
        let find = |direction: &str, wavelength: &str| {
            self.blocks
                .iter()
                .find(|block| block.is(direction) && block.wavelength.eq_ignore_ascii_case(wavelength))
        };
        let words = |side: SampleSide| [side.direction(false), side.direction(true)];
        let wanted = side.map_or(vec![SampleSide::Back, SampleSide::Front], |side| vec![side]);
        let visible = |side: &SampleSide| words(*side).map(|direction| find(direction, "Visible"));
        let Some(side) = wanted.into_iter().find(|side| visible(side).iter().any(Option::is_some)) else {
            let what = side.map_or("reflection or transmission".into(), |side| {
                let [reflection, transmission] = words(side);
                format!("`{reflection}` or `{transmission}`")
            });
            return Err(wrong!("no block of visible {what}; the file has {}", self.named(|_| true)));
        };
        let there: Vec<(usize, &str)> =
            words(side).into_iter().enumerate().filter(|(_, word)| find(word, "Visible").is_some()).collect();
        let has = |direction: &str| others.iter().all(|name| find(direction, name).is_some());
        let names = if there.iter().all(|(_, direction)| has(direction)) { &others[..] } else { &[] };
        let mut halves = [vec![], vec![]];
        for &(through, direction) in &there {
            let wavelengths = std::iter::once("Visible").chain(names.iter().copied());
            halves[through] = wavelengths.filter_map(|wavelength| find(direction, wavelength)).collect();
        }
        let mut notes = vec![];
        if side == SampleSide::Front {
            notes.push(
                "light from the side -z (`Front`): x and y are the file's, azimuths run clockwise seen from there".into(),
            );
        }
        let left = |block: &DataBlock| !halves.iter().flatten().any(|taken| std::ptr::eq(*taken, block));
        if self.blocks.iter().any(left) {
            let read: Vec<String> = there.iter().map(|(_, direction)| format!("`{direction}`")).collect();
            let verb = if read.len() > 1 { "are" } else { "is" };
            notes.push(format!("{} {verb} read; not read: {}", read.join(" and "), self.named(left)));
        }
        Ok(SideBlocks { halves, notes })
    }

    /// Some blocks as a list: direction and wavelength of each.
    fn named(&self, wanted: impl Fn(&DataBlock) -> bool) -> String {
        let name = |block: &DataBlock| {
            let words = format!("{} ({})", short(&block.direction), short(&block.wavelength));
            words.escape_debug().to_string()
        };
        let mut names: Vec<String> = self.blocks.iter().filter(|block| wanted(block)).map(name).collect();
        if names.len() > MOST_NAMED {
            let more = names.len() - MOST_NAMED;
            names.truncate(MOST_NAMED);
            names.push(format!("{more} more"));
        }
        names.join(", ")
    }
}

impl DataBlock {
    fn is(&self, direction: &str) -> bool {
        self.direction
            .split_whitespace()
            .map(str::to_ascii_lowercase)
            .eq(direction.split(' ').map(str::to_ascii_lowercase))
    }
}

/// The note on negative values; `None` where there are none.
pub fn negative_note(count: usize, of: usize, least: f64) -> Option<String> {
    (count > 0).then(|| format!("{count} of {of} values are negative (the least {least:.3e}) and become 0"))
}
