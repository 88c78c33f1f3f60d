//! Who is told how a measurement goes, and may end it.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::sweep::SweepPaths;
use super::table_output::WrittenTable;
use crate::campaign::Campaign;
use crate::error::Result;
use crate::measure::{Cost, Disk, Plan, ProcessEnd};

/// Who is told how a measurement goes. Every method may be left as it is.
pub trait Watcher: Sync {
    /// Something is not as the user may think.
    fn warn(&self, _text: &str) {}

    /// Something that is good to know.
    fn note(&self, _text: &str) {}

    /// The results in this file are there already, and nothing is measured for them.
    fn finished(&self, _file: &Path) -> Result<()> {
        Ok(())
    }

    /// A run is resumed from this file (and others next to it): so many of `total` samples are measured.
    fn resumes(&self, _file: &Path, _samples: u64, _total: u64) {}

    /// A folder has so many bytes free, fewer than the run may take.
    fn little_room(&self, _folder: &Path, _disk: Disk, _free: u64) {}

    /// The run begins, as it is planned.
    fn begins(&self, _campaign: &Campaign, _plan: &Plan, _disk: Disk) -> Result<()> {
        Ok(())
    }

    /// The first `before` of `total` samples were measured by an earlier run; the others follow.
    fn measuring(&self, _before: u64, _total: u64) {}

    /// So many more samples are measured; from any thread.
    fn samples(&self, _more: u64) {}

    /// What is done now besides tracing, as `making patches 3 to 4 of 16`; empty: nothing.
    fn stage(&self, _text: &str) {}

    /// No more samples follow.
    fn measured(&self) {}

    /// A table is written.
    fn written(&self, _table: &WrittenTable) -> Result<()> {
        Ok(())
    }

    /// The figures of all tables of a campaign together are written.
    fn swept(&self, _files: &SweepPaths) -> Result<()> {
        Ok(())
    }

    /// All tables are written: what the run has cost.
    fn cost(&self, _cost: &Cost) -> Result<()> {
        Ok(())
    }

    /// Set by whoever wants the run to end: it keeps what it has measured, and says so in its error.
    fn interrupted(&self) -> Option<&AtomicBool> {
        None
    }

    /// Who ends the process for a run that does not end in time.
    fn process_end(&self) -> Option<&dyn ProcessEnd> {
        None
    }
}

/// Hears nothing and ends nothing.
pub struct Silent;

impl Watcher for Silent {}
