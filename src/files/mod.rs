//! Files: whole or not at all when written, bounded when read; folders; SHA-256; EXR and NPY in memory.

pub mod exr_header;
pub mod image;
pub mod image_blocks;
mod image_part;
pub mod image_rows;
mod input;
pub mod lock;
pub mod memory;
pub mod npy;
mod output;
mod own_file;
pub mod row_writer;
pub mod sealed;

pub use input::{Input, STANDARD};
pub use output::{Claim, Destination, FolderLook, NewFile};

use std::fs;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use crate::error::{Error, Result};

/// Puts `bytes` in the place of the file at `path`, or leaves what was there, as it leaves what a [`Destination`] did not see.
///
/// The bytes go to an unfinished file ([`Claim`]) in the same folder, reach the disk, and take the name by a rename,
/// after which the folder is flushed too. On failure the temporary file is removed.
// Tested by `a_failed_write_leaves_the_old_file_whole`.
pub fn write_atomically(path: impl Into<Destination>, bytes: &[u8]) -> Result<()> {
    NewFile::with(path, bytes)?.commit()
}

/// Removes whatever of this process is no whole file, for it ends now: other threads can make no file any more.
pub fn abandon() {
    output::claim::abandon();
    lock::abandon();
}

/// Makes sure that `path` is a folder that takes files; missing parents are made. Whoever writes several files there
/// keeps the claim, under which all of them are unfinished.
pub fn create_folder(path: &Path) -> Result<Arc<Claim>> {
    fs::create_dir_all(path).map_err(|e| Error::io(path, e))?;
    Claim::on(path).map_err(|e| Error::io(path, e))
}

/// Bytes that the file system of a folder has free for whoever runs this, where it says so.
#[cfg(unix)]
pub fn free_bytes(folder: &Path) -> Option<u64> {
    let system = rustix::fs::statvfs(folder).ok()?;
    // A file system that counts nothing is not a full one.
    (system.f_blocks > 0).then(|| system.f_bavail.saturating_mul(system.f_frsize))
}

/// Bytes that the file system of a folder has free: not known here.
#[cfg(not(unix))]
pub fn free_bytes(_folder: &Path) -> Option<u64> {
    None
}

/// Removes a file if it is there. What may not be replaced may not be removed.
pub fn remove(path: impl Into<Destination>) -> Result<()> {
    path.into().remove()
}

/// Whether anything has this name, be it a link that leads nowhere.
pub fn is_there(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok()
}

/// The content of a regular file, or of stdin ([`Input`]); refused where it does not fit the memory that may be used ([`memory`]).
pub fn read(path: &Path) -> Result<Vec<u8>> {
    let file = open(path)?;
    let length = file.length().map_err(|e| Error::io(path, e))?;
    memory::check_file(path, length)?;
    let room = usize::try_from(length).map_err(|e| e.to_string()).and_then(|length| memory::room(length + 1));
    let mut bytes = room.map_err(|why| Error::Refused(format!("{}: {why}", path.display())))?;
    // A file that grows meanwhile is read as long as it was.
    file.take(length).read_to_end(&mut bytes).map_err(|e| Error::io(path, e))?;
    Ok(bytes)
}

/// Opens a regular file, or stdin by the name [`STANDARD`].
pub fn open(path: &Path) -> Result<Input> {
    open_within(path, u64::MAX)
}

/// The same for whoever refuses what has more than `most` bytes: so much of stdin is read, and one byte more.
pub fn open_within(path: &Path, most: u64) -> Result<Input> {
    Input::open(path, most).map_err(|e| Error::io(path, e))
}

/// SHA-256 of `bytes`, 64 lower-case hex digits.
pub fn sha256_hex(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Lower-case hex digits of `bytes`.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .expect("folder is readable")
            .map(|entry| entry.expect("entry is readable").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn sha256_matches_the_published_vector() {
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sha256_hex(b"abc"), abc);
    }

    #[test]
    fn a_write_replaces_the_file_and_leaves_nothing_else() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("a table é.exr");
        write_atomically(&path, b"old").expect("first write");
        write_atomically(&path, b"new").expect("second write");
        assert_eq!(fs::read(&path).expect("file is there"), b"new");
        assert_eq!(names(folder.path()), ["a table é.exr"]);
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_whole() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("table.exr");
        write_atomically(&path, b"good").expect("first write");
        let mut unfinished = NewFile::create(&path).expect("opened");
        unfinished.write_all(&[0; 100_000]).expect("written");
        // What makes the rest of the bytes has failed.
        drop(unfinished);
        assert_eq!(fs::read(&path).expect("file is there"), b"good");
        assert_eq!(names(folder.path()), ["table.exr"]);
    }

    #[test]
    fn folders_and_devices_are_not_replaced() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("taken");
        fs::create_dir(&path).expect("folder");
        assert!(matches!(write_atomically(&path, b"x"), Err(Error::Io { .. })));
        assert!(matches!(write_atomically(Path::new("/dev/full"), b"x"), Err(Error::Io { .. })));
        assert!(matches!(write_atomically(&path.join("no").join("x"), b"x"), Err(Error::Io { .. })));
        assert_eq!(names(folder.path()), ["taken"]);
        assert!(matches!(read(Path::new("/dev/zero")), Err(Error::Io { .. })));
    }

    #[test]
    fn a_folder_is_made_with_its_parents_but_not_over_a_file() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("out").join("deep");
        create_folder(&path).expect("made");
        create_folder(&path).expect("there already");
        assert_eq!(names(&path), Vec::<String>::new());
        let file = folder.path().join("file");
        fs::write(&file, b"x").expect("file");
        assert!(matches!(create_folder(&file), Err(Error::Io { .. })));
        assert!(matches!(create_folder(&file.join("below")), Err(Error::Io { .. })));
    }
}
