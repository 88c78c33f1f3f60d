//! Files that are ours alone: made where nothing was, opened without following a link or waiting for a pipe.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::Path;

/// Makes a file where nothing is, not even a link that leads nowhere.
pub fn create_new(path: &Path) -> io::Result<File> {
    File::options().read(true).write(true).create_new(true).open(path)
}

/// Opens a regular file for reading and writing; links, folders, pipes and devices are refused.
pub fn open(path: &Path) -> io::Result<File> {
    check_regular(path)?;
    let mut options = File::options();
    options.read(true).write(true);
    without_following(&mut options);
    let file = options.open(path)?;
    if file.metadata()?.is_file() { Ok(file) } else { Err(not_a_file("is not a regular file")) }
}

/// Refuses what is there and no regular file.
pub fn check_regular(path: &Path) -> io::Result<()> {
    let kind = fs::symlink_metadata(path)?.file_type();
    match (kind.is_file(), kind.is_dir(), kind.is_symlink()) {
        (true, ..) => Ok(()),
        (_, true, _) => Err(io::Error::new(ErrorKind::IsADirectory, "is a folder")),
        (.., true) => Err(not_a_file("is a symbolic link")),
        _ => Err(not_a_file("is not a regular file")),
    }
}

fn not_a_file(what: &str) -> io::Error {
    io::Error::new(ErrorKind::InvalidInput, what)
}

/// Whether locks failed because the file system has none: some network file systems.
pub fn knows_no_locks(error: &io::Error) -> bool {
    error.kind() == ErrorKind::Unsupported || error.raw_os_error() == NO_LOCKS
}

#[cfg(unix)]
const NO_LOCKS: Option<i32> = Some(rustix::io::Errno::NOLCK.raw_os_error());
#[cfg(not(unix))]
const NO_LOCKS: Option<i32> = None;

#[cfg(unix)]
fn without_following(options: &mut OpenOptions) {
    use std::os::unix::fs::OpenOptionsExt;
    let flags = rustix::fs::OFlags::NOFOLLOW | rustix::fs::OFlags::NONBLOCK;
    options.custom_flags(flags.bits() as i32);
}

#[cfg(not(unix))]
fn without_following(_options: &mut OpenOptions) {}

/// Whether an open file is the one that has this name now.
#[cfg(unix)]
pub fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let open = file.metadata()?;
    match fs::symlink_metadata(path) {
        Ok(there) => Ok((there.dev(), there.ino()) == (open.dev(), open.ino())),
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(false),
        Err(e) => Err(e),
    }
}

/// Whether an open file is the one that has this name now: not known here.
#[cfg(not(unix))]
pub fn is_at(_file: &File, _path: &Path) -> io::Result<bool> {
    Ok(true)
}
