//! `-o -`: what a command makes goes to stdout.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use clap::builder::{PathBufValueParser, TypedValueParser};
use tempfile::TempDir;

use super::text::output;
use crate::error::{Error, Result};
use crate::files::{Destination, STANDARD};

/// Where a command puts the one file that it makes.
pub struct Place {
    path: Destination,
    /// Holds the file until it goes to stdout.
    folder: Option<TempDir>,
}

impl Place {
    /// `output` itself, or for `-` a file that goes to stdout when it is whole; then no words go there, nor `json`.
    pub fn of(output: &Path, json: bool) -> Result<Self> {
        if output != Path::new(STANDARD) {
            return Ok(Place { path: output.into(), folder: None });
        }
        if json {
            return Err(Error::Usage("-o - and --json: stdout is for one of them".into()));
        }
        output::be_quiet();
        let folder = tempfile::tempdir().map_err(|e| {
            let what = format!("takes no file on its way to stdout ({e}); TMPDIR names another folder");
            Error::format(&std::env::temp_dir(), what)
        })?;
        Ok(Place { path: Destination::at(folder.path().join("stdout")), folder: Some(folder) })
    }

    /// Where the command writes.
    pub fn path(&self) -> &Destination {
        &self.path
    }

    /// The file is whole: one for stdout goes there. A reader that has gone away is no error.
    pub fn done(self) -> Result<()> {
        if self.folder.is_none() {
            return Ok(());
        }
        let mut file = File::open(&self.path).map_err(|e| Error::io(&self.path, e))?;
        match io::copy(&mut file, &mut io::stdout().lock()) {
            Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::io(Path::new("stdout"), e)),
            _ => Ok(()),
        }
    }
}

/// A folder for several files, which stdout is not.
pub fn folder() -> impl TypedValueParser<Value = PathBuf> {
    named("several files are written: a folder is needed")
}

/// The name of a file that has another next to it, for which stdout has no room.
pub fn of_two() -> impl TypedValueParser<Value = PathBuf> {
    named("a table and its realisations are written: a name is needed")
}

fn named(why: &'static str) -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new()
        .try_map(move |path| if path == Path::new(STANDARD) { Err(why) } else { Ok(path) })
}
