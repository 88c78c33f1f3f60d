//! What every target asks of a reader: an answer or a reason, never a panic; a reason is one line for a terminal.

pub mod scans;
pub mod traced;

use std::path::Path;

use gonio::error::{ContentError, Error};
use gonio::surface::io::map_file;

/// A reader's reason, as the program shows it.
pub fn reason<T>(answer: Result<T, impl Into<ContentError>>) {
    format(answer.map_err(|why| Error::format(path(), why)));
}

/// A verb's error about the file at hand: that of a wrong content, or of too little memory for it.
pub fn format<T>(answer: Result<T, Error>) -> Option<T> {
    match answer {
        Ok(value) => Some(value),
        Err(Error::Format { what, .. } | Error::Refused(what)) => {
            line(&what);
            None
        }
        Err(other) => panic!("not an error of the file: {other}"),
    }
}

fn line(why: &str) {
    assert!(!why.is_empty() && !why.contains('\n') && why.chars().count() <= 500, "{why:?}");
}

/// Memory that a map may take here, bytes.
const MOST_OF_A_MAP: u64 = 1 << 29;

/// Reads the map that an input stands for; what the program would refuse for want of memory is not read.
pub fn scan(target: &str, input: &[u8]) {
    let bytes = scans::file(target, input);
    match map_file::needed(&bytes) {
        Ok(needed) if needed > MOST_OF_A_MAP => {}
        Ok(_) => reason(map_file::read(&bytes)),
        Err(why) => reason(Err::<(), _>(why)),
    }
}

/// The path that messages name.
pub fn path() -> &'static Path {
    Path::new("fuzzed")
}

/// A file of `length` bytes that begins as `bytes` do and goes on with them over and over: for formats of one size.
pub fn filled(bytes: &[u8], length: usize) -> Vec<u8> {
    bytes.iter().copied().cycle().take(length).collect()
}
