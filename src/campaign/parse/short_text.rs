//! Short texts beside a campaign: lists of numbers, of which none is longer than 1 MiB.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::text_decoding::decode_text_or_latin1;

const LARGEST_FILE: u64 = 1 << 20;

/// The text of a file; the error is a reason. `list`: what it should be, for the reason that a longer file gets.
pub fn read(path: &Path, list: &str) -> Result<String, String> {
    let failed = |e: std::io::Error| format!("cannot be read: {e}");
    // A pipe might never begin.
    if !std::fs::metadata(path).map_err(failed)?.is_file() {
        return Err("cannot be read: is not a regular file".into());
    }
    let file = File::open(path).map_err(failed)?;
    let mut bytes = Vec::new();
    file.take(LARGEST_FILE + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(format!("is larger than 1 MiB; this is no {list}"));
    }
    let text = decode_text_or_latin1(&bytes)?;
    if text.contains('\0') { Err("is no text".into()) } else { Ok(text.into_owned()) }
}
