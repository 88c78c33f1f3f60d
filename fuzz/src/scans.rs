//! Files of height maps from bytes: the first says which of a format's beginnings the others follow, and an archive is a sound
//! one, so that no input is wasted on a file of no format.

use std::io::{Cursor, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// How the files of each target begin.
pub const BEGINNINGS: [(&str, &[&[u8]]); 5] = [
    ("map_gwy", &[b"GWYP"]),
    ("map_sur", &[b"DIGITAL SURF", b"DSCOMPRESSED"]),
    ("map_sdf", &[b"aISO-1.0", b"aISO-2.0", b"bISO-1.0", b"bISO-2.0", b"bBCR-1.0"]),
    ("map_zygo", &[b"\x88\x1b\x03\x6f", b"\x88\x1b\x03\x70", b"\x88\x1b\x03\x71"]),
    ("map_picture", &[b"II*\0", b"MM\0*", b"II+\0", b"MM\0+", b"\x89PNG\r\n\x1a\n"]),
];

/// The file that an input of a target stands for.
pub fn file(target: &str, input: &[u8]) -> Vec<u8> {
    if target == "map_x3p" {
        return archive(input);
    }
    let begins = BEGINNINGS.iter().find(|(name, _)| *name == target).expect("a target").1;
    let [which, rest @ ..] = input else { return Vec::new() };
    [begins[usize::from(*which) % begins.len()], rest].concat()
}

/// An X3P archive of a main document, as long as the first two bytes say, and of numbers.
fn archive(input: &[u8]) -> Vec<u8> {
    let (length, rest) = input.split_first_chunk().unwrap_or((&[0, 0], &[]));
    let (main, data) = rest.split_at(usize::from(u16::from_le_bytes(*length)).min(rest.len()));
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, bytes) in [("main.xml", main), ("bindata/data.bin", data), ("bindata/valid.bin", data)] {
        zip.start_file(name, stored).expect("in memory");
        zip.write_all(bytes).expect("in memory");
    }
    zip.finish().expect("in memory").into_inner()
}
