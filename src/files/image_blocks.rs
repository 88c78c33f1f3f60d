//! EXR images block by block: the header first, then the rows of any block, from a file of any size.
//!
//! Nothing that a file says of itself is believed before it is checked. The codec checks most of what it reads;
//! should a damaged file still trip one of its assertions, that is an error of the file too.

use std::collections::BTreeMap;
use std::io::{Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};

use exr::block::UncompressedBlock;
use exr::block::chunk::Chunk;
use exr::meta::MetaData;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use exr::prelude::{AttributeValue, Text};

use super::image_part::{Attribute, ImagePart, Samples};
use super::{exr_header, memory};
use crate::error::Checked;

/// Copies of a block that the decoder holds at once: packed, unpacked, and in the order of its bytes.
const COPIES: u64 = 3;

/// A file of which the header was read.
pub struct BlockReader<R> {
    source: R,
    meta: MetaData,
    outlines: Vec<ImagePart>,
    /// Channels of every part, in the order of a row.
    names: Vec<Vec<String>>,
    /// Where the blocks of every part begin, by rows.
    offsets: Vec<Vec<u64>>,
}

/// Some rows of a part.
pub struct RowBlock<'a> {
    header: &'a Header,
    content: UncompressedBlock,
    names: &'a [String],
}

impl<R: Read + Seek> BlockReader<R> {
    /// Reads and checks the header.
    pub fn open(mut source: R) -> Checked<Self> {
        let head = exr_header::read(&mut source)?;
        let meta = guarded(|| MetaData::read_from_buffered(head.as_slice(), true))?;
        let block = meta.headers.iter().map(block_bytes).max().unwrap_or(0);
        memory::check(COPIES.saturating_mul(block)).map_err(|why| why.at("its rows are too wide"))?;
        let outlines = meta.headers.iter().map(outline).collect::<Result<Vec<_>, String>>()?;
        let names = meta.headers.iter().map(names).collect();
        source.seek(SeekFrom::Start(head.len() as u64)).map_err(|e| damaged(&e))?;
        let tables = meta.headers.iter().map(|header| offsets(&mut source, header));
        let offsets = tables.collect::<Result<_, String>>()?;
        Ok(BlockReader { source, meta, outlines, names, offsets })
    }

    /// Bytes that decoding takes: all values and the copies of a block.
    pub fn bytes(&self) -> u64 {
        let values = |header: &Header| row_bytes(header).saturating_mul(header.layer_size.height() as u64);
        let all = self.meta.headers.iter().fold(0u64, |sum, header| sum.saturating_add(values(header)));
        let block = self.meta.headers.iter().map(block_bytes).max().unwrap_or(0);
        all.saturating_add(COPIES.saturating_mul(block))
    }

    /// The parts without their values: every channel names its type alone.
    pub fn outlines(&self) -> &[ImagePart] {
        &self.outlines
    }

    /// How many blocks a part has.
    pub fn count(&self, part: usize) -> usize {
        self.offsets[part].len()
    }

    /// Rows in each block of a part; the last one may have fewer.
    pub fn rows(&self, part: usize) -> usize {
        rows_per_block(&self.meta.headers[part])
    }

    /// Decodes a block. It must be the one that its place in the file says: no row twice, none missing.
    pub fn read(&mut self, part: usize, number: usize) -> Result<RowBlock<'_>, String> {
        self.source.seek(SeekFrom::Start(self.offsets[part][number])).map_err(|e| damaged(&e))?;
        let (source, meta) = (&mut self.source, &self.meta);
        let decode = || UncompressedBlock::decompress_chunk(Chunk::read(source, meta)?, meta, true);
        let content = guarded(decode)?;
        let header = &self.meta.headers[part];
        let row = content.index.pixel_position.y();
        if content.index.layer != part || row != number * rows_per_block(header) {
            return Err(format!(
                "damaged: rows from {row} lie in the place of block {number} of part {part}"
            ));
        }
        let names = &self.names[part];
        Ok(RowBlock { header, content, names })
    }
}

impl RowBlock<'_> {
    /// The rows of every channel: its name, the row, and the values in the machine's order of bytes.
    pub fn lines(&self) -> impl Iterator<Item = (&str, usize, &[u8])> {
        self.content.lines(&self.header.channels).map(|line| {
            let at = line.location;
            (self.names[at.channel].as_str(), at.position.y(), line.value)
        })
    }
}

fn guarded<T>(decode: impl FnOnce() -> exr::error::Result<T>) -> Result<T, String> {
    let decoded = catch_unwind(AssertUnwindSafe(decode)).map_err(|_| "damaged: the decoder gave up")?;
    decoded.map_err(|e| damaged(&e))
}

fn damaged(why: &dyn std::fmt::Display) -> String {
    format!("damaged or cut off: {why}")
}

/// Bytes of a row.
fn row_bytes(header: &Header) -> u64 {
    (header.channels.bytes_per_pixel as u64).saturating_mul(header.layer_size.width() as u64)
}

/// Bytes of a block of rows.
fn block_bytes(header: &Header) -> u64 {
    let rows = rows_per_block(header).min(header.layer_size.height());
    row_bytes(header).saturating_mul(rows as u64)
}

fn rows_per_block(header: &Header) -> usize {
    header.compression.scan_lines_per_block()
}

/// The table of a part's blocks; it lies in the file in the order of the rows, whatever the order of the blocks.
fn offsets(source: &mut impl Read, header: &Header) -> Result<Vec<u64>, String> {
    let wanted = header.layer_size.height().div_ceil(rows_per_block(header));
    if header.chunk_count != wanted {
        return Err(format!("damaged: {} blocks, {wanted} needed", header.chunk_count));
    }
    let mut bytes = Vec::new();
    source.take(8 * wanted as u64).read_to_end(&mut bytes).map_err(|e| damaged(&e))?;
    let offsets = bytes.as_chunks::<8>().0.iter().map(|eight| u64::from_le_bytes(*eight));
    let offsets: Vec<u64> = offsets.collect();
    if offsets.len() == wanted { Ok(offsets) } else { Err(damaged(&"the table of blocks has no end")) }
}

fn name_of(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

fn names(header: &Header) -> Vec<String> {
    header.channels.list.iter().map(|channel| name_of(&channel.name)).collect()
}

/// A part without its values.
fn outline(header: &Header) -> Result<ImagePart, String> {
    let mut channels = BTreeMap::new();
    for channel in &header.channels.list {
        let name = name_of(&channel.name);
        let samples = match channel.sample_type {
            SampleType::F32 => Samples::F32(vec![]),
            SampleType::F16 => Samples::F16(vec![]),
            SampleType::U32 => Samples::U32(vec![]),
        };
        if channels.insert(name.clone(), samples).is_some() {
            return Err(format!("channel `{name}` is there twice"));
        }
    }
    let own = &header.own_attributes;
    let value = |value: &AttributeValue| match value {
        AttributeValue::Text(text) => Some(Attribute::Text(name_of(text))),
        AttributeValue::F64(number) => Some(Attribute::Number(*number)),
        AttributeValue::F32(number) => Some(Attribute::Number(f64::from(*number))),
        AttributeValue::I32(number) => Some(Attribute::Number(f64::from(*number))),
        _ => None,
    };
    let attributes = own.other.iter().filter_map(|(name, given)| Some((name_of(name), value(given)?)));
    Ok(ImagePart {
        name: own.layer_name.as_ref().map(name_of),
        width: header.layer_size.width(),
        height: header.layer_size.height(),
        channels,
        attributes: attributes.collect(),
    })
}
