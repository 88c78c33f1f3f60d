//! The header of an EXR file as plain bytes: put into a fixed order when written, checked before it is decoded.
//!
//! The decoder keeps custom attributes in a hash map of random order and allocates what a header asks for; both
//! are settled here. Layout: magic, version and flags, then per part a run of attributes (name, type, size,
//! value) ended by a zero byte; with several parts one more zero byte ends the list.

use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;

pub(crate) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
const FLAG_TILED: u32 = 1 << 9;
const FLAG_DEEP: u32 = 1 << 11;
const FLAG_PARTS: u32 = 1 << 12;
/// Largest width and height, and largest |coordinate| of a window's corner.
const MAX_SIDE: i64 = 1 << 24;
/// Deflate shrinks at most 1032-fold, after PXR24 has dropped a quarter; the other common methods shrink less.
const MAX_RATIO: u64 = 1400;
const MAX_CHANNELS: usize = 1024;
/// More attributes than any file has in all its parts; the decoder takes a few hundred bytes for each.
const MOST_ATTRIBUTES: usize = 1 << 18;
/// The longest header that is read, bytes; and how much of a file is looked at first.
const MAX_HEADER: u64 = 1 << 26;
const FIRST_LOOK: u64 = 1 << 16;

/// Whether the bytes start as an EXR file does.
pub fn is_exr(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC)
}

/// One attribute: where it lies in the file.
struct AttributeRange {
    name: Range<usize>,
    kind: Range<usize>,
    value: Range<usize>,
}

impl AttributeRange {
    fn whole(&self) -> Range<usize> {
        self.name.start..self.value.end
    }
}

/// Sorts the attributes of every part by name.
///
/// The header keeps its length, so the offsets that follow stay right.
pub fn sort_attributes(file: &mut [u8]) -> Result<(), String> {
    for part in parts(file)?.0 {
        let (Some(first), Some(last)) = (part.first(), part.last()) else { continue };
        let span = first.name.start..last.value.end;
        let mut ranges: Vec<_> = part.iter().collect();
        ranges.sort_by(|a, b| file[a.name.clone()].cmp(&file[b.name.clone()]));
        let sorted: Vec<u8> = ranges.iter().flat_map(|a| file[a.whole()].iter().copied()).collect();
        file[span].copy_from_slice(&sorted);
    }
    Ok(())
}

/// The bytes of a file's header, from the magic number to where the table of its blocks begins.
///
/// Refused is what must not reach the decoder: tiles, deep data, subsampling, and sizes that the file cannot hold.
pub fn read(source: &mut (impl Read + Seek)) -> Result<Vec<u8>, String> {
    let failed = |e: std::io::Error| format!("cannot be read: {e}");
    let length = source.seek(SeekFrom::End(0)).map_err(failed)?;
    let mut look = FIRST_LOOK;
    loop {
        let mut head = Vec::new();
        source.rewind().and_then(|()| source.take(look).read_to_end(&mut head)).map_err(failed)?;
        match parts(&head) {
            Ok((parts, end)) => {
                check(&head, &parts, length)?;
                head.truncate(end);
                return Ok(head);
            }
            // Perhaps the rest of the header comes after what was looked at.
            Err(_) if is_exr(&head) && look < length.min(MAX_HEADER) => look *= 8,
            Err(_) if is_exr(&head) && look < length => {
                return Err(format!("the header is longer than {} MiB, or damaged", MAX_HEADER >> 20));
            }
            Err(why) => return Err(why),
        }
    }
}

/// Where the header ends in a file's bytes.
pub fn end(file: &[u8]) -> Result<usize, String> {
    parts(file).map(|(_, end)| end)
}

fn check(file: &[u8], parts: &[Vec<AttributeRange>], length: u64) -> Result<(), String> {
    let flags = read_u32(file, 4)?;
    if flags & FLAG_TILED != 0 {
        return Err("tiled images are not read; save it as scan lines".into());
    }
    if flags & FLAG_DEEP != 0 {
        return Err("deep images are not read".into());
    }
    let mut pixel_bytes: u64 = 0;
    for part in parts {
        pixel_bytes = pixel_bytes.saturating_add(check_part(file, part)?);
    }
    let most = MAX_RATIO.saturating_mul(length);
    if pixel_bytes > most {
        return Err(format!(
            "the header asks for {pixel_bytes} bytes of pixels, but a file of {length} bytes cannot hold more than \
             {most}"
        ));
    }
    Ok(())
}

/// Bytes of the part's pixels.
fn check_part(file: &[u8], part: &[AttributeRange]) -> Result<u64, String> {
    // Of two equal names the decoder would believe the last: what is checked here must be what is decoded.
    let mut names: Vec<&[u8]> = part.iter().map(|a| &file[a.name.clone()]).collect();
    names.sort_unstable();
    if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(format!("attribute `{}` is there twice", String::from_utf8_lossy(twice[0])));
    }
    let find = |name: &str, kind: &str| {
        part.iter()
            .find(|a| &file[a.name.clone()] == name.as_bytes() && &file[a.kind.clone()] == kind.as_bytes())
            .map(|a| &file[a.value.clone()])
    };
    let need = |name, kind| find(name, kind).ok_or_else(|| format!("the header has no `{name}`"));
    if let Some(kind) = find("type", "string")
        && kind != b"scanlineimage"
    {
        return Err(format!("parts of type `{}` are not read", String::from_utf8_lossy(kind)));
    }
    window(need("displayWindow", "box2i")?, "displayWindow")?;
    let [width, height] = window(need("dataWindow", "box2i")?, "dataWindow")?;
    let pixel = channel_bytes(need("channels", "chlist")?)?;
    Ok(width.saturating_mul(height).saturating_mul(pixel))
}

/// Width and height of a window.
fn window(value: &[u8], name: &str) -> Result<[u64; 2], String> {
    let corner = |at: usize| read_u32(value, at).map(|bits| i64::from(bits.cast_signed()));
    let (x0, y0, x1, y1) = (corner(0)?, corner(4)?, corner(8)?, corner(12)?);
    let sane = |lo: i64, hi: i64| lo.abs() <= MAX_SIDE && hi.abs() <= MAX_SIDE && lo <= hi;
    if value.len() != 16 || !sane(x0, x1) || !sane(y0, y1) {
        return Err(format!("`{name}` runs from ({x0}, {y0}) to ({x1}, {y1})"));
    }
    Ok([(x1 - x0 + 1).unsigned_abs(), (y1 - y0 + 1).unsigned_abs()])
}

/// Bytes of one pixel; channels are (name, type, linear flag and padding, x and y sampling), then a zero byte.
fn channel_bytes(list: &[u8]) -> Result<u64, String> {
    let (mut at, mut sum, mut count) = (0, 0, 0);
    while *list.get(at).ok_or("the channel list has no end")? != 0 {
        let name = text(list, at, "channel name")?;
        let label = String::from_utf8_lossy(&list[name.clone()]).into_owned();
        let after = name.end + 1;
        sum += match read_u32(list, after)? {
            1 => 2,
            0 | 2 => 4,
            other => return Err(format!("channel `{label}` has the unknown type {other}")),
        };
        if (read_u32(list, after + 8)?, read_u32(list, after + 12)?) != (1, 1) {
            return Err(format!("channel `{label}` is subsampled"));
        }
        at = after + 16;
        count += 1;
        if count > MAX_CHANNELS {
            return Err(format!("more than {MAX_CHANNELS} channels"));
        }
    }
    if count == 0 { Err("no channels".into()) } else { Ok(sum) }
}

/// The attributes of each part, in file order, and where the header ends.
fn parts(file: &[u8]) -> Result<(Vec<Vec<AttributeRange>>, usize), String> {
    if !is_exr(file) {
        return Err(if file.is_empty() { "the file is empty" } else { "not an EXR file" }.into());
    }
    let several = read_u32(file, 4)? & FLAG_PARTS != 0;
    let (mut at, mut parts, mut count) = (8, Vec::new(), 0);
    loop {
        let mut part = Vec::new();
        while byte(file, at)? != 0 {
            let attribute = attribute(file, at)?;
            at = attribute.value.end;
            part.push(attribute);
            count += 1;
            if count > MOST_ATTRIBUTES {
                return Err(format!("more than {MOST_ATTRIBUTES} attributes"));
            }
        }
        at += 1;
        parts.push(part);
        if !several {
            return Ok((parts, at));
        }
        if byte(file, at)? == 0 {
            return Ok((parts, at + 1));
        }
    }
}

fn attribute(file: &[u8], at: usize) -> Result<AttributeRange, String> {
    let name = text(file, at, "attribute name")?;
    let kind = text(file, name.end + 1, "attribute type")?;
    let size = read_u32(file, kind.end + 1)? as usize;
    let start = kind.end + 5;
    let value = start..start.saturating_add(size);
    if value.end > file.len() {
        let name = String::from_utf8_lossy(&file[name]).into_owned();
        return Err(format!("attribute `{name}` claims {size} bytes, more than the file has"));
    }
    Ok(AttributeRange { name, kind, value })
}

/// A text of 1 to 255 bytes ended by a zero byte.
fn text(bytes: &[u8], at: usize, what: &str) -> Result<Range<usize>, String> {
    let rest = bytes.get(at..).unwrap_or_default();
    match rest.iter().take(256).position(|&b| b == 0) {
        Some(length) if length > 0 => Ok(at..at + length),
        _ => Err(format!("{what} at byte {at} is empty, too long or cut off")),
    }
}

fn byte(bytes: &[u8], at: usize) -> Result<u8, String> {
    bytes.get(at).copied().ok_or_else(|| "the header is cut off".into())
}

fn read_u32(bytes: &[u8], at: usize) -> Result<u32, String> {
    let four = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>()).ok_or("the header is cut off")?;
    Ok(u32::from_le_bytes(*four))
}
