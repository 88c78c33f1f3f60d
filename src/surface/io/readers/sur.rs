//! Surfaces of Digital Surf (`.sur`): a header of 512 bytes, a comment, and whole numbers of 16 or 32 bits, plain or
//! deflated.
//!
//! Height = number x z spacing, in the unit of that spacing; points that were not measured are the smallest number less 2.
//! A compressed file has the number of its streams, two lengths for each (inflated, deflated), and the streams. Source: the
//! layout that the readers of `surfalize` and of Gwyddion share.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::MapReader;
use super::raw::{Number, at, short, text};
use crate::error::Checked;
use crate::files::memory;
use crate::surface::io::samples::{MapSamples, Stored};

const PLAIN: &[u8] = b"DIGITAL SURF";
const COMPRESSED: &[u8] = b"DSCOMPRESSED";
/// Length of the header before the comment.
const HEADER: usize = 512;
/// Deflate shrinks at most 1032-fold.
const MAX_RATIO: u64 = 1032;
/// Streams of a compressed file at most: writers make one.
const MOST_STREAMS: usize = 1024;

pub struct Sur;

impl MapReader for Sur {
    fn name(&self) -> &'static str {
        "SUR"
    }

    fn accepts(&self, bytes: &[u8]) -> bool {
        bytes.starts_with(PLAIN) || bytes.starts_with(COMPRESSED)
    }

    fn needed(&self, bytes: &[u8]) -> Checked<u64> {
        let header = Header::of(bytes).map_err(|why| format!("SUR: {why}"))?;
        // The numbers, their heights, and a copy of these.
        Ok((header.columns as u64).saturating_mul(header.rows as u64).saturating_mul(4 + 16))
    }

    fn read(&self, bytes: &[u8], _: Option<&str>) -> Checked<MapSamples> {
        Ok(read(bytes).map_err(|why| format!("SUR: {why}"))?)
    }
}

/// What a header says.
struct Header {
    objects: u16,
    columns: usize,
    rows: usize,
    number: Number,
    /// The number of points without data, where there may be any.
    missing: Option<f64>,
    /// Where the data begin.
    start: usize,
}

impl Header {
    fn of(bytes: &[u8]) -> Result<Self, String> {
        let short = |place: usize, what: &str| at(bytes, place, what).map(i16::from_le_bytes);
        let long = |place: usize, what: &str| at(bytes, place, what).map(i32::from_le_bytes);
        // Profiles, surfaces, and surfaces with pictures; some writers call a surface a profile.
        match short(18, "its kind")? {
            1 | 2 | 11 | 13 | 16 => {}
            5 => return Err("a series of surfaces; save one of them".into()),
            kind => {
                return Err(format!("an object of kind {kind}, no surface (2); save the topography alone"));
            }
        }
        let number = match short(98, "its number of bits")? {
            16 => Number::I16,
            32 => Number::I32,
            bits => return Err(format!("{bits} bits a point; 16 and 32 are read")),
        };
        let count = |place: usize, what: &str| {
            let count = long(place, what)?;
            usize::try_from(count).ok().filter(|count| *count > 0).ok_or_else(|| format!("{count} {what}"))
        };
        let (columns, rows) = (count(108, "points in a line")?, count(112, "lines")?);
        if rows == 1 {
            return Err("a single profile; a height map has several".into());
        }
        let lowest = f64::from(long(100, "its smallest point")?);
        let missing = (short(86, "its gaps")? == 1).then_some(lowest - 2.0);
        let zone = |place: usize| at(bytes, place, "its comment").map(u16::from_le_bytes).map(usize::from);
        let start = HEADER + zone(334)? + zone(336)?;
        let objects = u16::from_le_bytes(at(bytes, 14, "its objects")?);
        Ok(Header { objects, columns, rows, number, missing, start })
    }
}

fn read(bytes: &[u8]) -> Result<MapSamples, String> {
    let header = Header::of(bytes)?;
    let spacing = |axis: usize| {
        at(bytes, 120 + 4 * axis, "its spacings").map(|four| f64::from(f32::from_le_bytes(four)))
    };
    let [x, y, z] = [spacing(0)?, spacing(1)?, spacing(2)?];
    let [unit_x, unit_y, unit_z] = [0, 1, 2].map(|axis| text(bytes, 180 + 16 * axis, 16));
    if !(z != 0.0 && z.is_finite()) {
        return Err(format!("z spacing {z}: must be finite and not 0"));
    }
    let length = header.columns.saturating_mul(header.rows).saturating_mul(header.number.size());
    let data = bytes.get(header.start..).unwrap_or_default();
    let inflated;
    let data = if bytes.starts_with(COMPRESSED) {
        inflated = inflate(data, length)?;
        &inflated[..]
    } else {
        // Behind the first object others may follow.
        &data[..length.min(data.len())]
    };
    let to = |number: f64| if Some(number) == header.missing { f64::NAN } else { z * number };
    let heights = header.number.read(data, [header.columns, header.rows], to)?;
    let mut map = MapSamples::new(header.columns, header.rows, heights, Stored::Exact);
    if header.objects > 1 {
        map.notes.push(format!("SUR: the first of {} objects is read", header.objects));
    }
    Ok(map.with_units("SUR", [x, y], [&unit_x, &unit_y], &unit_z))
}

/// The streams of a compressed file, together `length` bytes.
fn inflate(data: &[u8], length: usize) -> Result<Vec<u8>, String> {
    let long = |place: usize| at(data, place, "its streams").map(|four| u32::from_le_bytes(four) as usize);
    let streams = long(0)?;
    if streams > MOST_STREAMS {
        return Err(format!("{streams} streams; at most {MOST_STREAMS} are read"));
    }
    if length as u64 > MAX_RATIO.saturating_mul(data.len() as u64) {
        return Err(format!("claims {length} bytes of heights, more than the file can hold"));
    }
    let mut all = memory::room(length)?;
    let mut place = 4 + 8 * streams;
    for stream in 0..streams {
        let deflated = long(8 + 8 * stream)?;
        let bytes = data.get(place..).unwrap_or_default();
        let bytes = &bytes[..deflated.min(bytes.len())];
        // No more than the header promises, and one byte that tells of it.
        let rest = (length + 1).saturating_sub(all.len()) as u64;
        let inflating = ZlibDecoder::new(bytes).take(rest).read_to_end(&mut all);
        inflating.map_err(|why| format!("stream {}: {}", stream + 1, short(why)))?;
        place = place.saturating_add(deflated);
    }
    Ok(all)
}
