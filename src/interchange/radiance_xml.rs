//! The XML that Radiance and LBNL WINDOW exchange BSDFs in: the frame round a matrix (klems.rs) or a tensor tree
//! (tensor_tree.rs).
//!
//! WINDOW's `Reflection Back` is the side that Radiance calls front, +z; files are written and preferably read so.

use quick_xml::Reader;
use quick_xml::events::Event;

use super::Reason;

/// Elements deeper than any such file has.
const DEEPEST: usize = 32;

pub use crate::instrument::klems::Ring;

/// What a file says.
#[derive(Debug, Default, PartialEq)]
pub struct Document {
    /// `Columns`, `Rows`, `TensorTree3`, `TensorTree4`.
    pub structure: String,
    /// Angle bases by name; a tensor tree's has no rings.
    pub bases: Vec<(String, Vec<Ring>)>,
    /// The blocks.
    pub blocks: Vec<Block>,
}

/// One block of values.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Block {
    /// `Visible`, `CIE-X`, ..
    pub wavelength: String,
    /// `Reflection Back`, ..
    pub direction: String,
    /// Basis of the columns and rows, or the only one.
    pub bases: Vec<String>,
    /// The values as text.
    pub data: String,
}

/// A file with a block for each channel: its wavelength (`Visible`, `CIE-X`, ..), and its values as text. All are
/// `Reflection Back`.
pub fn write(structure: &str, basis: &str, block_bases: &str, channels: &[(&str, String)]) -> String {
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <WindowElement xmlns=\"http://windows.lbl.gov\">\n\
         <WindowElementType>System</WindowElementType>\n<FileType>BSDF</FileType>\n<Optical>\n<Layer>\n\
         <Material>\n<Name>gonio</Name>\n<Manufacturer>gonio {}</Manufacturer>\n<DeviceType>Other</DeviceType>\n</Material>\n\
         <DataDefinition>\n<IncidentDataStructure>{structure}</IncidentDataStructure>\n{basis}</DataDefinition>\n",
        env!("CARGO_PKG_VERSION")
    );
    for (wavelength, data) in channels {
        let detector = if *wavelength == "Visible" { "ASTM E308 1931 Y.dsp" } else { "none" };
        text += &format!(
            "<WavelengthData>\n<LayerNumber>System</LayerNumber>\n<Wavelength unit=\"Integral\">{wavelength}</Wavelength>\n\
             <SourceSpectrum>CIE Illuminant D65 1nm.ssp</SourceSpectrum>\n\
             <DetectorSpectrum>{detector}</DetectorSpectrum>\n<WavelengthDataBlock>\n\
             <WavelengthDataDirection>Reflection Back</WavelengthDataDirection>\n{block_bases}\
             <ScatteringDataType>BRDF</ScatteringDataType>\n<ScatteringData>\n"
        );
        text += data;
        text += "</ScatteringData>\n</WavelengthDataBlock>\n</WavelengthData>\n";
    }
    text + "</Layer>\n</Optical>\n</WindowElement>\n"
}

/// Reads a file. Its text is held about twice.
pub fn read(bytes: &[u8]) -> Reason<Document> {
    if bytes.is_empty() {
        return Err("the file is empty".into());
    }
    let text = std::str::from_utf8(bytes).map_err(|_| "not an XML file in UTF-8")?;
    let mut reader = Reader::from_str(text);
    let (mut document, mut path, mut content) = (Document::default(), Vec::new(), String::new());
    let (mut ring, mut wavelength) = ((0.0, 0.0, 0), String::new());
    let mut root_seen = false;
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
                        document.blocks.push(Block { wavelength: wavelength.clone(), ..Block::default() });
                    }
                    _ => {}
                }
                path.push(name);
                if path.len() > DEEPEST {
                    return Err(format!("elements {DEEPEST} deep: no such file is"));
                }
                content.clear();
            }
            Event::Text(text) => content.push_str(&text),
            Event::End(_) => {
                let name = path.pop().unwrap_or_default();
                let text = content.trim();
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
fn close(document: &mut Document, ring: &mut Ring, name: &str, text: &str) -> Reason<()> {
    let angle = || -> Reason<f64> {
        let value: f64 = text.parse().map_err(|_| format!("{name}: {:?} is no number", short(text)))?;
        if (0.0..=90.0).contains(&value) {
            Ok(value)
        } else {
            Err(format!("{name} = {value} lies outside [0, 90]"))
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
            }
        }
        _ => {
            let Some(block) = document.blocks.last_mut() else { return Ok(()) };
            match name {
                "WavelengthDataDirection" => block.direction = text.into(),
                "ColumnAngleBasis" | "RowAngleBasis" | "AngleBasis" => block.bases.push(text.into()),
                "ScatteringDataType" if text != "BRDF" && text != "BTDF" && text != "BSDF" => {
                    return Err(format!("ScatteringDataType {:?} is not read", short(text)));
                }
                "ScatteringData" => block.data = text.into(),
                _ => {}
            }
        }
    }
    Ok(())
}

/// The beginning of a text, for messages.
pub fn short(text: &str) -> String {
    text.chars().take(40).collect()
}

fn flat(error: &quick_xml::Error) -> String {
    error.to_string()
}

impl Document {
    /// The blocks of reflected light, of the side +z where there is one: visible, and those of the colour `others`
    /// (all or none; a file with one of two is taken for one without colour, as Radiance has it).
    pub fn reflection(&self, others: [&str; 2]) -> Reason<Vec<&Block>> {
        let find = |direction: &str, wavelength: &str| {
            self.blocks.iter().find(|block| block.direction == direction && block.wavelength == wavelength)
        };
        let direction = ["Reflection Back", "Reflection Front"];
        let direction = direction.into_iter().find(|direction| find(direction, "Visible").is_some());
        let direction = direction.ok_or("no block of visible reflection")?;
        let visible = find(direction, "Visible").into_iter();
        let coloured: Vec<&Block> = others.into_iter().filter_map(|name| find(direction, name)).collect();
        let coloured = if coloured.len() == others.len() { coloured } else { vec![] };
        Ok(visible.chain(coloured).collect())
    }
}
