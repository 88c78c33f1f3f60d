//! The lines of an SSDD file, which may go on with numbers in binary.

use std::io::BufRead;

use crate::interchange::Checked;
use crate::text_decoding::decode_text_or_latin1;

/// The lines of a file that are not empty, without comments and the space round them, and their numbers.
pub struct NumberLines<R> {
    /// Stands behind the last line that was read.
    pub file: R,
    number: usize,
}

impl<R: BufRead> NumberLines<R> {
    pub fn of(file: R) -> Self {
        NumberLines { file, number: 0 }
    }

    /// The next of them; comments may be of any characters.
    pub fn next(&mut self) -> Checked<Option<(usize, String)>> {
        let mut bytes = Vec::new();
        while self.file.read_until(b'\n', &mut bytes).map_err(|e| e.to_string())? > 0 {
            self.number += 1;
            let line = decode_text_or_latin1(&bytes).map_err(|why| format!("line {}: {why}", self.number))?;
            let line = without_comment(&line).trim();
            if !line.is_empty() {
                return Ok(Some((self.number, line.to_string())));
            }
            bytes.clear();
        }
        Ok(None)
    }
}

/// What stands before `#` and a space, or before a `#` that begins or ends the line.
fn without_comment(line: &str) -> &str {
    let begins = |&(at, _): &(usize, &str)| {
        let rest = &line[at + 1..];
        line[..at].trim().is_empty() || rest.is_empty() || rest.starts_with(char::is_whitespace)
    };
    line.match_indices('#').find(begins).map_or(line, |(at, _)| &line[..at])
}
