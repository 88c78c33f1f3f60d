//! An unfinished file: written next to its place, taking its name when it is whole.

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::claim::Claim;
use super::destination::Destination;
use super::{clean_up, folder_of, sync_folder};
use crate::error::{Error, Result};

/// An open, unfinished file in the folder of its place. Dropped before [`NewFile::commit`], it is
/// removed, and what lay in its place stays.
pub struct NewFile {
    place: Destination,
    temporary: PathBuf,
    out: BufWriter<File>,
    /// Whether nothing was written since all of it reached the disk.
    on_disk: bool,
    done: bool,
    /// Lasts longer than the file.
    _claim: Arc<Claim>,
}

impl NewFile {
    /// Opens it. Folders, links, devices, pipes and read-only files are not replaced.
    pub fn create(place: impl Into<Destination>) -> Result<Self> {
        let place = place.into();
        let open = || {
            place.check()?;
            place.file_name().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "has no name"))?;
            let claim = Claim::on(folder_of(&place))?;
            claim.create_file().map(|(temporary, file)| (claim, temporary, BufWriter::new(file)))
        };
        let (claim, temporary, out) = open().map_err(|e| Error::io(&place, e))?;
        Ok(NewFile { place, temporary, out, on_disk: false, done: false, _claim: claim })
    }

    /// Opens it with this content, on the disk: what can fail for want of room has not failed.
    pub fn with(place: impl Into<Destination>, bytes: &[u8]) -> Result<Self> {
        let mut file = NewFile::create(place)?;
        file.write_all(bytes).map_err(|e| Error::io(&file.place, e))?;
        file.on_disk()
    }

    /// The same, when all of its bytes have reached the disk.
    pub fn on_disk(mut self) -> Result<Self> {
        self.reach_disk().map_err(|e| Error::io(&self.place, e)).map(|()| self)
    }

    /// Where its bytes are meanwhile: all of them once they are on the disk.
    pub fn under_way(&self) -> &Path {
        &self.temporary
    }

    fn reach_disk(&mut self) -> io::Result<()> {
        if !self.on_disk {
            self.out.flush()?;
            self.out.get_ref().sync_all()?;
            self.on_disk = true;
        }
        Ok(())
    }

    /// Refuses now what [`NewFile::commit`] would refuse of its place.
    pub fn check_place(&self) -> Result<()> {
        self.place.check().map_err(|e| Error::io(&self.place, e))
    }

    /// Puts the file in its place, when its bytes have reached the disk.
    // Tested by `a_file_under_way_leaves_the_old_one_whole`.
    pub fn commit(mut self) -> Result<()> {
        // Between the look and the rename are microseconds: what comes then is lost, for the file systems' own test of it is
        // not everywhere.
        let placed = self.reach_disk().and_then(|()| self.place.check());
        let placed = placed.and_then(|()| fs::rename(&self.temporary, &self.place));
        self.done = true;
        match placed {
            Ok(()) => sync_folder(folder_of(&self.place)).map_err(|e| Error::io(&self.place, e)),
            Err(cause) => Err(Error::io(&self.place, clean_up(&self.temporary, cause))),
        }
    }
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.on_disk = false;
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

impl Seek for NewFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        // Flushes the buffer, whose bytes may lie in the file's middle.
        self.on_disk = false;
        self.out.seek(to)
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        if !self.done {
            // Nothing is lost by what stays behind: the next run in this folder removes it.
            fs::remove_file(&self.temporary).ok();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_under_way_leaves_the_old_one_whole() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("table.exr");
        fs::write(&path, b"old").expect("first");
        let mut file = NewFile::create(&path).expect("opened");
        file.write_all(b"half of it").expect("written");
        drop(file);
        assert_eq!(fs::read(&path).expect("there"), b"old");
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1);
        let mut file = NewFile::create(&path).expect("opened");
        file.write_all(b"new").expect("written");
        file.rewind().and_then(|()| file.write_all(b"N")).expect("patched");
        file.commit().expect("placed");
        assert_eq!(fs::read(&path).expect("there"), b"New");
        assert!(matches!(NewFile::create(folder.path()), Err(Error::Io { .. })));
    }
}
