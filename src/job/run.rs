//! One run: from what an earlier one kept to the sums of all its incidences, or to their tables.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::paths::TablePaths;
use super::tables::{TableWriting, realisations_fit};
use super::watcher::Watcher;
use crate::campaign::Campaign;
use crate::error::Result;
use crate::files;
use crate::measure::{
    Disk, MeasuredRun, Pace, PartsRun, Patches, Plan, ResumableRun, RunFiles, Session, Specimen,
};
use crate::report::html::specimen::FirstPatch;

/// What is measured in one run, and how.
pub(super) struct Run<'a> {
    pub campaign: &'a Campaign,
    pub plan: &'a Plan,
    pub files: &'a RunFiles,
    /// The folder of patches that are not to be made.
    pub patches: Option<&'a Path>,
    pub memory: u64,
    pub realisations_limit: u64,
    pub pace: Pace,
    pub watcher: &'a dyn Watcher,
}

/// Never set.
static NEVER: AtomicBool = AtomicBool::new(false);

impl Run<'_> {
    /// Measures what is missing, after what was found; `first_specimen` is called as [`Session`]'s.
    pub fn measure(
        &self,
        found: ResumableRun,
        first_specimen: &(dyn Fn(&Specimen) + Sync),
    ) -> Result<(MeasuredRun, Patches)> {
        let Run { campaign, plan, files, watcher, .. } = *self;
        let number = found.under_way.as_ref().map_or(0, |checkpoint| checkpoint.kept.header.number);
        let newest = found.headers().next().map(|(path, _)| path.to_path_buf());
        let run = PartsRun::new(campaign, plan, files, found)?;
        if let Some(path) = newest {
            watcher.resumes(&path, run.starts(), plan.total_samples);
        }
        let patches = self.prepared_patches()?;
        watcher.measuring(run.starts(), plan.total_samples);
        let session = Session {
            progress: &|samples| watcher.samples(samples),
            stage: &|text| watcher.stage(text),
            first_specimen,
            note: &|text| watcher.warn(&text),
            interrupted: watcher.interrupted().unwrap_or(&NEVER),
            checkpoint: Some((&files.checkpoint, number)),
            pace: self.pace,
            ending: watcher.process_end(),
        };
        let measured = run.measure(&patches, &session);
        watcher.measured();
        Ok((measured?, patches))
    }

    /// Measures all incidences, and writes their tables, in bands where these do not fit the memory.
    pub fn measure_and_write(&self, found: ResumableRun, open: &[&TablePaths]) -> Result<()> {
        let first = FirstPatch::default();
        let (mut run, patches) = self.measure(found, &|specimen| first.look(specimen, self.campaign))?;
        let Run { campaign, plan, memory, realisations_limit, watcher, .. } = *self;
        TableWriting { plan, open, memory, realisations_limit, watcher }
            .write(|band| run.tables(campaign, plan, band), |table| first.shown(&patches, &table.campaign))
    }

    /// The patches, with what is to be said of the campaign before it runs.
    fn prepared_patches(&self) -> Result<Patches> {
        let Run { campaign, plan, watcher, .. } = *self;
        let disk = Disk::of(campaign, plan, self.realisations_limit);
        realisations_fit(disk, self.memory)?;
        let mut notes = Vec::new();
        let patches = match self.patches {
            Some(folder) => Patches::from_folder(campaign, folder)?,
            None => Patches::prepare(campaign, &mut notes)?,
        };
        notes.iter().for_each(|note| watcher.note(note));
        if let Some(free) = files::free_bytes(&self.files.folder).filter(|free| disk.bytes() > *free) {
            watcher.little_room(&self.files.folder, disk, free);
        }
        watcher.begins(campaign, plan, disk)?;
        if plan.parts().len() > 1 { patches.for_bands(campaign, self.memory) } else { Ok(patches) }
    }
}
