//! EXR images row by row: parts whose pixels lie elsewhere are written without a copy of them.

use std::io::Cursor;

use exr::block::writer::ChunksWriter;
use exr::block::{self, UncompressedBlock, enumerate_ordered_header_block_indices};
use exr::meta::attribute::{ChannelDescription, LineOrder, SampleType};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, Headers};
use exr::prelude::{
    AttributeValue, Compression, ImageAttributes, IntegerBounds, LayerAttributes, Text, Vec2,
};

use super::exr_header;
use super::image_part::{Attribute, ImagePart, Samples};

/// One row of one channel: part, channel and row.
pub type ChannelRow<'a> = (usize, &'a str, usize);

/// The bytes of a file with these parts, ZIP in blocks of 16 rows, data and display window both from (0, 0). Their
/// channels name types only; `fill` puts the bytes of a row, in the machine's order, into what it is given.
// Tested by `exr_parts_come_back_bit_for_bit` (tests/it/interchange/interchange_points.rs).
pub fn encode(parts: &[ImagePart], fill: impl Fn(ChannelRow, &mut [u8])) -> Result<Vec<u8>, String> {
    let headers = headers(parts)?;
    let names: Vec<Vec<&String>> = parts.iter().map(|part| part.channels.keys().collect()).collect();
    let mut out = Cursor::new(Vec::new());
    block::write(&mut out, headers, true, |meta, writer| {
        let mut compressor = writer.sequential_blocks_compressor(&meta);
        for (index, place) in enumerate_ordered_header_block_indices(&meta.headers) {
            let channels = &meta.headers[place.layer].channels;
            let block = UncompressedBlock::from_lines(channels, place, |line| {
                let at = line.location;
                fill((at.layer, names[at.layer][at.channel], at.position.y()), line.value);
            });
            compressor.compress_block(index, block)?;
        }
        Ok(())
    })
    .map_err(|e| e.to_string())?;
    let mut bytes = out.into_inner();
    exr_header::sort_attributes(&mut bytes)?;
    Ok(bytes)
}

/// The headers of a file with these parts.
pub(super) fn headers(parts: &[ImagePart]) -> Result<Headers, String> {
    let size = parts.first().map(|part| Vec2(part.width, part.height)).ok_or("no parts")?;
    let shared = ImageAttributes::new(IntegerBounds::from_dimensions(size));
    Ok(parts.iter().map(|part| header(part, &shared)).collect())
}

fn header(part: &ImagePart, shared: &ImageAttributes) -> Header {
    let channel = |(name, samples): (&String, &Samples)| {
        let kind = match samples {
            Samples::F32(_) => SampleType::F32,
            Samples::F16(_) => SampleType::F16,
            Samples::U32(_) => SampleType::U32,
        };
        ChannelDescription::named(text(name), kind)
    };
    let name = text(part.name.as_deref().unwrap_or_default());
    let layer_name = part.name.as_ref().map(|_| name.clone());
    let mut attributes = LayerAttributes { layer_name, ..LayerAttributes::default() };
    for (name, value) in &part.attributes {
        let value = match value {
            Attribute::Text(value) => AttributeValue::Text(text(value)),
            Attribute::Number(value) => AttributeValue::F64(*value),
        };
        attributes.other.insert(text(name), value);
    }
    Header::new(name, Vec2(part.width, part.height), part.channels.iter().map(channel).collect())
        .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing)
        .with_attributes(attributes)
        .with_shared_attributes(shared.clone())
}

fn text(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}
