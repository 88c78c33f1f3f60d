//! One process at a time for one output: a lock of the system on a file next to it, which ends with its process.

use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use super::own_file;
use crate::error::{Error, Result};

/// What a file of a lock begins with.
const HEADER: &str = "gonio lock of process ";
/// More than it holds.
const LONGEST: u64 = 100;

/// A lock that is held. Given up, and its file removed, when it is dropped or its process ends in whatever way.
#[derive(Debug)]
pub struct Lock {
    _held: Arc<HeldLock>,
}

#[derive(Debug)]
struct HeldLock {
    path: PathBuf,
    file: File,
}

/// The locks of this process.
static LOCKS: Mutex<Vec<Weak<HeldLock>>> = Mutex::new(Vec::new());

fn locks() -> MutexGuard<'static, Vec<Weak<HeldLock>>> {
    LOCKS.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Lock {
    /// Locks the outputs of a folder whose names begin with `stem`: the file `.<stem>.gonio-lock`, which is made if
    /// it is not there.
    ///
    /// Errors: `Format` where another process holds it, or something else has the name; `Io`.
    // Tested by `a_lock_is_held_by_one_and_leaves_nothing`, and `tests/process/files_under_failure.rs`.
    pub fn take(folder: &Path, stem: &str) -> Result<Self> {
        let path = folder.join(format!(".{stem}.gonio-lock"));
        let failed = |e: io::Error| Error::io(&path, e);
        // Not while, nor after, `abandon` removes their files.
        let mut locks = locks();
        loop {
            let Some(mut file) = opened(&path).map_err(failed)? else { continue };
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(taken(&path, &mut file)),
                // Results are whole there too, only not guarded against a second run.
                Err(TryLockError::Error(e)) if own_file::knows_no_locks(&e) => {}
                Err(TryLockError::Error(e)) => return Err(failed(e)),
            }
            // The one before may have removed the file between our opening and our locking it.
            if !own_file::is_at(&file, &path).map_err(failed)? {
                continue;
            }
            let content = content(&mut file).map_err(failed)?;
            // An empty one is of a process that was killed before it wrote into it.
            if !content.is_empty() && !content.starts_with(HEADER) {
                return Err(Error::format(
                    &path,
                    "is no lock of this program; move it, or choose another -o",
                ));
            }
            // For the eye only: the lock is the system's.
            let pid = std::process::id();
            file.set_len(0).and_then(|()| file.rewind()).and_then(|()| writeln!(file, "{HEADER}{pid}")).ok();
            let held = Arc::new(HeldLock { path, file });
            locks.retain(|lock| lock.strong_count() > 0);
            locks.push(Arc::downgrade(&held));
            return Ok(Lock { _held: held });
        }
    }
}

impl HeldLock {
    /// While it is still locked, so that nobody locks a file that is about to go.
    fn remove_file(&self) {
        if own_file::is_at(&self.file, &self.path).unwrap_or(false) {
            fs::remove_file(&self.path).ok();
        }
    }
}

impl Drop for HeldLock {
    fn drop(&mut self) {
        self.remove_file();
    }
}

/// Removes the files of the locks of this process, which is about to end and gives them up by that.
pub fn abandon() {
    let locks = locks();
    // Not dropped: they are held to the end.
    locks.iter().filter_map(Weak::upgrade).for_each(|held| {
        held.remove_file();
        std::mem::forget(held);
    });
    std::mem::forget(locks);
}

/// The file that is there, or a new one; `None` where it went meanwhile.
fn opened(path: &Path) -> io::Result<Option<File>> {
    match own_file::create_new(path) {
        Err(e) if e.kind() == ErrorKind::AlreadyExists => match own_file::open(path) {
            Err(e) if e.kind() == ErrorKind::NotFound => Ok(None),
            there => there.map(Some),
        },
        new => new.map(Some),
    }
}

fn content(file: &mut File) -> io::Result<String> {
    let mut bytes = Vec::new();
    file.rewind()?;
    Read::by_ref(file).take(LONGEST).read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

fn taken(path: &Path, file: &mut File) -> Error {
    let text = content(file).unwrap_or_default();
    let by = text.strip_prefix(HEADER).and_then(|pid| pid.trim().parse::<u32>().ok());
    let by = by.map_or("another process".into(), |pid| format!("process {pid}"));
    Error::format(path, format!("{by} is writing this output; wait for it, or choose another -o"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_is_held_by_one_and_leaves_nothing() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join(".small.gonio-lock");
        let lock = Lock::take(folder.path(), "small").expect("free");
        let refused = Lock::take(folder.path(), "small").expect_err("taken").to_string();
        assert!(refused.contains(&format!("process {}", std::process::id())), "{refused}");
        drop(lock);
        assert_eq!(fs::read_dir(folder.path()).expect("readable").count(), 0);
        // Left by processes that were killed: their locks went with them.
        for left in ["gonio lock of process 4194305\n", ""] {
            fs::write(&path, left).expect("file");
            drop(Lock::take(folder.path(), "small").expect("nobody holds it"));
        }
        fs::write(&path, "my notes").expect("file");
        let refused = Lock::take(folder.path(), "small").expect_err("a user's").to_string();
        assert!(refused.contains("is no lock of this program"), "{refused}");
        assert_eq!(fs::read_to_string(&path).expect("there"), "my notes");
    }
}
