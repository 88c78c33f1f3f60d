//! What a foreign file takes in memory while it is read, judged before anything is made of it.
//!
//! Enters: the bytes of a file. Leaves: the most bytes that its reader may come to need: from the sizes that a binary file
//! claims, and from the lines and words that a text can hold. The numbers a word are measured with
//! tests/process/bombs.rs.

use std::io::Cursor;

use super::Reason;
use super::format::Format;
use super::numpy::npz;
use crate::files::image_blocks::BlockReader;
use crate::files::{exr_header, memory};

/// Bytes of a line of a list that is read: no heading of a list is longer.
pub const LONGEST_LINE: usize = 1 << 20;
/// Bytes that a sample of a list comes to take, with its place in the table.
const SAMPLE: u64 = 300;
/// Bytes that a value of a list comes to take, in the list and in the table.
const VALUE: u64 = 24;
/// Bytes that a pair of directions takes besides its values: its sample and its arrivals.
const PAIR: u64 = 12;
/// Bytes that a number of an XML file comes to take, and an element or a branch of a tree.
const NUMBER: u64 = 12;
const BRANCH: u64 = 100;
/// Bytes that a number of a Zemax file comes to take in its lists.
const LISTED: u64 = 64;
/// Copies of an image's values, in the table and on the way to it.
const COPIES: u64 = 10;

/// The most bytes of memory that reading these bytes may take, besides themselves.
///
/// Held by: tests/process/bombs.rs.
pub fn needed(format: Format, bytes: &[u8]) -> Reason<u64> {
    let length = bytes.len() as u64;
    Ok(match format {
        Format::Npz => npz::needed(bytes)?,
        Format::ExrParts | Format::Utia if exr_header::is_exr(bytes) => COPIES.saturating_mul(image(bytes)?),
        Format::Csv | Format::Astm => list(bytes)?,
        Format::Ssdd if is_binary(bytes) => 12 * length,
        Format::Ssdd => list(bytes)?,
        Format::Klems | Format::TensorTree => {
            let branches = bytes.iter().filter(|byte| matches!(byte, b'{' | b'<')).count() as u64;
            4 * length + NUMBER * memory::words(bytes) + BRANCH * branches
        }
        Format::Zemax => 4 * length + LISTED * memory::words(bytes),
        Format::Rgl => 6 * length,
        Format::Merl | Format::Utia | Format::ExrParts | Format::Npy | Format::Pabopto => 4 * length,
    })
}

/// Of an EXR image.
pub fn image(bytes: &[u8]) -> Reason<u64> {
    Ok(BlockReader::open(Cursor::new(bytes))?.bytes())
}

/// Of a table that is made whatever the length of its file: of a list with gaps, or of a function on a grid.
pub fn table(pairs: usize, colours: usize) -> u64 {
    (pairs as u64).saturating_mul(PAIR + VALUE * colours as u64)
}

/// Of a text with a sample a line.
fn list(bytes: &[u8]) -> Reason<u64> {
    let (lines, longest) = memory::lines(bytes);
    if longest > LONGEST_LINE {
        return Err(format!("a line of {longest} bytes; at most {LONGEST_LINE} are read"));
    }
    Ok(4 * bytes.len() as u64 + SAMPLE * lines + VALUE * memory::words(bytes))
}

/// Whether an SSDD file goes on in binary: no line of a text has anything else behind this.
fn is_binary(bytes: &[u8]) -> bool {
    let begins = |line: &[u8]| {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        words.next() == Some(b"DATA") && words.next() == Some(b"binary")
    };
    bytes.split(|&byte| byte == b'\n').any(begins)
}
