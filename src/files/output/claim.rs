//! Names of unfinished files, and who may remove what a process that was killed has left of them.
//!
//! A process that writes into a folder makes a claim there first: `.gonio-<token>.claim`, locked for as long as the
//! process lives, which says what it is and on which machine. Its unfinished files are `.gonio-<token>-<n>.tmp`.
//! Another process removes them only where the claim is one of ours, of this machine since it was started, and its
//! lock can be had: on a shared folder a lock may not reach the other machine, so that what is left there is left
//! alone. Containers of one machine share its kernel, and so its locks.

use std::collections::HashMap;
use std::fs::{self, File, TryLockError};
use std::hash::{BuildHasher, RandomState};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use crate::files::own_file;

const PREFIX: &str = ".gonio-";
const CLAIM: &str = ".claim";
/// What a claim begins with.
const HEADER: &str = "gonio claim 1: files of this name and .tmp are under way\nmachine ";
/// More than a claim holds.
const LONGEST: u64 = 1 << 10;

/// The right to names in a folder, held until it is dropped or the process ends in whatever way.
#[derive(Debug)]
pub struct Claim {
    folder: PathBuf,
    token: String,
    next: AtomicU32,
    _file: File,
}

/// The claims of this process by folder; a folder stays in the list, so that it is looked through once.
static CLAIMS: Mutex<Option<HashMap<PathBuf, Weak<Claim>>>> = Mutex::new(None);

fn claims() -> MutexGuard<'static, Option<HashMap<PathBuf, Weak<Claim>>>> {
    CLAIMS.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Claim {
    /// The process's claim on a folder. The first one removes what killed processes have left there.
    // Tested by `what_a_dead_process_left_is_removed_and_nothing_else`, tests/process/files_under_failure.rs.
    pub fn on(folder: &Path) -> io::Result<Arc<Self>> {
        let mut claims = claims();
        let claims = claims.get_or_insert_default();
        if let Some(claim) = claims.get(folder).and_then(Weak::upgrade) {
            return Ok(claim);
        }
        if !claims.contains_key(folder) {
            remove_leftovers(folder)?;
        }
        let claim = Arc::new(Claim::new(folder)?);
        claims.insert(folder.into(), Arc::downgrade(&claim));
        Ok(claim)
    }

    fn new(folder: &Path) -> io::Result<Self> {
        loop {
            let random = RandomState::new().hash_one(std::process::id());
            let token = format!("{random:016x}");
            let path = claim_path(folder, &token);
            let mut file = own_file::create_new(&path)?;
            // Told as one of ours only when it is locked.
            let begun = match file.try_lock() {
                Err(TryLockError::Error(e)) if !own_file::knows_no_locks(&e) => Err(e),
                Err(TryLockError::WouldBlock) => continue,
                _ => file.write_all(text().as_bytes()).and_then(|()| own_file::is_at(&file, &path)),
            };
            match begun {
                Ok(true) => {
                    return Ok(Claim { folder: folder.into(), token, next: AtomicU32::new(0), _file: file });
                }
                // While it was empty another process took it for one that was left.
                Ok(false) => {}
                Err(e) => return Err(cleared(&path, e)),
            }
        }
    }

    /// Makes an unfinished file, of a name that nobody else has.
    pub fn create_file(&self) -> io::Result<(PathBuf, File)> {
        // Not while, nor after, `abandon` removes them.
        let _claims = claims();
        let path = self.name();
        own_file::create_new(&path).map(|file| (path, file))
    }

    fn name(&self) -> PathBuf {
        self.path(self.next.fetch_add(1, Ordering::Relaxed))
    }

    fn path(&self, number: u32) -> PathBuf {
        self.folder.join(format!("{PREFIX}{}-{number}.tmp", self.token))
    }
}

/// Removes the unfinished files and the claims of this process, which is about to end: who wants to make another one
/// waits until then.
// Tested by `tests/process/signals.rs`.
pub fn abandon() {
    let claims = claims();
    for claim in claims.iter().flat_map(HashMap::values).filter_map(Weak::upgrade) {
        // Most have been renamed long since.
        for number in 0..claim.next.load(Ordering::Relaxed) {
            fs::remove_file(claim.path(number)).ok();
        }
        fs::remove_file(claim_path(&claim.folder, &claim.token)).ok();
    }
    std::mem::forget(claims);
}

impl Drop for Claim {
    fn drop(&mut self) {
        // Still locked, so that nobody takes it for a dead process's.
        fs::remove_file(claim_path(&self.folder, &self.token)).ok();
    }
}

fn cleared(path: &Path, cause: io::Error) -> io::Error {
    fs::remove_file(path).ok();
    cause
}

fn claim_path(folder: &Path, token: &str) -> PathBuf {
    folder.join(format!("{PREFIX}{token}{CLAIM}"))
}

/// What a claim of this machine holds. Where the system does not say which start of which machine this is, no two are
/// alike, and nothing is ever removed.
fn text() -> String {
    let machine = fs::read_to_string("/proc/sys/kernel/random/boot_id");
    let machine =
        machine.map_or_else(|_| format!("unknown, process {}", std::process::id()), |id| id.trim().into());
    format!("{HEADER}{machine}\n")
}

/// Removes the unfinished files of processes of this machine that are no more, and their claims.
fn remove_leftovers(folder: &Path) -> io::Result<()> {
    let names = || -> io::Result<Vec<String>> {
        let entries = fs::read_dir(folder)?;
        let names = entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
        names.filter(|name| !matches!(name, Ok(name) if !name.starts_with(PREFIX))).collect()
    };
    let all = names()?;
    let tokens = all.iter().filter_map(|name| name.strip_prefix(PREFIX)?.strip_suffix(CLAIM));
    for token in tokens.filter(|token| token.len() == 16 && token.bytes().all(|b| b.is_ascii_hexdigit())) {
        let path = claim_path(folder, token);
        // A claim that cannot be opened or locked is somebody's.
        let Ok(mut file) = own_file::open(&path) else { continue };
        let mut content = String::new();
        let read = Read::by_ref(&mut file).take(LONGEST).read_to_string(&mut content);
        // An empty one is of a process that was killed before it wrote into it.
        let is_ours = content.is_empty() || content == text();
        if read.is_err() || !is_ours || file.try_lock().is_err() {
            continue;
        }
        let first = format!("{PREFIX}{token}-");
        let is_under_way = |name: &str| {
            let number = name.strip_prefix(&first).and_then(|rest| rest.strip_suffix(".tmp"));
            number.is_some_and(|number| number.bytes().all(|byte| byte.is_ascii_digit()))
        };
        for name in all.iter().filter(|name| is_under_way(name)) {
            let left = folder.join(name);
            if fs::symlink_metadata(&left).is_ok_and(|meta| meta.is_file()) {
                fs::remove_file(&left).or_else(already_gone)?;
            }
        }
        fs::remove_file(&path).or_else(already_gone)?;
    }
    Ok(())
}

fn already_gone(error: io::Error) -> io::Result<()> {
    if error.kind() == io::ErrorKind::NotFound { Ok(()) } else { Err(error) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entry = |entry: io::Result<fs::DirEntry>| {
            entry.expect("entry").file_name().to_string_lossy().into_owned()
        };
        let mut names: Vec<String> = fs::read_dir(folder).expect("folder").map(entry).collect();
        names.sort();
        names
    }

    #[test]
    fn a_claim_is_shared_and_leaves_nothing() {
        let folder = tempfile::tempdir().expect("folder");
        let (one, other) =
            (Claim::on(folder.path()).expect("claim"), Claim::on(folder.path()).expect("claim"));
        assert!(Arc::ptr_eq(&one, &other) && one.name() != other.name());
        assert_eq!(names(folder.path()).len(), 1);
        drop((one, other));
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn what_a_dead_process_left_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().expect("folder");
        let put = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("file");
        // Of a process that was killed; of one that lives; of another machine; without a claim; a user's own.
        let (dead, foreign) = ("0123456789abcdef", "00000000000000aa");
        put(&format!(".gonio-{dead}.claim"), &text());
        put(&format!(".gonio-{dead}-0.tmp"), "half a table");
        let begun = ".gonio-00000000000000bb.claim";
        put(begun, "");
        put(&format!(".gonio-{dead}-notes.tmp"), "a user's");
        fs::create_dir(folder.path().join(format!(".gonio-{dead}-7.tmp"))).expect("a folder");
        put(&format!(".gonio-{foreign}.claim"), &format!("{HEADER}another\n"));
        put(&format!(".gonio-{foreign}-0.tmp"), "half a table");
        put(".gonio-fedcba9876543210-0.tmp", "nobody's");
        put(".gonio-ffffffffffffffff.claim", "my own file");
        put("thesis.tex.tmp.4000000", "a year of work");
        let alive = Claim::new(folder.path()).expect("claim");
        fs::write(alive.name(), "half a table").expect("file");
        let before = names(folder.path());
        remove_leftovers(folder.path()).expect("readable");
        let gone: Vec<String> =
            before.into_iter().filter(|name| !folder.path().join(name).exists()).collect();
        assert_eq!(gone, [begun.into(), format!(".gonio-{dead}-0.tmp"), format!(".gonio-{dead}.claim")]);
    }
}
