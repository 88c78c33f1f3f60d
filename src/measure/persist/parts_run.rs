//! All parts of a run: each from its file, from the checkpoint, or from the beginning, and then the tables of all.

use std::ops::Range;

use super::checkpoint::FoundCheckpoint;
use super::merge::Merge;
use super::run_files::{FinishedBands, ResumableRun, RunFiles, load_part};
use super::run_state::RunState;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::accumulate::assemble::Measured;
use crate::measure::cost::Cost;
use crate::measure::driver::{measure_missing, tables};
use crate::measure::patches::Patches;
use crate::measure::plan::Plan;
use crate::measure::session::Session;

/// A run under way.
pub struct PartsRun<'a> {
    campaign: &'a Campaign,
    /// Of all incidences, or of those of a shard.
    plan: &'a Plan,
    files: &'a RunFiles,
    finished: FinishedBands,
    under_way: Option<FoundCheckpoint>,
    /// Digests of the patches, as far as they are known: all parts are of the same, whichever machine measures them.
    patches: Vec<Option<[u8; 32]>>,
}

/// A run whose every part is measured.
pub enum MeasuredRun {
    /// One part, in memory.
    AtOnce(RunState),
    /// Files of several.
    InBands(Box<Merge>),
}

impl<'a> PartsRun<'a> {
    /// Resumes what was found, which must be of this campaign.
    ///
    /// Errors: `Format` where it is not all of the same patches.
    pub fn new(
        campaign: &'a Campaign,
        plan: &'a Plan,
        files: &'a RunFiles,
        found: ResumableRun,
    ) -> Result<Self> {
        let mut patches: Vec<Option<[u8; 32]>> = vec![None; plan.realisations as usize];
        for (path, header) in found.headers() {
            for (known, digest) in patches.iter_mut().zip(&header.digests) {
                if known.is_some() && digest.is_some() && known != digest {
                    return Err(Error::format(path, "is of other patches than the bands before it"));
                }
                *known = known.or(*digest);
            }
        }
        let ResumableRun { under_way, finished } = found;
        Ok(PartsRun { campaign, plan, files, finished, under_way, patches })
    }

    /// Samples that are measured.
    pub fn starts(&self) -> u64 {
        let finished = self.finished.values().map(|file| file.header.starts);
        let under_way = self.under_way.iter().map(|found| &found.kept.header);
        let alone = under_way.filter(|header| !self.finished.contains_key(&header.part.number));
        finished.chain(alone.map(|header| header.starts)).sum()
    }

    /// Measures what is missing of every part. Of several parts each has its file afterwards; so has a shard.
    ///
    /// Errors: as [`measure_missing`]; `Format`, which names a file that cannot be resumed.
    // Tested by `a_run_in_bands_that_is_killed_ends_with_the_same_bytes` (tests/process/kills_in_bands.rs).
    pub fn measure(mut self, patches: &Patches, session: &Session) -> Result<MeasuredRun> {
        let parts = self.plan.parts();
        let mut only = None;
        for part in &parts {
            let plan = self.plan.of_part(*part)?;
            let (before, has_file) = self.run_state(&plan)?;
            let is_finished = has_file && before.is_at_its_end();
            let after = if is_finished {
                before
            } else {
                measure_missing(self.campaign, &plan, patches, before, session)?
            };
            if !part.is_whole() && !is_finished {
                let file = self.files.save(&after, self.campaign, &plan)?;
                self.finished.insert(part.number, file);
                // Until now the checkpoint was all that there was of the part.
                self.files.checkpoint.remove()?;
            }
            self.patches.clone_from(&after.digests);
            only = (parts.len() == 1).then_some(after);
        }
        match only {
            Some(run_state) => Ok(MeasuredRun::AtOnce(run_state)),
            None => Ok(MeasuredRun::InBands(Box::new(Merge::of_bands(self.finished, self.plan)))),
        }
    }

    /// What there is of a part, and whether that is in its file.
    fn run_state(&mut self, plan: &Plan) -> Result<(RunState, bool)> {
        let mut under_way = self.under_way.take_if(|found| found.kept.header.part == plan.part);
        let file = self.finished.get(&plan.part.number).filter(|file| file.header.part == plan.part);
        // A checkpoint that is left of a finished band has no more than its file, unless the run was resumed with more
        // samples from that file.
        let is_left = |found: &mut FoundCheckpoint| {
            file.is_some_and(|file| file.header.campaign == found.kept.header.campaign)
        };
        if under_way.take_if(is_left).is_some() {
            self.files.checkpoint.remove()?;
        }
        let (path, kept, has_file) = match (under_way, file) {
            (Some(found), _) => (found.path, found.kept, false),
            (None, Some(file)) => (file.path.clone(), load_part(&file.path)?, true),
            (None, None) => return Ok((RunState::new(self.campaign, plan).on_patches(&self.patches), false)),
        };
        let run_state = kept.run_state(self.campaign, plan);
        let run_state =
            run_state.map_err(|why| Error::format(&path, format!("{why}; --force starts again")))?;
        Ok((run_state.on_patches(&self.patches), has_file))
    }
}

impl MeasuredRun {
    /// What the run has cost under the plan that it was measured by.
    pub fn cost(&self, plan: &Plan) -> Cost {
        match self {
            MeasuredRun::AtOnce(run_state) => run_state.cost(plan),
            MeasuredRun::InBands(merge) => merge.cost(),
        }
    }

    /// The tables of a band of incidences, and at the first of them what the run has cost.
    ///
    /// Errors: as [`Merge::tables`].
    pub fn tables(
        &mut self,
        campaign: &Campaign,
        plan: &Plan,
        band: Range<usize>,
    ) -> Result<(Vec<Measured>, Cost)> {
        match self {
            MeasuredRun::AtOnce(run_state) => {
                let run_state = std::mem::replace(run_state, RunState::new(campaign, plan));
                Ok(tables(campaign, plan, run_state))
            }
            MeasuredRun::InBands(merge) => merge.tables(campaign, band),
        }
    }
}
