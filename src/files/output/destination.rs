//! Where a file is to be put, and what lay there when a command looked: what has come or changed since is left as it is.

use std::fs::{self, Metadata};
use std::io::{self, ErrorKind};
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::error::{Error, Result};
use crate::files::own_file;

/// A path, and which file had its name at first. A command looks before it judges whether that file may be replaced, so
/// that one that comes while it works is not.
#[derive(Debug, Clone)]
pub struct Destination {
    path: PathBuf,
    seen: Option<Identity>,
}

/// What tells one file, and one content, from another. Times are as coarse as the file system's.
#[derive(Debug, Clone, PartialEq)]
struct Identity {
    inode: [u64; 2],
    length: u64,
    modified: Option<SystemTime>,
}

impl Destination {
    /// Looks now.
    pub fn at(path: impl Into<PathBuf>) -> Self {
        let path = path.into();
        Destination { seen: Identity::of(&path), path }
    }

    /// One where nothing may be, whatever is there now.
    pub fn vacant(path: impl Into<PathBuf>) -> Self {
        Destination { path: path.into(), seen: None }
    }

    /// Refuses what a rename would wrongly replace: folders, links, devices, pipes, files that nobody may write, and what
    /// was not there at first.
    // Tested by `what_has_come_or_changed_since_is_left_as_it_is`.
    pub(super) fn check(&self) -> io::Result<()> {
        match own_file::check_regular(&self.path) {
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(()),
            regular => regular?,
        }
        if fs::symlink_metadata(&self.path)?.permissions().readonly() {
            return Err(io::Error::new(ErrorKind::PermissionDenied, "is read-only"));
        }
        if Identity::of(&self.path) != self.seen {
            let what = "has come or changed since this command began, and is left as it is; move it away";
            return Err(io::Error::new(ErrorKind::AlreadyExists, what));
        }
        Ok(())
    }

    /// Removes the file if it is there. What may not be replaced may not be removed.
    pub fn remove(&self) -> Result<()> {
        match self.check().and_then(|()| fs::remove_file(&self.path)) {
            Err(e) if e.kind() != ErrorKind::NotFound => Err(Error::io(self, e)),
            _ => Ok(()),
        }
    }
}

impl Identity {
    fn of(path: &Path) -> Option<Self> {
        let data = fs::symlink_metadata(path).ok()?;
        Some(Identity { inode: inode(&data), length: data.len(), modified: data.modified().ok() })
    }
}

/// Device and number. The time of the inode's change is no part of it: on network file systems it may come to be known long
/// after the rename that made it.
#[cfg(unix)]
fn inode(data: &Metadata) -> [u64; 2] {
    use std::os::unix::fs::MetadataExt;
    [data.dev(), data.ino()]
}

#[cfg(not(unix))]
fn inode(_data: &Metadata) -> [u64; 2] {
    [0; 2]
}

/// What lay in a folder when a command looked, for names that are known only later.
#[derive(Debug, Default)]
pub struct FolderLook {
    there: Vec<Destination>,
}

impl FolderLook {
    /// Looks now at the files whose names are wanted. In a folder that is not there nothing lies.
    pub fn at(folder: &Path, is_wanted: impl Fn(&str) -> bool) -> Self {
        let entries = fs::read_dir(folder).into_iter().flatten().filter_map(io::Result::ok);
        let wanted = entries.filter(|entry| is_wanted(&entry.file_name().to_string_lossy()));
        FolderLook { there: wanted.map(|entry| Destination::at(entry.path())).collect() }
    }

    /// A path in that folder, and what lay there.
    pub fn destination(&self, path: &Path) -> Destination {
        let there = self.there.iter().find(|there| ***there == *path);
        there.cloned().unwrap_or_else(|| Destination::vacant(path))
    }

    /// A command has put a file there itself.
    pub fn placed(&mut self, path: &Path) {
        self.there.retain(|there| **there != *path);
        self.there.push(Destination::at(path));
    }

    /// All that lay there, and what was put there since.
    pub fn all(&self) -> impl Iterator<Item = &Destination> {
        self.there.iter()
    }
}

impl Deref for Destination {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.path
    }
}

impl AsRef<Path> for Destination {
    fn as_ref(&self) -> &Path {
        &self.path
    }
}

impl From<&Path> for Destination {
    fn from(path: &Path) -> Self {
        Destination::at(path)
    }
}

impl From<&PathBuf> for Destination {
    fn from(path: &PathBuf) -> Self {
        Destination::at(path)
    }
}

impl From<&Destination> for Destination {
    fn from(destination: &Destination) -> Self {
        destination.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::{NewFile, write_atomically};

    #[test]
    fn what_has_come_or_changed_since_is_left_as_it_is() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("table.exr");
        let refused = |written: Result<()>, there: &[u8]| {
            let why = written.expect_err("refused").to_string();
            assert!(why.contains("has come or changed"), "{why}");
            assert_eq!(fs::read(&path).expect("there"), there);
            assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1);
        };
        // Nothing was there.
        let at_first = Destination::at(&path);
        let under_way = NewFile::with(&at_first, b"ours").expect("written");
        fs::write(&path, b"foreign").expect("written");
        refused(under_way.commit(), b"foreign");
        refused(write_atomically(&at_first, b"ours"), b"foreign");
        refused(at_first.remove(), b"foreign");
        // Another file, as long.
        let at_first = Destination::at(&path);
        fs::rename(&path, folder.path().join("away")).expect("moved");
        fs::write(&path, b"FOREIGN").expect("written");
        fs::remove_file(folder.path().join("away")).expect("removed");
        refused(write_atomically(&at_first, b"ours"), b"FOREIGN");
        // The same file, longer.
        let at_first = Destination::at(&path);
        fs::write(&path, b"foreign words").expect("written");
        refused(write_atomically(&at_first, b"ours"), b"foreign words");
        // Names that are known later.
        let look = FolderLook::at(folder.path(), |_| true);
        write_atomically(look.destination(&path), b"ours").expect("written");
        let late = folder.path().join("late");
        fs::write(&late, b"foreign").expect("written");
        assert!(write_atomically(look.destination(&late), b"ours").is_err());
        fs::remove_file(&late).expect("removed");
        // What was there may be replaced, and what has gone too.
        write_atomically(Destination::at(&path), b"old").expect("written");
        let at_first = Destination::at(&path);
        fs::remove_file(&path).expect("removed");
        write_atomically(&at_first, b"new").expect("written");
        assert_eq!(fs::read(&path).expect("there"), b"new");
    }
}
