//! Pictures of grey as height maps: TIFF of whole numbers or floats, and PNG of 8 or 16 bits. They know neither pitch nor unit:
//! one step of grey is `height_unit_um`. The first line is y = 0.

use std::io::Cursor;

use png::{BitDepth, ColorType, Transformations};
use tiff::decoder::{Decoder, DecodingResult, Limits};

use super::MapReader;
use super::raw::short;
use crate::error::Checked;
use crate::files::memory;
use crate::surface::io::samples::{MapSamples, Stored};

pub struct Tiff;
pub struct Png;

/// Bytes for each point: its number, its height and a copy of it, each 8 at most.
const NEEDED: u64 = 24;

impl MapReader for Tiff {
    fn name(&self) -> &'static str {
        "TIFF"
    }

    fn accepts(&self, bytes: &[u8]) -> bool {
        [&b"II*\0"[..], b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|begin| bytes.starts_with(begin))
    }

    fn needed(&self, bytes: &[u8]) -> Checked<u64> {
        let size = tiff(bytes).and_then(|mut file| file.dimensions().map_err(short));
        let (columns, rows) = size.map_err(|why| format!("TIFF: {why}"))?;
        Ok((u64::from(columns) * u64::from(rows)).saturating_mul(NEEDED))
    }

    fn read(&self, bytes: &[u8], _: Option<&str>) -> Checked<MapSamples> {
        Ok(read_tiff(bytes).map_err(|why| format!("TIFF: {why}"))?)
    }
}

fn tiff(bytes: &[u8]) -> Result<Decoder<Cursor<&[u8]>>, String> {
    // What is read was judged before.
    let decoder = Decoder::new(Cursor::new(bytes)).map_err(short)?;
    Ok(decoder.with_limits(Limits::unlimited()))
}

fn read_tiff(bytes: &[u8]) -> Result<MapSamples, String> {
    let mut file = tiff(bytes)?;
    let (columns, rows) = file.dimensions().map_err(short)?;
    match file.colortype().map_err(short)? {
        tiff::ColorType::Gray(8 | 16 | 32 | 64) => {}
        other => {
            return Err(format!("a picture of {other:?}; a height map has one grey of 8, 16, 32 or 64 bits"));
        }
    }
    if file.more_images() {
        return Err("several pictures; a height map has one".into());
    }
    memory::check(u64::from(columns) * u64::from(rows) * NEEDED).map_err(short)?;
    let floats = |values: Vec<f64>| (values, Stored::Exact);
    let (heights, stored) = match file.read_image().map_err(short)? {
        DecodingResult::U8(values) => (values.into_iter().map(f64::from).collect(), Stored::Byte),
        DecodingResult::I8(values) => (values.into_iter().map(f64::from).collect(), Stored::Byte),
        DecodingResult::U16(values) => floats(values.into_iter().map(f64::from).collect()),
        DecodingResult::I16(values) => floats(values.into_iter().map(f64::from).collect()),
        DecodingResult::U32(values) => floats(values.into_iter().map(f64::from).collect()),
        DecodingResult::I32(values) => floats(values.into_iter().map(f64::from).collect()),
        DecodingResult::F32(values) => (values.into_iter().map(f64::from).collect(), Stored::Single),
        DecodingResult::F64(values) => floats(values),
        _ => {
            return Err(
                "numbers of a type that is not read; save whole numbers of 16 bits or floats of 32".into()
            );
        }
    };
    picture("TIFF", columns, rows, heights, stored)
}

impl MapReader for Png {
    fn name(&self) -> &'static str {
        "PNG"
    }

    fn accepts(&self, bytes: &[u8]) -> bool {
        bytes.starts_with(b"\x89PNG\r\n\x1a\n")
    }

    fn needed(&self, bytes: &[u8]) -> Checked<u64> {
        let reader = png(bytes).map_err(|why| format!("PNG: {why}"))?;
        let info = reader.info();
        Ok((u64::from(info.width) * u64::from(info.height)).saturating_mul(NEEDED))
    }

    fn read(&self, bytes: &[u8], _: Option<&str>) -> Checked<MapSamples> {
        Ok(read_png(bytes).map_err(|why| format!("PNG: {why}"))?)
    }
}

fn png(bytes: &[u8]) -> Result<png::Reader<Cursor<&[u8]>>, String> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::IDENTITY);
    decoder.read_info().map_err(short)
}

fn read_png(bytes: &[u8]) -> Result<MapSamples, String> {
    let mut reader = png(bytes)?;
    let (width, height) = (reader.info().width, reader.info().height);
    let (colour, depth) = reader.output_color_type();
    if colour != ColorType::Grayscale || !matches!(depth, BitDepth::Eight | BitDepth::Sixteen) {
        return Err(format!(
            "a picture of {} with {} bits; a height map has one grey of 8 or 16 bits",
            if colour == ColorType::Grayscale { "greys" } else { "colours, a palette or transparency" },
            depth as u8
        ));
    }
    let size = reader.output_buffer_size().ok_or("too large")?;
    memory::check(u64::from(width) * u64::from(height) * NEEDED).map_err(short)?;
    let mut data: Vec<u8> = memory::room(size)?;
    data.resize(size, 0);
    reader.next_frame(&mut data).map_err(short)?;
    let (heights, stored) = if depth == BitDepth::Sixteen {
        let pairs = data.as_chunks::<2>().0.iter();
        (pairs.map(|two| f64::from(u16::from_be_bytes(*two))).collect(), Stored::Exact)
    } else {
        (data.iter().map(|byte| f64::from(*byte)).collect(), Stored::Byte)
    };
    picture("PNG", width, height, heights, stored)
}

fn picture(
    kind: &str,
    columns: u32,
    rows: u32,
    heights: Vec<f64>,
    stored: Stored,
) -> Result<MapSamples, String> {
    let (columns, rows) = (columns as usize, rows as usize);
    if columns.checked_mul(rows) != Some(heights.len()) {
        return Err(format!("{} points do not make {columns} x {rows}: the file is cut off", heights.len()));
    }
    let no_pitch = Some(format!("{kind}: a picture knows neither pitch nor unit of its heights"));
    Ok(MapSamples { no_pitch, ..MapSamples::new(columns, rows, heights, stored) })
}
