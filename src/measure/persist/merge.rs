//! Shards put together: the tables of all stops at once, or of a band of them after the other, one shard in memory.

use std::ops::Range;

use super::run_state::RunState;
use super::shard::Shards;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::accumulate::assemble::Measured;
use crate::measure::cost::Cost;
use crate::measure::driver::tables;
use crate::measure::plan;
use crate::measure::plan::Plan;
use crate::measure::plan::bands::KEPT_SHARE;
use crate::measure::plan::estimate::Memory;

/// Shards of one campaign, and how they are put together.
pub struct Merge {
    shards: Shards,
    /// The plan of the whole campaign.
    whole: Plan,
    /// What each shard was dealt.
    dealt: Vec<Vec<usize>>,
    /// The stops that are there, increasing.
    stops: Vec<usize>,
    /// The plan of these stops.
    plan: Plan,
}

impl Merge {
    /// Prepares it for `limit` bytes of memory, without time being asked for: it was spent by the shards.
    ///
    /// Errors: `Refused` where they do not hold a shard and one stop.
    pub fn new(shards: Shards, campaign: &Campaign, limit: u64) -> Result<Self> {
        let (whole, memory) = plan::decided(campaign, None)?;
        let dealt = shards.dealt(&whole.grid);
        let mut stops = dealt.concat();
        stops.sort_unstable();
        let mut plan = if stops.len() == whole.stops {
            whole.clone()
        } else {
            whole.of_stops(&stops).ok_or_else(|| Error::Internal("half vectors in a campaign".into()))?
        };
        let mut largest = 0;
        for (dealt, file) in dealt.iter().zip(shards.files()) {
            let bytes = file.metadata().map_err(|e| Error::io(file, e))?.len();
            largest = largest.max(u128::from(bytes) + sums_of(campaign, &whole) * dealt.len() as u128);
        }
        (plan.band_stops, plan.memory_bytes) = stops_within((&memory, largest), stops.len(), limit)
            .map_err(|why| Error::Refused(format!("{}: {why}", campaign.name)))?;
        Ok(Merge { shards, whole, dealt, stops, plan })
    }

    /// The plan of the stops that are there.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The stops that are there, by their numbers in the whole campaign.
    pub fn stops(&self) -> &[usize] {
        &self.stops
    }

    /// The tables of a band of these stops, and at the first of them what the shards have cost together. `campaign` may
    /// have another name.
    ///
    /// Errors: `Format`, which names a file with sums that no run has, or of a run that was not at its end.
    /// Held by: `shards_merged_in_bands_have_the_bytes_of_one_run` (tests/process/shards.rs).
    pub fn tables(&self, campaign: &Campaign, band: Range<usize>) -> Result<(Vec<Measured>, Cost)> {
        let cost = if band.start == 0 { self.shards.cost() } else { Cost::default() };
        let threads = rayon::current_num_threads();
        let part = if band.len() == self.plan.stops {
            self.plan.clone()
        } else {
            self.plan.of_band(band.clone())?
        };
        let mut run_state = RunState::new(campaign, &part);
        let wanted = &self.stops[band];
        for (dealt, file) in self.dealt.iter().zip(self.shards.files()) {
            let places = wanted.iter().zip(0..).filter(|(stop, _)| dealt.binary_search(stop).is_ok());
            let places: Vec<(usize, usize)> = places.map(|(&stop, place)| (stop, place)).collect();
            if !places.is_empty() {
                let shard = super::shard::load(file)?.run_state(campaign, &self.whole);
                let taken = shard.and_then(|shard| run_state.take(shard, &places));
                taken.map_err(|why| Error::format(file, why))?;
            }
        }
        Ok((tables(campaign, &part, run_state).0, Cost { threads, ..cost }))
    }
}

/// Bytes of the sums of one stop in memory: counts and hits of a bin, fixed-point sums, and what a stop has besides.
fn sums_of(campaign: &Campaign, plan: &Plan) -> u128 {
    let sums = (plan.sums.first_sums() + plan.sums.multiple_sums()) as u128;
    let tallies = u128::from(plan.realisations) * campaign.alphas().len() as u128;
    let copies = if campaign.surface.kind.is_open_map() { 2 } else { 1 };
    copies * tallies * (plan.bins as u128 * (16 + 16 * sums) + 1024)
}

/// How many of `stops` are merged at a time beside a shard of `shard` bytes, and the bytes that takes; or what is wrong.
fn stops_within(
    (memory, shard): (&Memory, u128),
    stops: usize,
    limit: u64,
) -> std::result::Result<(usize, u64), String> {
    let takes = |stops: usize| memory.banded(stops).saturating_add(shard);
    if takes(1) > u128::from(limit) || stops == 0 {
        return Err(format!(
            "one stop and the largest shard need about {} MiB of memory, {} MiB may be used; --memory-mb allows more, \
             shards of fewer stops need less",
            takes(1).div_ceil(1 << 20),
            limit >> 20
        ));
    }
    // As in runs in bands a quarter is left free, but for the first stop.
    let room = u128::from(limit - limit / KEPT_SHARE).saturating_sub(takes(0));
    let fit = usize::try_from(room / (memory.stop + memory.written).max(1)).unwrap_or(usize::MAX);
    let fit = fit.clamp(1, stops);
    Ok((fit, plan::saturated(takes(fit))))
}
