//! What a run has so far, and the bytes that keep it: sums of finished blocks, digests of patches, costs.
//!
//! The sums are integers and blocks have numbers, so that a run that is resumed ends with the bytes of one that was
//! never ended.

use super::header::{KIND, RunHeader, unreadable};
use crate::campaign;
use crate::campaign::Campaign;
use crate::error::Error;
use crate::files::sealed;
use crate::measure::cost::Cost;
use crate::measure::plan::{Plan, StartSampler};
use crate::measure::rounds::Tables;

/// A run so far.
#[derive(Debug, Clone)]
pub struct RunState {
    pub(crate) tables: Tables,
    /// SHA-256 of the patch of each realisation, where it has been made and has heights.
    pub(crate) digests: Vec<Option<[u8; 32]>>,
    /// What the run has cost, in all its parts.
    pub(crate) cost: Cost,
}

/// A run_state read from bytes, not yet checked against a campaign.
#[derive(Debug, Clone)]
pub struct StoredRun {
    /// What it is of.
    pub header: RunHeader,
    tables: Tables,
}

impl RunState {
    /// Nothing measured.
    pub fn new(campaign: &Campaign, plan: &Plan) -> Self {
        let digests = vec![None; plan.realisations as usize];
        RunState { tables: Tables::new(campaign, plan), digests, cost: Cost::default() }
    }

    /// Fraction of the planned starts that are measured, in percent: less than 100 also at the end, where incidences ended early.
    pub fn percent(&self, plan: &Plan) -> f64 {
        100.0 * self.tables.starts(plan) as f64 / plan.total_samples.max(1) as f64
    }

    /// Samples that are measured.
    pub fn starts(&self, plan: &Plan) -> u64 {
        self.tables.starts(plan)
    }

    /// Whether every incidence has all that it is to have.
    pub(crate) fn is_at_its_end(&self) -> bool {
        self.tables.all_ended()
    }

    /// The same, to be resumed on these patches alone, as far as they are known.
    pub(crate) fn on_patches(mut self, digests: &[Option<[u8; 32]>]) -> Self {
        for (mine, known) in self.digests.iter_mut().zip(digests) {
            *mine = mine.or(*known);
        }
        self
    }

    /// What the run has cost, in all its parts.
    pub fn cost(&self, plan: &Plan) -> Cost {
        Cost { samples: self.starts(plan), ..self.cost.clone() }
    }

    /// Takes over incidences of another run_state (`places`: theirs, here), which must be at their end, or says what is wrong.
    pub(crate) fn take(&mut self, other: RunState, places: &[(usize, usize)]) -> Result<(), String> {
        self.tables.take(other.tables, places)?;
        for (mine, theirs) in self.digests.iter_mut().zip(other.digests) {
            *mine = mine.or(theirs);
        }
        Ok(())
    }

    /// What its file says of it: the checkpoint of this `number`, or a finished part (0).
    pub(crate) fn header(&self, number: u64, campaign: &Campaign, plan: &Plan) -> RunHeader {
        RunHeader {
            version: env!("CARGO_PKG_VERSION").into(),
            campaign: campaign::to_toml(campaign),
            number,
            part: plan.part,
            starts: self.starts(plan),
            looked: self.tables.has_looked(campaign),
            blocks: plan.blocks,
            by_slope: plan.start_sampler == StartSampler::BySlope,
            digests: self.digests.clone(),
            cost: self.cost.clone(),
        }
    }

    /// The bytes of its file, as `header` has it.
    pub fn to_bytes(&self, number: u64, campaign: &Campaign, plan: &Plan) -> Result<Vec<u8>, Error> {
        let header = self.header(number, campaign, plan);
        sealed::seal(KIND, self.tables.bytes(), |out| postcard::to_extend(&(header, &self.tables), out))
            .map_err(|e| Error::Internal(format!("encoding finished blocks: {e}")))
    }
}

impl StoredRun {
    /// What the bytes of a file hold, or what is wrong with them.
    ///
    /// Memory is bounded by the size of the file.
    // Tested by `damaged_checkpoints_are_errors_and_never_panic`.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let content = sealed::open(KIND, bytes)?;
        let read = postcard::take_from_bytes::<(RunHeader, Tables)>(content);
        let ((header, tables), rest) = read.map_err(|e| unreadable(&e))?;
        if !rest.is_empty() {
            return Err(format!("{} bytes too many", rest.len()));
        }
        Ok(StoredRun { header: header.possible()?, tables })
    }

    /// The run_state, for a campaign that it has no faults with; else what is wrong with the sums.
    pub fn run_state(self, campaign: &Campaign, plan: &Plan) -> Result<RunState, String> {
        let StoredRun { header: RunHeader { part, blocks, by_slope, mut digests, cost, .. }, mut tables } =
            self;
        if part != plan.part {
            return Err("other incidences than those that were asked for".into());
        }
        if by_slope != (plan.start_sampler == StartSampler::BySlope) {
            return Err("so many samples start in another order on the facets than these did".into());
        }
        if blocks > plan.blocks || digests.len() > plan.realisations as usize {
            return Err("more blocks or patches than were asked for".into());
        }
        tables.check(campaign, plan, blocks)?;
        tables.complete(campaign);
        tables.extend(campaign, plan, blocks);
        digests.resize(plan.realisations as usize, None);
        Ok(RunState { tables, digests, cost })
    }
}
