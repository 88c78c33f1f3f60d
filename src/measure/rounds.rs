//! The tables under way: what every incidence has so far, and which are still measured.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::accumulate::tally::Tally;
use super::accumulate::tally_flux::TallyFlux;
use super::persist::finished_blocks::FinishedBlocks;
use super::plan::Plan;
use super::stopping::{self, IncidenceProgress, StoppedBy, relative_error};
use crate::campaign::{Alpha, Campaign};
use crate::error::Error;

/// One table for each roughness.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Tables {
    tables: Vec<TableRun>,
    /// Blocks of every realisation after the last round that is over.
    judged: u64,
    /// Finished blocks of all incidences, realisations and tables.
    #[serde(skip)]
    done: u64,
}

/// The table of one roughness.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct TableRun {
    /// Known from the campaign.
    #[serde(skip)]
    pub alpha: Option<Alpha>,
    /// [realisation][incidence].
    sums: Vec<Vec<Sum>>,
    #[serde(rename = "stops")]
    incidences: Vec<IncidenceProgress>,
}

/// What one incidence and realisation has.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct Sum {
    done: FinishedBlocks,
    /// The sums of these blocks; `None` before the first.
    tally: Option<Box<Tally>>,
}

/// A table that goes no further.
pub(crate) struct FinishedTable {
    pub alpha: Option<Alpha>,
    /// [realisation][incidence].
    sums: Vec<Vec<Sum>>,
    /// What ended each incidence.
    pub incidences: Vec<IncidenceProgress>,
}

impl Tables {
    pub fn new(campaign: &Campaign, plan: &Plan) -> Self {
        let table = |alpha| TableRun {
            alpha,
            sums: vec![vec![Sum::default(); plan.incidences]; plan.realisations as usize],
            incidences: vec![IncidenceProgress::default(); plan.incidences],
        };
        Tables { tables: campaign.alphas().into_iter().map(table).collect(), judged: 0, done: 0 }
    }

    /// The table number `index`.
    pub fn table(&self, index: usize) -> &TableRun {
        &self.tables[index]
    }

    /// How many tables there are.
    pub fn count(&self) -> usize {
        self.tables.len()
    }

    /// Adds finished blocks of some incidences, integers in any order.
    ///
    /// Errors: `Internal` where a surface sample is lost or missing.
    pub fn add(
        &mut self,
        (table, realisation): (usize, u64),
        incidence: usize,
        blocks: &[u64],
        tally: Tally,
        plan: &Plan,
    ) -> Result<(), Error> {
        let (wanted, paths) = (blocks.len() as u64 * plan.block_paths(), tally.paths());
        if tally.lost > 0 || paths != wanted {
            let lost = tally.lost;
            return Err(Error::Internal(format!(
                "realisation {realisation}, incidence {incidence}, blocks {blocks:?}: {lost} rays lost, {paths} of {wanted} paths \
                 counted"
            )));
        }
        let sum = &mut self.tables[table].sums[realisation as usize][incidence];
        blocks.iter().for_each(|&block| sum.done.insert(block));
        self.done += blocks.len() as u64;
        match &mut sum.tally {
            Some(before) => before.merge(&tally),
            none => *none = Some(Box::new(tally)),
        }
        Ok(())
    }

    /// Whether a realisation misses any of these blocks at an incidence that is still measured.
    pub fn misses(&self, realisation: u64, blocks: &Range<u64>) -> bool {
        let misses = |table: &TableRun| {
            table.open_incidences().any(|incidence| !table.missing(realisation, incidence, blocks).is_empty())
        };
        self.tables.iter().any(misses)
    }

    /// Whether the round that ends after so many blocks is over.
    pub fn is_judged(&self, blocks: u64) -> bool {
        blocks <= self.judged
    }

    /// After all realisations have `blocks` blocks: which incidences have enough.
    pub fn judge(&mut self, campaign: &Campaign, plan: &Plan, blocks: u64) {
        let wanted = campaign.stop.relative_error;
        let looked_at = stopping::is_looked_at(blocks, plan.blocks);
        for table in &mut self.tables {
            for incidence in table.open_incidences().collect::<Vec<_>>() {
                match wanted {
                    Some(wanted) if looked_at => {
                        let error = table.relative_error(plan, incidence);
                        table.incidences[incidence].judge(blocks, error, wanted, plan.realisations);
                    }
                    _ => {}
                }
                let progress = &mut table.incidences[incidence];
                progress.blocks = blocks;
                if blocks == plan.blocks && progress.by.is_none() {
                    progress.by = Some(StoppedBy::Samples);
                }
            }
        }
        self.judged = blocks;
    }

    /// Ends what is open: the time is over.
    pub fn time_is_over(&mut self) {
        for incidence in self.tables.iter_mut().flat_map(|table| &mut table.incidences) {
            incidence.by = incidence.by.or(Some(StoppedBy::Seconds));
        }
    }

    pub fn all_ended(&self) -> bool {
        self.tables.iter().all(|table| table.open_incidences().next().is_none())
    }

    /// Samples so far, of all tables, incidences and realisations.
    pub fn starts(&self, plan: &Plan) -> u64 {
        self.done * plan.block_starts
    }

    /// Continues a run of `planned` blocks, or of fewer realisations, towards the whole plan: as if every incidence had
    /// only been looked at where this plan looks.
    ///
    // Tested by `more_samples_give_the_bytes_of_a_fresh_run` in `tests/process/kills_and_resume.rs`.
    pub fn extend(&mut self, campaign: &Campaign, plan: &Plan, planned: u64) {
        let realisations = plan.realisations as usize;
        let more_realisations = self.tables.iter().any(|table| table.sums.len() < realisations);
        if planned == plan.blocks && !more_realisations {
            return;
        }
        let ends = stopping::rounds(&campaign.stop, plan.blocks).map(|round| round.end);
        let last = ends.take_while(|&end| end <= self.judged).last();
        self.judged = if more_realisations { 0 } else { last.unwrap_or(0) };
        for table in &mut self.tables {
            table.sums.resize_with(realisations, || vec![Sum::default(); plan.incidences]);
            for incidence in &mut table.incidences {
                if incidence.blocks > self.judged || incidence.by == Some(StoppedBy::Samples) {
                    incidence.rewind(self.judged);
                }
            }
        }
    }

    /// Whether errors or the clock have been looked at, which depends on how many realisations there are.
    pub fn has_looked(&self, campaign: &Campaign) -> bool {
        self.judged > 0 && (campaign.stop.relative_error.is_some() || campaign.stop.seconds.is_some())
    }

    /// Whether these tables, read from a file, can be those of a run of `planned` blocks under this plan, with as
    /// many realisations or fewer; else what is wrong.
    pub fn check(&self, campaign: &Campaign, plan: &Plan, planned: u64) -> Result<(), String> {
        let wrong =
            |what: &str, found: usize, wanted: usize| Err(format!("{found} {what}, {wanted} expected"));
        let roughnesses = campaign.alphas().len();
        if self.tables.len() != roughnesses {
            return wrong("roughnesses", self.tables.len(), roughnesses);
        }
        let shape = Tally::new(plan.bins, &plan.sums);
        for table in &self.tables {
            if table.sums.is_empty() || table.sums.len() > plan.realisations as usize {
                return wrong("realisations", table.sums.len(), plan.realisations as usize);
            }
            let rows = table.sums.iter().map(Vec::len);
            if let Some(incidences) =
                rows.chain([table.incidences.len()]).find(|&incidences| incidences != plan.incidences)
            {
                return wrong("stops", incidences, plan.incidences);
            }
            let sound = table.sums.iter().flatten().all(|sum| sum.is_sound(&shape, plan, planned))
                && table.incidences.iter().all(|incidence| incidence.blocks <= planned);
            if !sound || self.judged > planned {
                return Err("sums that no run has".into());
            }
        }
        Ok(())
    }

    /// Fills in what files do not repeat: the roughnesses, and how many blocks there are.
    pub fn complete(&mut self, campaign: &Campaign) {
        let sums = self.tables.iter().flat_map(|table| table.sums.iter().flatten());
        self.done = sums.map(|sum| sum.done.count()).sum();
        for (table, alpha) in self.tables.iter_mut().zip(campaign.alphas()) {
            table.alpha = alpha;
        }
    }

    /// Takes over incidences of other tables of the same campaign (`places`: theirs, here), which must be at their end, or
    /// says what is wrong.
    pub fn take(&mut self, other: Tables, places: &[(usize, usize)]) -> Result<(), String> {
        for (mine, mut theirs) in self.tables.iter_mut().zip(other.tables) {
            for &(incidence, place) in places {
                let IncidenceProgress { blocks, by, .. } = theirs.incidences[incidence];
                let ended =
                    by.is_some() && theirs.sums.iter().all(|sums| sums[incidence].done.count() == blocks);
                if !ended || blocks == 0 || mine.sums.len() != theirs.sums.len() {
                    return Err(format!("incidence {incidence} is not measured to its end"));
                }
                for (mine, theirs) in mine.sums.iter_mut().zip(&mut theirs.sums) {
                    mine[place] = std::mem::take(&mut theirs[incidence]);
                    self.done += blocks;
                }
                mine.incidences[place] = std::mem::take(&mut theirs.incidences[incidence]);
            }
        }
        Ok(())
    }

    /// About as many bytes as the sums take in a file: a sum of 2^-90 has 12 digits of base 128 where it is not near 0.
    pub fn bytes(&self) -> usize {
        let sums = self.tables.iter().flat_map(|table| table.sums.iter().flatten());
        sums.filter_map(|sum| sum.tally.as_ref()).map(|tally| 14 * tally.sums() + 512).sum()
    }

    /// Every table.
    pub fn finished(self) -> Vec<FinishedTable> {
        let finished =
            |TableRun { alpha, sums, incidences, .. }: TableRun| FinishedTable { alpha, sums, incidences };
        self.tables.into_iter().map(finished).collect()
    }
}

impl FinishedTable {
    /// The flux of every realisation and incidence: \[realisation\]\[incidence\].
    pub fn flux(&self) -> Vec<Vec<TallyFlux<'_>>> {
        self.sums.iter().map(|sums| sums.iter().filter_map(Sum::flux).collect()).collect()
    }
}

impl Sum {
    /// As a fraction of what fell on the patch; `None` before the first block.
    fn flux(&self) -> Option<TallyFlux<'_>> {
        self.tally.as_ref().map(|tally| TallyFlux::new(tally, self.done.count()))
    }

    /// Whether a run can have these sums: every surface sample of the finished blocks is counted once, and no sum is near
    /// overflow.
    fn is_sound(&self, shape: &Tally, plan: &Plan, planned: u64) -> bool {
        let starts = self.done.is_sound(planned).then(|| self.done.count() * plan.block_starts);
        match (&self.tally, starts) {
            (Some(tally), Some(starts)) => {
                tally.has_shape_of(shape) && tally.is_sound(starts, plan.sums.paths_of_a_start())
            }
            (None, starts) => starts == Some(0),
            (Some(_), None) => false,
        }
    }
}

impl TableRun {
    /// The incidences that are still measured.
    pub fn open_incidences(&self) -> impl Iterator<Item = usize> {
        (0..self.incidences.len()).filter(|&incidence| self.incidences[incidence].by.is_none())
    }

    /// What an incidence of a realisation misses of `blocks`.
    pub fn missing(&self, realisation: u64, incidence: usize, blocks: &Range<u64>) -> Vec<Range<u64>> {
        self.sums[realisation as usize][incidence].done.missing(blocks)
    }

    fn relative_error(&self, plan: &Plan, incidence: usize) -> Option<f64> {
        let flux: Vec<TallyFlux> = self.sums.iter().filter_map(|sums| sums[incidence].flux()).collect();
        let regions = plan.grid.regions(incidence);
        let sizes: Vec<f64> = regions.iter().map(|region| region.projected_solid_angle()).collect();
        relative_error(&flux, &sizes, &plan.sums)
    }
}
