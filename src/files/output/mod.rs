//! What is written: unfinished files under a claim of their folder, put where nothing foreign lies.

pub mod claim;
mod destination;
mod new_file;

pub use claim::Claim;
pub use destination::{Destination, FolderLook};
pub use new_file::NewFile;

use std::fs::{self, File};
use std::io;
use std::path::Path;

/// Removes the temporary file and returns the cause, with what else went wrong.
fn clean_up(temporary: &Path, cause: io::Error) -> io::Error {
    match fs::remove_file(temporary) {
        Ok(()) => cause,
        Err(e) if e.kind() == io::ErrorKind::NotFound => cause,
        Err(e) => io::Error::new(cause.kind(), format!("{cause}; {} stays behind: {e}", temporary.display())),
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

#[cfg(not(unix))]
fn sync_folder(_folder: &Path) -> io::Result<()> {
    Ok(())
}
