//! One run of `gonio measure`: from what an earlier one kept to the tables.

use super::ending::{self, Leaving};
use super::measure::Arguments;
use super::results::{self, Results};
use super::run_store;
use super::targets::TablePaths;
use super::text::output::{Output, warn};
use super::text::plan;
use super::text::progress::RunProgress;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::{Disk, MeasuredRun, PartsRun, Patches, Plan, ResumableRun, RunFiles, Session};
use crate::report::html::specimen;
use crate::validate::prediction::aperture::worst;

/// What is measured in one run.
pub struct MeasureJob<'a> {
    pub arguments: &'a Arguments,
    pub files: &'a RunFiles,
    pub campaign: Campaign,
}

impl MeasureJob<'_> {
    /// Measures what is missing, after what was found.
    pub fn run(&self, found: ResumableRun, plan: &Plan, out: &mut Output) -> Result<(MeasuredRun, Patches)> {
        let MeasureJob { arguments, files, campaign } = self;
        let number = found.under_way.as_ref().map_or(0, |checkpoint| checkpoint.kept.header.number);
        let newest = found.headers().next().map(|(path, _)| path.to_path_buf());
        let run = PartsRun::new(campaign, plan, files, found)?;
        newest.iter().for_each(|path| run_store::say_resumed(path, run.starts(), plan));
        let mut patches = self.patches(plan, out)?;
        if plan.parts().len() > 1 {
            patches = patches.for_bands(campaign, arguments.memory())?;
        }
        let progress = RunProgress::after(run.starts(), plan.total_samples, "samples");
        let leaving = Leaving(|error| self.with_advice(error));
        let session = Session {
            progress: &|starts| progress.add(starts),
            note: &|text| warn(text),
            interrupted: ending::asked(),
            checkpoint: Some((&files.checkpoint, number)),
            pace: run_store::pace()?,
            ending: Some(&leaving),
        };
        let measured = run.measure(&patches, &session);
        progress.finish();
        Ok((measured.map_err(|error| self.with_advice(error))?, patches))
    }

    fn with_advice(&self, error: Error) -> Error {
        run_store::with_advice(error, self.files, self.arguments)
    }

    /// Measures all incidences, and writes their tables, in bands where these do not fit the memory.
    pub fn run_to_tables(
        &self,
        found: ResumableRun,
        plan: &Plan,
        open: &[&TablePaths],
        out: &mut Output,
    ) -> Result<()> {
        let (mut run, patches) = self.run(found, plan, out)?;
        self.results(plan, open).write_all(
            |band| run.tables(&self.campaign, plan, band),
            |table| specimen::of_patches(&patches, &table.campaign),
            out,
        )
    }

    fn results<'a>(&self, plan: &'a Plan, open: &'a [&'a TablePaths]) -> Results<'a> {
        let (memory, limit) = (self.arguments.memory(), self.arguments.realisations_limit());
        Results { plan, open, json: self.arguments.json, memory, realisations_limit: limit }
    }

    /// The patches, with what is to be said of the campaign before it runs.
    fn patches(&self, plan: &Plan, out: &mut Output) -> Result<Patches> {
        let MeasureJob { arguments, campaign, .. } = self;
        let disk = Disk::of(campaign, plan, arguments.realisations_limit());
        results::realisations_fit(disk, arguments.memory())?;
        let mut notes = Vec::new();
        let patches = match &arguments.patches {
            Some(folder) => Patches::from_folder(campaign, folder)?,
            None => Patches::prepare(campaign, &mut notes)?,
        };
        notes.iter().for_each(warn);
        run_store::room_for(disk, &self.files.folder).iter().for_each(warn);
        if !arguments.json {
            out.lines(plan::facts(campaign, plan, disk))?;
            out.lines(worst(campaign).iter().flat_map(plan::aperture))?;
        }
        Ok(patches)
    }
}
