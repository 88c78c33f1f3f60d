//! The files of parts put together: the tables of all incidences at once, or band after band, one file in memory.

use std::ops::Range;

use super::run_files::{FinishedBands, PartFile, load_part};
use super::run_state::RunState;
use super::shards::Shards;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::accumulate::assemble::Measured;
use crate::measure::cost::Cost;
use crate::measure::driver::tables;
use crate::measure::plan::{self, Plan};

/// Files of one campaign's parts, and how they are put together.
pub struct Merge {
    /// Each with its incidences among all, increasing.
    files: Vec<(PartFile, Vec<usize>)>,
    /// The plan of the whole campaign.
    whole: Plan,
    /// The incidences that are there, increasing.
    incidences: Vec<usize>,
    /// The plan of these.
    plan: Plan,
}

impl Merge {
    /// Prepares it for `limit` bytes of memory, without time being asked for: it was spent by the shards.
    ///
    /// Errors: `Refused` where they do not hold a shard and one incidence.
    pub fn of_shards(shards: Shards, campaign: &Campaign, limit: u64) -> Result<Self> {
        let whole = plan::at_once(campaign);
        let files = with_incidences(shards.files(), &whole);
        let mut incidences: Vec<usize> =
            files.iter().flat_map(|(_, incidences)| incidences).copied().collect();
        incidences.sort_unstable();
        let mut largest = 0;
        for (file, incidences) in &files {
            let bytes = file.path.metadata().map_err(|e| Error::io(&file.path, e))?.len();
            largest = largest.max(u128::from(bytes) + sums_of(campaign, &whole) * incidences.len() as u128);
        }
        let plan = if incidences.len() == whole.incidences {
            whole.clone()
        } else {
            whole.of_incidences(&incidences)?
        };
        let plan = plan::merged(campaign, plan, largest, limit)?;
        Ok(Merge { files, whole, incidences, plan })
    }

    /// The bands of a run under this plan, each of which has its file.
    pub(crate) fn of_bands(finished: FinishedBands, plan: &Plan) -> Self {
        let files = with_incidences(finished.into_values().collect(), plan);
        Merge { files, whole: plan.clone(), incidences: (0..plan.incidences).collect(), plan: plan.clone() }
    }

    /// The plan of the incidences that are there.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The incidences that are there, by their numbers in the whole campaign.
    pub fn incidences(&self) -> &[usize] {
        &self.incidences
    }

    /// The tables of a band of these incidences, and at the first of them what the parts have cost together. `campaign`
    /// may have another name.
    ///
    /// Errors: `Format`, which names a file with sums that no run has, or of a run that was not at its end.
    // Tested by `shards_merged_in_bands_have_the_bytes_of_one_run` (tests/process/shards.rs).
    pub fn tables(&self, campaign: &Campaign, band: Range<usize>) -> Result<(Vec<Measured>, Cost)> {
        let cost = if band.start == 0 { self.cost() } else { Cost::default() };
        let part = if band.len() == self.plan.incidences {
            self.plan.clone()
        } else {
            self.plan.of_incidences(&band.clone().collect::<Vec<_>>())?
        };
        let mut run_state = RunState::new(campaign, &part);
        let wanted = &self.incidences[band];
        for (file, incidences) in &self.files {
            let place = |(here, incidence)| Some((incidences.binary_search(incidence).ok()?, here));
            let places: Vec<(usize, usize)> = wanted.iter().enumerate().filter_map(place).collect();
            if !places.is_empty() {
                let plan = self.whole.of_part(file.header.part)?;
                let taken = load_part(&file.path)?.run_state(campaign, &plan);
                let taken = taken.and_then(|theirs| run_state.take(theirs, &places));
                taken.map_err(|why| Error::format(&file.path, why))?;
            }
        }
        let threads = rayon::current_num_threads();
        Ok((tables(campaign, &part, run_state).0, Cost { threads, ..cost }))
    }

    /// What the parts have cost together.
    pub(crate) fn cost(&self) -> Cost {
        self.files.iter().map(|(file, _)| file.header.cost()).fold(Cost::default(), Cost::plus)
    }
}

fn with_incidences(files: Vec<PartFile>, whole: &Plan) -> Vec<(PartFile, Vec<usize>)> {
    let incidences = files.iter().map(|file| file.header.part.incidences(&whole.grid)).collect::<Vec<_>>();
    files.into_iter().zip(incidences).collect()
}

/// Bytes of the sums of one incidence in memory: counts and hits of a bin, fixed-point sums, and what it has besides.
fn sums_of(campaign: &Campaign, plan: &Plan) -> u128 {
    let sums = plan.sums.sums_of_a_bin() as u128;
    let tallies = u128::from(plan.realisations) * campaign.alphas().len() as u128;
    let copies = if campaign.surface.kind.is_open_map() { 2 } else { 1 };
    let counts = 8 + 8 * plan.sums.hit_sets() as u128;
    copies * tallies * (plan.bins as u128 * (counts + 16 * sums) + 1024)
}
