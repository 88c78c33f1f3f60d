//! What is read: a regular file, or all of stdin.

use std::fs::{self, File};
use std::io::{self, Cursor, ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::OnceLock;

use super::memory::memory_limit;

/// The name of stdin, and of stdout, on a command line.
pub const STANDARD: &str = "-";

/// What stdin held, once it was asked for.
static STDIN: OnceLock<Vec<u8>> = OnceLock::new();

/// An open file, or stdin in memory, where it can be read again.
pub enum Input {
    /// A regular file.
    File(File),
    /// All of stdin.
    Stdin(Cursor<&'static [u8]>),
}

impl Input {
    /// Opens a regular file, or stdin for [`STANDARD`]; other pipes and devices, which might never end, are refused. Whoever
    /// refuses what has more than `most` bytes gets no more than one byte more of stdin.
    pub(super) fn open(path: &Path, most: u64) -> io::Result<Self> {
        if path == Path::new(STANDARD) {
            return Ok(Input::Stdin(Cursor::new(stdin(most)?)));
        }
        if !fs::metadata(path)?.is_file() {
            return Err(io::Error::new(ErrorKind::InvalidInput, "is not a regular file"));
        }
        File::open(path).map(Input::File)
    }

    /// Bytes from its beginning to its end.
    pub fn length(&self) -> io::Result<u64> {
        match self {
            Input::File(file) => file.metadata().map(|meta| meta.len()),
            Input::Stdin(bytes) => Ok(bytes.get_ref().len() as u64),
        }
    }
}

/// All of stdin, or its first `wanted` bytes and one more; it is read once.
fn stdin(wanted: u64) -> io::Result<&'static [u8]> {
    if STDIN.get().is_none() {
        // Half: a vector that grows is copied.
        let room = memory_limit() / 2;
        let mut bytes = Vec::new();
        io::stdin().lock().take(wanted.min(room).saturating_add(1)).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > room {
            let why = format!("stdin has more than the {} MiB that may be used; give a file", room >> 20);
            return Err(io::Error::new(ErrorKind::OutOfMemory, why));
        }
        STDIN.get_or_init(|| bytes);
    }
    Ok(STDIN.get().map_or(&[], Vec::as_slice))
}

impl Read for Input {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self {
            Input::File(file) => file.read(bytes),
            Input::Stdin(all) => all.read(bytes),
        }
    }
}

impl Seek for Input {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match self {
            Input::File(file) => file.seek(to),
            Input::Stdin(all) => all.seek(to),
        }
    }
}
