//! One process at a time for one output: a lock of the system on a file beside it, which ends with its process.

use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// A lock that is held. Given up, and its file removed, when it is dropped or its process ends in whatever way.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    _file: File,
}

impl Lock {
    /// Locks the file at `path`, which is made if it is not there.
    ///
    /// Errors: `Format` where another process holds it; `Io`.
    /// Held by: `a_lock_is_held_by_one_and_leaves_nothing`, and `tests/files_under_failure.rs`.
    pub fn take(path: &Path) -> Result<Self> {
        loop {
            let file = File::options().read(true).write(true).create(true).truncate(false).open(path);
            let mut file = file.map_err(|e| Error::io(path, e))?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(taken(path)),
                // Some file systems know no locks; results are whole there too, only not guarded against a second run.
                Err(TryLockError::Error(e)) if e.kind() == ErrorKind::Unsupported => {}
                Err(TryLockError::Error(e)) => return Err(Error::io(path, e)),
            }
            // The one before may have removed the file between our opening and our locking it.
            if is_at(&file, path).map_err(|e| Error::io(path, e))? {
                // For the eye only: the lock is the system's.
                file.set_len(0).and_then(|()| writeln!(file, "{}", std::process::id())).ok();
                return Ok(Lock { path: path.into(), _file: file });
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // While it is still locked, so that nobody locks a file that is about to go.
        fs::remove_file(&self.path).ok();
    }
}

fn taken(path: &Path) -> Error {
    let by = fs::read_to_string(path).ok().and_then(|text| text.trim().parse::<u32>().ok());
    let by = by.map_or("another process".into(), |pid| format!("process {pid}"));
    Error::format(path, format!("{by} is writing this output; wait for it, or choose another -o"))
}

#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let open = file.metadata()?;
    match fs::metadata(path) {
        Ok(there) => Ok((there.dev(), there.ino()) == (open.dev(), open.ino())),
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(false),
        Err(e) => Err(e),
    }
}

#[cfg(not(unix))]
fn is_at(_file: &File, _path: &Path) -> io::Result<bool> {
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_is_held_by_one_and_leaves_nothing() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("small.lock");
        let lock = Lock::take(&path).expect("free");
        let refused = Lock::take(&path).expect_err("taken").to_string();
        assert!(refused.contains(&format!("process {}", std::process::id())), "{refused}");
        drop(lock);
        assert!(!path.exists());
        // Left by a process that was killed: its lock went with it.
        fs::write(&path, "4194305\n").expect("file");
        drop(Lock::take(&path).expect("nobody holds it"));
    }
}
