//! EXR images row by row: parts whose pixels lie elsewhere are written, and are read, without a copy of them.

use std::io::{BufRead, Cursor, Seek};

use exr::block::reader::ChunksReader;
use exr::block::writer::ChunksWriter;
use exr::block::{self, UncompressedBlock, enumerate_ordered_header_block_indices};
use exr::meta::attribute::{ChannelDescription, LineOrder, SampleType};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, Headers};
use exr::prelude::{AttributeValue, Compression, ImageAttributes, IntegerBounds, LayerAttributes, Vec2};

use super::exr_header;
use super::image::{Attribute, ImagePart, Samples, text};

/// One row of one channel: part, channel and row.
pub type ChannelRow<'a> = (usize, &'a str, usize);

/// The bytes of a file with these parts, as [`super::image::encode`] makes them. Their channels name types only;
/// `fill` puts the values of a row, four bytes each in the machine's order, into what it is given.
///
/// Held by: `exr_parts_come_back_bit_for_bit` (tests/it/interchange/interchange_points.rs).
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

/// Visits the rows of a file that this program has just written; `number` is an attribute that every part has, its value
/// takes the part's place. The values are four bytes each in the machine's order.
pub fn each_row(
    file: impl BufRead + Seek,
    number: &str,
    mut visit: impl FnMut((f64, &str, usize), &[u8]) -> Result<(), String>,
) -> Result<(), String> {
    let wrong = |e: exr::error::Error| e.to_string();
    let reader = block::read(file, true).map_err(wrong)?;
    let mut numbers = Vec::new();
    for header in reader.headers() {
        match header.own_attributes.other.get(&text(number)) {
            Some(AttributeValue::F64(value)) => numbers.push(*value),
            _ => return Err(format!("a part without {number}")),
        }
    }
    let mut blocks = reader.all_chunks(true).map_err(wrong)?.sequential_decompressor(true);
    while let Some(block) = blocks.decompress_next_block() {
        let block = block.map_err(wrong)?;
        let channels = &blocks.meta_data().headers[block.index.layer].channels;
        for line in block.lines(channels) {
            let name = channels.list[line.location.channel].name.to_string();
            visit((numbers[line.location.layer], &name, line.location.position.y()), line.value)?;
        }
    }
    Ok(())
}
