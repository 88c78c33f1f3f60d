//! Tables larger than memory: a measurement in bands of stops, one after the other.
//!
//! What a stop shows does not depend on the others, as its random numbers follow from its angles. A band is therefore
//! the same measurement with fewer stops, and the bands' rows are those of the whole table.

use std::ops::Range;

use super::estimate::Memory;
use super::patches::Patches;
use super::plan::Plan;
use crate::campaign::Campaign;
use crate::error::Result;
use crate::table::rows;

/// The share of the memory that patches may take which are kept from band to band.
const KEPT_SHARE: u64 = 4;

/// How many stops fit `limit` bytes at a time; `None` where not one does, or where bands make no sense: a budget of
/// time would hold for each of them.
pub(super) fn stops_within(campaign: &Campaign, plan: &Plan, memory: &Memory, limit: u64) -> Option<usize> {
    let possible = campaign.stop.seconds.is_none() && plan.grid.of_stops([]).is_some();
    let room = u128::from(limit - limit / KEPT_SHARE).checked_sub(memory.shared)?;
    let stops = usize::try_from(room / (memory.stop + memory.written).max(1)).unwrap_or(usize::MAX);
    (possible && stops > 0).then_some(stops.min(plan.stops))
}

impl Plan {
    /// The bands of stops that are measured one after the other; one where all fit the memory.
    pub fn bands(&self) -> Vec<Range<usize>> {
        rows::bands(self.stops, 1, self.band_stops as u64, 1)
    }

    /// The plan of some of the stops: their figures are those that they have among all. `None` for half vectors.
    ///
    /// Held by: `a_campaign_measured_in_bands_gives_the_same_bytes` (tests/large_tables.rs).
    pub fn of_stops(&self, stops: &[usize]) -> Option<Plan> {
        let share = |total: u64| (u128::from(total) * stops.len() as u128 / self.stops.max(1) as u128) as u64;
        Some(Plan {
            grid: self.grid.of_stops(stops.iter().copied())?,
            stops: stops.len(),
            measured: (0..stops.len()).collect(),
            band_stops: stops.len(),
            total_samples: share(self.total_samples),
            folded: stops.iter().map(|&stop| self.folded[stop]).collect(),
            ..self.clone()
        })
    }
}

impl Patches {
    /// Made once for all bands, where they fit `limit` bytes well; else made again for each.
    pub fn for_bands(self, campaign: &Campaign, limit: u64) -> Result<Self> {
        let surface = &campaign.surface;
        let bytes = u128::from(surface.realisations) * u128::from(surface.cells).pow(2) * 8;
        if matches!(self, Patches::Random { .. }) && bytes <= u128::from(limit / KEPT_SHARE) {
            return Patches::held(campaign);
        }
        Ok(self)
    }
}
