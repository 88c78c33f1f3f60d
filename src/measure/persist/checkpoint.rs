//! Checkpoints: two files that take turns, so that one of them is whole at any moment.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::run_state::StoredRun;
use crate::error::{Error, Result};
use crate::files::{self, Destination};

/// Where a run keeps its finished blocks.
#[derive(Debug)]
pub struct Checkpoint {
    slots: [PathBuf; 2],
    /// What lay there at first, or was put there since.
    places: [Mutex<Destination>; 2],
}

/// A checkpoint that was found.
#[derive(Debug)]
pub struct FoundCheckpoint {
    /// Its file.
    pub path: PathBuf,
    /// Its content.
    pub kept: StoredRun,
    /// The newer file, and why it was passed over.
    pub passed_over: Option<String>,
}

impl Checkpoint {
    /// The files `<stem>.checkpoint_0` and `_1` of a folder.
    pub fn of(folder: &Path, stem: &str) -> Self {
        let slots = [0, 1].map(|slot| folder.join(format!("{stem}.checkpoint_{slot}")));
        Checkpoint { places: slots.each_ref().map(|slot| Mutex::new(slot.into())), slots }
    }

    /// The file of either, if one is there.
    pub fn path(&self) -> Option<&Path> {
        self.slots.iter().map(PathBuf::as_path).find(|path| files::is_there(path))
    }

    /// The newest one that is whole; `None` where there is none at all.
    ///
    /// Errors: `Io`; `Format` where every file that is there is damaged.
    // Tested by `a_damaged_checkpoint_gives_way_to_the_one_before`.
    pub fn load(&self) -> Result<Option<FoundCheckpoint>> {
        let mut whole: Vec<(&PathBuf, StoredRun)> = Vec::new();
        let mut damaged = Vec::new();
        for path in &self.slots {
            let bytes = match files::read(path) {
                Err(Error::Io { source, .. }) if source.kind() == io::ErrorKind::NotFound => continue,
                read => read?,
            };
            match StoredRun::from_bytes(&bytes) {
                Ok(kept) => whole.push((path, kept)),
                Err(why) => damaged.push((path, why)),
            }
        }
        whole.sort_by_key(|(_, kept)| kept.header.number);
        match (whole.pop(), damaged.pop()) {
            (Some((path, kept)), damaged) => {
                let passed_over = damaged.map(|(path, why)| format!("{}: {why}", path.display()));
                Ok(Some(FoundCheckpoint { path: path.clone(), kept, passed_over }))
            }
            (None, Some((path, why))) => Err(Error::format(path, format!("{why}; --force starts again"))),
            (None, None) => Ok(None),
        }
    }

    /// Puts these `bytes` in the place of the older file.
    pub(crate) fn save(&self, number: u64, bytes: &[u8]) -> Result<()> {
        let slot = (number % 2) as usize;
        let mut place = self.place(slot);
        files::write_atomically(&*place, bytes)?;
        *place = Destination::at(&self.slots[slot]);
        Ok(())
    }

    /// Removes both files.
    pub fn remove(&self) -> Result<()> {
        (0..self.slots.len()).try_for_each(|slot| self.place(slot).remove())
    }

    fn place(&self, slot: usize) -> MutexGuard<'_, Destination> {
        self.places[slot].lock().unwrap_or_else(PoisonError::into_inner)
    }
}
