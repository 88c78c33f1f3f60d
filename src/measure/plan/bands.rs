//! Tables larger than memory: a measurement in bands of stops, one after the other.
//!
//! What a stop shows does not depend on the others, as its random numbers follow from its angles. A band is therefore
//! the same measurement with fewer stops, and the bands' rows are those of the whole table.

use std::fmt;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::Plan;
use super::estimate::Memory;
use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::patches::Patches;
use crate::measure::plan;
use crate::table::rows;

/// The share of the memory that patches may take which are kept from band to band.
pub(crate) const KEPT_SHARE: u64 = 4;

/// One band of a run in bands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Band {
    /// From 1.
    pub number: u64,
    /// How many there are.
    pub of: u64,
    /// Stops in each but the last, which may have fewer.
    pub stops: u64,
}

impl fmt::Display for Band {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {}", self.number, self.of)
    }
}

impl Band {
    /// The name of its file, in a run whose files begin with `stem`.
    pub fn file_name(self, stem: &str) -> String {
        format!("{stem}.band_{}_of_{}", self.number, self.of)
    }

    /// Whether a file's name may be that of a band of such a run.
    pub fn is_file_name(name: &str, stem: &str) -> bool {
        let numbers = name.strip_prefix(stem).and_then(|end| end.strip_prefix(".band_"));
        let numbers = numbers.and_then(|end| end.split_once("_of_"));
        numbers.is_some_and(|(k, n)| k.parse::<u64>().is_ok() && n.parse::<u64>().is_ok())
    }
}

/// The plan of a run that began with so many stops at a time, or with all.
///
/// Errors: `Refused` where these do not fit `limit` bytes; as [`plan::plan`].
pub fn plan_in_bands(campaign: &Campaign, stops: Option<u64>, limit: u64) -> Result<Plan> {
    let (mut plan, memory) = plan::decided(campaign, None)?;
    let stops = stops.map_or(Some(plan.stops), |stops| usize::try_from(stops).ok());
    let Some(stops) = stops.filter(|stops| (1..=plan.stops).contains(stops)) else {
        return Err(Error::Refused(format!("{}: bands of other lengths than a run has", campaign.name)));
    };
    if stops < plan.stops {
        plan.band_stops = stops;
        plan.memory_bytes = plan::saturated(memory.banded(stops));
    }
    if plan.memory_bytes > limit {
        let at_a_time =
            if stops < plan.stops { format!("bands of {stops} stops") } else { "all stops at once".into() };
        return Err(Error::Refused(format!(
            "{}: goes on with {at_a_time}, as it began, which needs about {} MiB of memory, {} MiB may be used; \
             --memory-mb allows more, --force starts again in bands that fit",
            campaign.name,
            plan.memory_bytes.div_ceil(1 << 20),
            limit >> 20
        )));
    }
    plan::checked(campaign, plan, limit)
}

/// How many stops fit `limit` bytes at a time; `None` where not one does, or where bands make no sense: a budget of
/// time would hold for each of them.
pub(crate) fn stops_within(campaign: &Campaign, plan: &Plan, memory: &Memory, limit: u64) -> Option<usize> {
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

    /// The plan of one of these bands, by its stops.
    pub(crate) fn of_band(&self, stops: Range<usize>) -> Result<Plan> {
        let (each, of) = (self.band_stops, self.stops.div_ceil(self.band_stops.max(1)));
        let number = stops.start / each.max(1) + 1;
        let band = Band { number: number as u64, of: of as u64, stops: each as u64 };
        let plan = self.of_stops(&stops.collect::<Vec<_>>());
        let plan = plan.ok_or_else(|| Error::Internal("half vectors in a campaign".into()))?;
        Ok(Plan { band: Some(band), ..plan })
    }

    /// The plan of some of the stops: their figures are those that they have among all. `None` for half vectors.
    ///
    /// Held by: `a_campaign_measured_in_bands_gives_the_same_bytes` (tests/it/table/large_tables.rs).
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
