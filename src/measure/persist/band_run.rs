//! A run in bands: each from its file, from its checkpoint, or from the beginning.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;

use super::band_files;
use super::band_files::BandFiles;
use super::checkpoint::{Checkpoint, FoundCheckpoint};
use super::header::RunHeader;
use super::run_state::RunState;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::accumulate::assemble::Measured;
use crate::measure::cost::Cost;
use crate::measure::driver::{go_on, tables};
use crate::measure::patches::Patches;
use crate::measure::plan::Plan;
use crate::measure::plan::bands::Band;
use crate::measure::session::Session;

/// A run in bands under way.
pub struct BandRun<'a> {
    campaign: &'a Campaign,
    /// Of all stops.
    plan: &'a Plan,
    files: &'a BandFiles,
    checkpoint: &'a Checkpoint,
    /// Bands with a file, by number.
    finished: FinishedBands,
    /// The band that was under way.
    under_way: Option<FoundCheckpoint>,
    /// Digests of the patches, as far as they are known: all bands are of one specimen, whichever machine measures them.
    patches: Vec<Option<[u8; 32]>>,
}

/// Files of finished bands, by number.
pub type FinishedBands = BTreeMap<u64, (PathBuf, RunHeader)>;

impl<'a> BandRun<'a> {
    /// Goes on after what was found, which must be of this campaign.
    ///
    /// Errors: `Format` where it is not of the same patches.
    pub fn new(
        (campaign, plan): (&'a Campaign, &'a Plan),
        (files, checkpoint): (&'a BandFiles, &'a Checkpoint),
        finished: FinishedBands,
        under_way: Option<FoundCheckpoint>,
    ) -> Result<Self> {
        let mut patches: Vec<Option<[u8; 32]>> = vec![None; plan.realisations as usize];
        let headers = finished.values().map(|(path, header)| (path, header));
        for (path, header) in headers.chain(under_way.iter().map(|found| (&found.path, &found.kept.header))) {
            for (known, digest) in patches.iter_mut().zip(&header.digests) {
                if known.is_some() && digest.is_some() && known != digest {
                    return Err(Error::format(path, "is of other patches than the bands before it"));
                }
                *known = known.or(*digest);
            }
        }
        Ok(BandRun { campaign, plan, files, checkpoint, finished, under_way, patches })
    }

    /// Starts that are measured.
    pub fn starts(&self) -> u64 {
        let finished = self.finished.values().map(|(_, header)| header.starts);
        let under_way = self.under_way.iter().map(|found| &found.kept.header);
        let is_finished = |band: Band| self.finished.contains_key(&band.number);
        let alone = under_way.filter(|header| !header.band.is_some_and(is_finished));
        finished.chain(alone.map(|header| header.starts)).sum()
    }

    /// The tables of the band of these stops, and what it has cost. Its file is there afterwards, its checkpoint is not.
    ///
    /// Errors: as [`go_on`]; `Format`, which names a file that cannot be gone on from.
    /// Held by: `a_run_in_bands_that_is_killed_ends_with_the_same_bytes` (tests/process/kills_in_bands.rs).
    pub fn tables(
        &mut self,
        stops: Range<usize>,
        patches: &Patches,
        session: &Session,
    ) -> Result<(Vec<Measured>, Cost)> {
        let plan = self.plan.of_band(stops)?;
        let (run_state, is_kept) = self.run_state(&plan)?;
        if session.is_over() {
            let band = plan.band.map_or(String::new(), |band| band.to_string());
            return Err(Error::Interrupted(format!("before band {band}")));
        }
        let run_state = if is_kept && run_state.is_at_its_end() {
            run_state
        } else {
            let run_state = go_on(self.campaign, &plan, patches, run_state, session)?;
            self.files.save(&run_state, self.campaign, &plan)?;
            // Until now the checkpoint was all that there was of the band.
            self.checkpoint.remove()?;
            run_state
        };
        self.patches.clone_from(&run_state.digests);
        Ok(tables(self.campaign, &plan, run_state))
    }

    /// What there is of a band, and whether that is in its file.
    fn run_state(&mut self, plan: &Plan) -> Result<(RunState, bool)> {
        let number = plan.band.map_or(0, |band| band.number);
        let under_way = self.under_way.take_if(|found| found.kept.header.band == plan.band);
        let file = self.finished.get(&number);
        let (path, kept, is_kept) = match (file, under_way) {
            (None, None) => (None, None, false),
            // A checkpoint that is left of a finished band has no more than its file, unless the run went on to more
            // samples from that file.
            (Some((path, header)), Some(found)) if header.campaign == found.kept.header.campaign => {
                self.checkpoint.remove()?;
                (Some(path.clone()), Some(band_files::load(path)?), true)
            }
            (Some((path, _)), None) => (Some(path.clone()), Some(band_files::load(path)?), true),
            (_, Some(found)) => (Some(found.path), Some(found.kept), false),
        };
        let run_state = match path.zip(kept) {
            Some((path, kept)) => {
                let wrong = |why| Error::format(&path, format!("{why}; --force starts again"));
                kept.run_state(self.campaign, plan).map_err(wrong)?
            }
            None => RunState::new(self.campaign, plan),
        };
        Ok((run_state.on_patches(&self.patches), is_kept))
    }
}
