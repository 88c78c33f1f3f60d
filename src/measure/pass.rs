//! The blocks of one realisation: in parallel, in any order, and added to the run_state from time to time.

use std::ops::Range;
use std::time::Instant;

use rayon::prelude::*;

use super::accumulate::tally::Tally;
use super::blocks::tracer::Work;
use super::context::Context;
use super::prepared_patch::{LitSampler, PreparedPatch};
use super::session::locked;
use crate::error::Result;

/// Where a pass is: a table and a realisation.
pub(super) type TableRealisation = (usize, u64);

impl Context<'_> {
    /// What the open incidences of one table and realisation miss of `blocks`, in any order. Ends early where the run is
    /// interrupted.
    pub(super) fn pass(
        &self,
        patch: &PreparedPatch,
        place: TableRealisation,
        blocks: &Range<u64>,
    ) -> Result<()> {
        let (alpha, missing) = {
            let run_state = locked(&self.run_state);
            let table = run_state.tables.table(place.0);
            let missing = |incidence: usize| {
                let ranges = table.missing(place.1, incidence, blocks);
                (incidence, ranges.into_iter().flatten().collect::<Vec<u64>>())
            };
            (table.alpha, table.open_incidences().map(missing).collect::<Vec<_>>())
        };
        let samplers = patch.samplers(self, alpha, place.1);
        let in_all = missing.iter().map(|(_, missing)| missing.len()).sum();
        missing.par_iter().try_for_each(|(incidence, missing)| {
            missing
                .par_chunks(samplers[0].0.blocks_together(in_all, self.plan))
                .try_fold(
                    || Pending::new(self, place, *incidence),
                    |pending, blocks| pending.with(&samplers, blocks),
                )
                .try_for_each(|pending| pending?.flush())
        })
    }
}

/// Sums of finished blocks that the run_state does not have yet.
struct Pending<'a> {
    context: &'a Context<'a>,
    place: TableRealisation,
    incidence: usize,
    blocks: Vec<u64>,
    tally: Option<Tally>,
    since: Instant,
}

impl<'a> Pending<'a> {
    fn new(context: &'a Context<'a>, place: TableRealisation, incidence: usize) -> Self {
        Pending { context, place, incidence, blocks: Vec::new(), tally: None, since: Instant::now() }
    }

    /// With some more blocks, unless the run is interrupted: long ones are not waited for.
    fn with(mut self, samplers: &[LitSampler], blocks: &[u64]) -> Result<Self> {
        let Pending { context, place, incidence, .. } = self;
        if context.session.is_over() {
            return Ok(self);
        }
        let tally = self.tally.get_or_insert_with(|| Tally::new(context.plan.bins, &context.plan.sums));
        for (sampler, ways) in samplers {
            context.blocks(&Work { sampler, ways, incidence, realisation: place.1, blocks }, tally);
        }
        (context.session.progress)(context.plan.block_starts * blocks.len() as u64);
        self.blocks.extend(blocks);
        let paths = self.blocks.len() as u64 * context.plan.block_paths();
        if context.session.is_over() && tally.paths() < paths {
            // Given up half-way, and what this thread kept to itself with it: half a second's work.
            return Ok(Pending::new(context, place, incidence));
        }
        if self.since.elapsed() < context.session.pace.kept_by_a_thread() {
            return Ok(self);
        }
        self.flush()?;
        Ok(Pending::new(context, place, incidence))
    }

    /// Adds all to the run_state.
    fn flush(self) -> Result<()> {
        let Pending { context, place, incidence, blocks, tally, .. } = self;
        let Some(tally) = tally else { return Ok(()) };
        locked(&context.run_state).tables.add(place, incidence, &blocks, tally, context.plan)
    }
}
