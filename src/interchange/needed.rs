//! What a foreign file takes in memory while it is read, judged before anything is made of it.
//!
//! Input: the bytes of a file. Output: the most bytes that its reader may come to need, from the sizes that a binary
//! file claims, and from the lines and words that a text can hold. The numbers of bytes are measured with
//! tests/process/bombs.rs.

use std::io::Cursor;

use crate::error::{Checked, wrong};
use crate::files::image_blocks::BlockReader;
use crate::files::memory;

/// Bytes of a line of a list that is read: no header of a list is longer.
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

/// Of an XML file of Radiance.
pub fn xml(bytes: &[u8]) -> u64 {
    let branches = bytes.iter().filter(|byte| matches!(byte, b'{' | b'<')).count() as u64;
    4 * bytes.len() as u64 + NUMBER * memory::words(bytes) + BRANCH * branches
}

/// Of a text that is a list of numbers.
pub fn numbers(bytes: &[u8]) -> u64 {
    4 * bytes.len() as u64 + LISTED * memory::words(bytes)
}

/// Of an EXR image.
pub fn image(bytes: &[u8]) -> Checked<u64> {
    Ok(BlockReader::open(Cursor::new(bytes))?.bytes())
}

/// Of an EXR image that becomes a table.
pub fn image_table(bytes: &[u8]) -> Checked<u64> {
    Ok(COPIES.saturating_mul(image(bytes)?))
}

/// Of a table that is made whatever the length of its file: of a list with gaps, or of a function on a grid.
pub fn table(pairs: usize, colours: usize) -> u64 {
    (pairs as u64).saturating_mul(PAIR + VALUE * colours as u64)
}

/// Of a text with a sample a line.
pub fn list(bytes: &[u8]) -> Checked<u64> {
    let (lines, longest) = memory::lines(bytes);
    if longest > LONGEST_LINE {
        return Err(wrong!("a line of {longest} bytes; at most {LONGEST_LINE} are read"));
    }
    Ok(4 * bytes.len() as u64 + SAMPLE * lines + VALUE * memory::words(bytes))
}
