//! The blocks of one realisation: in parallel, in any order, and added to the ledger from time to time.

use std::ops::Range;
use std::time::Instant;

use rayon::prelude::*;

use super::run::Context;
use super::session::locked;
use super::stage::{Group, Mounted, Stage};
use super::tally::Tally;
use super::ways::Work;
use crate::error::Result;

/// Where a pass is: a table and a realisation.
pub(super) type Place = (usize, u64);

impl Context<'_> {
    /// What the open stops of one table and realisation miss of `blocks`, in any order. Ends early where the run is
    /// interrupted.
    pub(super) fn pass(&self, mounted: &Mounted, place: Place, blocks: &Range<u64>) -> Result<()> {
        let (alpha, missing) = {
            let ledger = locked(&self.ledger);
            let table = ledger.tables.table(place.0);
            let missing = |stop: usize| {
                let ranges = table.missing(place.1, stop, blocks);
                (stop, ranges.into_iter().flatten().collect::<Vec<u64>>())
            };
            let missing: Vec<_> = table.open_stops().map(missing).filter(|(_, m)| !m.is_empty()).collect();
            (table.alpha, missing)
        };
        let stage = mounted.stage(alpha, self.kernel, self.campaign);
        let open: Vec<usize> = missing.iter().map(|(stop, _)| *stop).collect();
        let groups = stage.groups(&open, self.campaign, self.plan, place.1);
        let parts: Vec<_> = groups.iter().flat_map(|group| parts(group, &missing)).collect();
        let in_all = parts.iter().map(|(group, missing)| group.stops.len() * missing.len()).sum();
        parts.par_iter().try_for_each(|(group, missing)| {
            missing
                .par_chunks(stage.blocks_together(group.way, in_all, self.plan))
                .try_fold(|| Pending::new(self, place, group), |pending, blocks| pending.with(&stage, blocks))
                .try_for_each(|pending| pending?.flush())
        })
    }
}

/// A group cut into parts that miss the same blocks: one part, but after an interruption.
fn parts(group: &Group, missing: &[(usize, Vec<u64>)]) -> Vec<(Group, Vec<u64>)> {
    let mut parts: Vec<(Group, Vec<u64>)> = Vec::new();
    for (stop, blocks) in missing.iter().filter(|(stop, _)| group.stops.contains(stop)) {
        match parts.iter_mut().find(|(_, same)| same == blocks) {
            Some((part, _)) => part.stops.push(*stop),
            None => parts.push((Group { stops: vec![*stop], way: group.way }, blocks.clone())),
        }
    }
    parts
}

/// Sums of finished blocks that the ledger does not have yet.
struct Pending<'a> {
    context: &'a Context<'a>,
    place: Place,
    group: &'a Group,
    blocks: Vec<u64>,
    tallies: Vec<Tally>,
    since: Instant,
}

impl<'a> Pending<'a> {
    fn new(context: &'a Context<'a>, place: Place, group: &'a Group) -> Self {
        Pending { context, place, group, blocks: Vec::new(), tallies: Vec::new(), since: Instant::now() }
    }

    /// With some more blocks, unless the run is interrupted: long ones are not waited for.
    fn with(mut self, stage: &Stage, blocks: &[u64]) -> Result<Self> {
        if self.context.session.is_over() {
            return Ok(self);
        }
        let Pending { context, place, group, .. } = self;
        if self.tallies.is_empty() {
            let empty = Tally::new(context.plan.bins, &context.plan.weighing);
            self.tallies = vec![empty; group.stops.len()];
        }
        let work = Work { stage, group, realisation: place.1, blocks };
        context.blocks(&work, &mut self.tallies);
        self.blocks.extend(blocks);
        let starts = self.blocks.len() as u64 * context.plan.block_starts;
        if context.session.is_over() && self.tallies.iter().any(|tally| tally.starts() < starts) {
            // Given up half-way, and what this thread kept to itself with it: half a second's work.
            return Ok(Pending::new(context, place, group));
        }
        if self.since.elapsed() < self.context.session.pace.kept_by_a_thread() {
            return Ok(self);
        }
        self.flush()?;
        Ok(Pending::new(context, place, group))
    }

    /// Adds all to the ledger.
    fn flush(self) -> Result<()> {
        let tallies = self.group.stops.iter().copied().zip(self.tallies);
        locked(&self.context.ledger).tables.add(self.place, &self.blocks, tallies, self.context.plan)
    }
}
