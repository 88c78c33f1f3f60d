//! One run of `gonio measure`: from what an earlier one kept to the tables, at once or in bands.

use std::ops::Range;
use std::path::Path;

use super::ending::{self, Leaving};
use super::measure::Arguments;
use super::results::{self, Results};
use super::run_store::{self, ResumableRun, RunStore};
use super::targets::TablePaths;
use super::text::output::{Output, warn};
use super::text::plan;
use super::text::progress::RunProgress;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::{self, BandRun, Disk, Patches, Plan, ProcessEnd, RunState, Session};
use crate::report::html::specimen;
use crate::validate::prediction::aperture::worst;

/// What is measured in one run.
pub struct MeasureJob<'a> {
    pub arguments: &'a Arguments,
    pub store: &'a RunStore,
    pub campaign: Campaign,
}

impl MeasureJob<'_> {
    /// Measures what is missing, after what was found.
    pub fn run(&self, resumable: ResumableRun, plan: &Plan, out: &mut Output) -> Result<(RunState, Patches)> {
        let MeasureJob { campaign, .. } = self;
        let number = resumable.number();
        let run_state = resumable.run_state(campaign, plan)?;
        let patches = self.patches(plan, out)?;
        let progress = RunProgress::after(run_state.starts(plan), plan.total_samples, "samples");
        let add = |starts| progress.add(starts);
        let leaving = Leaving(|error| self.with_advice(error));
        let session = self.session(&add, &leaving, number)?;
        let ended = measure::go_on(campaign, plan, &patches, run_state, &session);
        progress.finish();
        let run_state = ended.map_err(|error| self.with_advice(error))?;
        Ok((run_state, patches))
    }

    fn session<'a>(
        &'a self,
        progress: &'a (dyn Fn(u64) + Sync),
        ending: &'a dyn ProcessEnd,
        number: u64,
    ) -> Result<Session<'a>> {
        let (checkpoint, pace) = (Some((&self.store.checkpoint, number)), run_store::pace()?);
        let (interrupted, ending) = (ending::asked(), Some(ending));
        Ok(Session { progress, note: &|text| warn(text), interrupted, checkpoint, pace, ending })
    }

    fn with_advice(&self, error: Error) -> Error {
        run_store::with_advice(error, self.store, self.arguments)
    }

    /// Measures all stops, and writes their tables.
    pub fn run_at_once(
        &self,
        (resumable, plan): (ResumableRun, &Plan),
        open: &[&TablePaths],
        out: &mut Output,
    ) -> Result<()> {
        let (run_state, patches) = self.run(resumable, plan, out)?;
        let mut tables = Some(measure::tables(&self.campaign, plan, run_state));
        let all = |_| tables.take().ok_or_else(|| Error::Internal("one run in two bands".into()));
        self.results(plan, open).write_all(all, |table| specimen::of_patches(&patches, &table.campaign), out)
    }

    /// A table that does not fit the memory: measured and written in bands, each kept until the end.
    pub fn run_in_bands(
        &self,
        (resumable, plan): (ResumableRun, &Plan),
        open: &[&TablePaths],
        out: &mut Output,
    ) -> Result<()> {
        let MeasureJob { arguments, store, campaign } = self;
        let (number, first) = (resumable.number(), resumable.path().map(Path::to_path_buf));
        let ResumableRun { found, bands } = resumable;
        let files = (&store.bands, &store.checkpoint);
        let mut run = BandRun::new((campaign, plan), files, bands, found)?;
        first.iter().for_each(|path| run_store::goes_on(path, run.starts(), plan));
        let patches = self.patches(plan, out)?.for_bands(campaign, arguments.memory())?;
        let progress = RunProgress::after(run.starts(), plan.total_samples, "samples");
        let add = |starts| progress.add(starts);
        let leaving = Leaving(|error| self.with_advice(error));
        let session = self.session(&add, &leaving, number)?;
        let band = |stops: Range<usize>| {
            let is_last = stops.end == plan.stops;
            let measured = run.tables(stops, &patches, &session);
            if is_last || measured.is_err() {
                progress.finish();
            }
            measured.map_err(|error| self.with_advice(error))
        };
        self.results(plan, open).write_all(band, |table| specimen::of_patches(&patches, &table.campaign), out)
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
        self.store.room_for(disk).iter().for_each(warn);
        if !arguments.json {
            out.lines(plan::facts(campaign, plan, disk))?;
            out.lines(worst(campaign).iter().flat_map(plan::aperture))?;
        }
        Ok(patches)
    }
}
