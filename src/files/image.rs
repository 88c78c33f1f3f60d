//! EXR images in memory: one or more parts of scan lines.
//!
//! Input and output: bytes. The same parts give the same bytes, in every process. The codec never sees a path.

use std::io::{BufReader, Cursor, Read, Seek};
use std::path::Path;

use super::image_blocks::BlockReader;
pub use super::image_part::{Attribute, ImagePart, Samples};
use super::{image_rows, memory};
use crate::error::{Checked, Error, Result};

/// The bytes of a file with these parts, ZIP in blocks of 16 rows, data and display window both from (0, 0).
// Tested by `equal_tables_have_equal_bytes_whatever_the_hash_seed`.
pub fn encode(parts: Vec<ImagePart>) -> std::result::Result<Vec<u8>, String> {
    for part in &parts {
        let (width, height) = (part.width, part.height);
        let pixels = width * height;
        if let Some((name, samples)) =
            part.channels.iter().find(|(_, samples)| pixels == 0 || samples.len() != pixels)
        {
            return Err(format!("channel `{name}` has {} values for {width} x {height}", samples.len()));
        }
    }
    image_rows::encode(&parts, |(part, name, row), out| {
        let (samples, width) = (&parts[part].channels[name], parts[part].width);
        out.copy_from_slice(&samples.bytes(row * width..(row + 1) * width));
    })
}

/// The parts of a file, decoded block by block: in memory are the values and one block, never the file.
///
/// Refused is what does not fit the memory that may be used.
// Tested by `exports_of_a_large_table_stay_below_twice_its_memory`, tests/process/bombs.rs.
pub fn load(path: &Path) -> Result<Vec<ImagePart>> {
    let file = super::open(path)?;
    let blocks = BlockReader::open(BufReader::new(file)).map_err(|why| Error::format(path, why))?;
    memory::check_file(path, blocks.bytes())?;
    filled(blocks).map_err(|why| Error::format(path, why))
}

/// The parts in the bytes of a file.
///
/// Memory is bounded by what may be used, and by the file's size: a header that asks for more is refused first.
pub fn decode(bytes: &[u8]) -> Checked<Vec<ImagePart>> {
    let blocks = BlockReader::open(Cursor::new(bytes))?;
    memory::check(blocks.bytes())?;
    filled(blocks)
}

/// The only part in the bytes of a file.
pub fn decode_one(bytes: &[u8]) -> Checked<ImagePart> {
    let [part] = <[ImagePart; 1]>::try_from(decode(bytes)?).map_err(|_| "several parts, one needed")?;
    Ok(part)
}

fn filled(mut blocks: BlockReader<impl Read + Seek>) -> Checked<Vec<ImagePart>> {
    let mut parts = blocks.outlines().to_vec();
    for part in &mut parts {
        reserve(part)?;
    }
    for (index, part) in parts.iter_mut().enumerate() {
        for number in 0..blocks.count(index) {
            let block = blocks.read(index, number)?;
            for (name, _, values) in block.lines() {
                if let Some(samples) = part.channels.get_mut(name) {
                    samples.extend(values);
                }
            }
        }
    }
    Ok(parts)
}

/// Room for all values: better an error here than an abort later.
pub(crate) fn reserve(part: &mut ImagePart) -> std::result::Result<(), String> {
    let values = part.width.checked_mul(part.height).ok_or("more pixels than this machine can address")?;
    let room = |samples: &mut Samples| match samples {
        Samples::F32(list) => list.try_reserve_exact(values),
        Samples::F16(list) => list.try_reserve_exact(values),
        Samples::U32(list) => list.try_reserve_exact(values),
    };
    let channels = part.channels.len();
    match part.channels.values_mut().try_for_each(room) {
        Ok(()) => Ok(()),
        Err(_) => Err(format!("{channels} channels of {values} values do not fit into memory")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> ImagePart {
        let mut part = ImagePart { width: 5, height: 40, ..ImagePart::default() };
        let values = (0..200u16).map(|i| f32::from(i).sqrt()).collect();
        part.channels.insert("height".into(), Samples::F32(values));
        part.attributes.insert("pitch_x".into(), Attribute::Number(0.1));
        part.set_text("note", "µm, δ");
        part
    }

    #[test]
    fn a_part_round_trips_with_its_doubles_and_its_utf8() {
        let part = sample();
        let back = decode(&encode(vec![part.clone()]).expect("encodes")).expect("decodes");
        assert_eq!(back, vec![part]);
    }

    #[test]
    fn parts_keep_their_names_and_order() {
        let parts: Vec<ImagePart> =
            (0..3).rev().map(|i| ImagePart { name: Some(format!("p{i}")), ..sample() }).collect();
        let back = decode(&encode(parts.clone()).expect("encodes")).expect("decodes");
        assert_eq!(back, parts);
    }

    #[test]
    fn a_header_that_asks_for_more_than_the_file_holds_is_refused() {
        let mut bytes = encode(vec![sample()]).expect("encodes");
        let at = bytes.windows(10).position(|w| w == b"dataWindow").expect("is there") + 10 + 1 + 6 + 4;
        bytes[at + 8..at + 12].copy_from_slice(&((1u32 << 24) - 1).to_le_bytes());
        assert!(decode(&bytes).expect_err("too wide").to_string().contains("asks for"));
        bytes[at + 8..at + 12].copy_from_slice(&i32::MAX.to_le_bytes());
        assert!(decode(&bytes).expect_err("absurd").to_string().contains("dataWindow"));
    }

    #[test]
    fn two_headers_that_run_into_each_other_are_refused() {
        let part = |i: usize| ImagePart { name: Some(format!("p{i}")), ..sample() };
        let mut bytes = encode(vec![part(0), part(1)]).expect("encodes");
        // The zero byte between the headers becomes the first letter of one more attribute's name.
        let name = b"type\0string\0\x0d\0\0\0scanlineimage";
        let at = bytes.windows(name.len()).position(|w| w == name).expect("is there") + name.len();
        assert_eq!((bytes[at], bytes[at + 1]), (0, b'c'));
        bytes[at] = b'x';
        assert!(decode(&bytes).expect_err("fused").to_string().contains("is there twice"));
    }

    #[test]
    fn a_header_longer_than_the_first_look_is_read_whole() {
        let mut part = sample();
        part.set_text("long", &"µ".repeat(1 << 17));
        let back = decode(&encode(vec![part.clone()]).expect("encodes")).expect("decodes");
        assert_eq!(back, vec![part]);
    }

    #[test]
    fn rows_in_another_block_s_place_are_refused() {
        let mut bytes = encode(vec![sample()]).expect("encodes");
        let table = crate::files::exr_header::read(&mut Cursor::new(&bytes)).expect("a header").len();
        // 40 rows are three blocks; the first two change places, then both places name the first.
        let (first, second) = bytes[table..table + 16].split_at_mut(8);
        first.swap_with_slice(second);
        let why = decode(&bytes).expect_err("out of order").to_string();
        assert!(why.contains("rows from 16 lie in the place of block 0"), "{why}");
        bytes.copy_within(table + 8..table + 16, table);
        let why = decode(&bytes).expect_err("twice").to_string();
        assert!(why.contains("rows from 0 lie in the place of block 1"), "{why}");
    }

    #[test]
    fn tiled_and_deep_images_are_refused_by_name() {
        let mut bytes = encode(vec![sample()]).expect("encodes");
        bytes[5] = 0b0010;
        assert!(decode(&bytes).expect_err("tiled").to_string().contains("tiled"));
        bytes[5] = 0b1000;
        assert!(decode(&bytes).expect_err("deep").to_string().contains("deep"));
    }
}
