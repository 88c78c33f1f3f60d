//! What a run will put on the disk, before it begins.

use serde::Serialize;

use super::decide::saturated;
use super::decisions::Plan;
use crate::campaign::Campaign;
use crate::table::realisations;
use crate::table::realisations::{GROUPS, StoredRealisations};

/// A sum of 2^-90 in a file, at most 19 digits of base 128 and mostly 12 to 14; a count of a bin, mostly 1 to 3.
const BYTES_PER_SUM: u128 = 14;
const BYTES_PER_COUNT: u128 = 4;
/// Sums of orders and slopes of an incidence and patch.
const BYTES_PER_TALLY: u128 = 512;
/// What a file says before its sums: the campaign, and for each patch a digest.
const BYTES_PER_HEADING: u128 = 4 << 10;
const BYTES_PER_DIGEST: u128 = 34;
/// Two checkpoints, and the third that is to replace one of them.
const CHECKPOINTS: u128 = 3;
/// Summary of an incidence; page without pictures and values; a value in it; the largest page.
const BYTES_PER_INCIDENCE: u128 = 3 << 10;
const BYTES_PER_PAGE: u128 = 300 << 10;
const BYTES_PER_SHOWN_VALUE: u128 = 4;
const LARGEST_PAGE: u128 = 6 << 20;

/// Bytes on the disk, at most about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Disk {
    /// Of the results.
    pub results_bytes: u64,
    /// Of one table's realisations among them, at most.
    pub realisations_bytes: u64,
    /// Of checkpoints and finished bands, which go when the results are there; a run of a second has none.
    pub until_then_bytes: u64,
}

impl Disk {
    /// What a campaign takes under this plan; a shard's result are its sums. Realisations are kept up to `limit` bytes a
    /// file (`SIZE_LIMIT` unasked).
    ///
    /// Values count as if they did not compress.
    // Tested by `what_a_run_takes_on_the_disk_is_said_before` (tests/process/full_disk.rs).
    pub fn of(campaign: &Campaign, plan: &Plan, limit: u64) -> Self {
        let sums = &plan.sums;
        let sums = sums.sums_of_a_bin() as u128;
        // Of an open map the sums of what leaves it besides.
        let copies = if campaign.surface.kind.is_open_map() { 2 } else { 1 };
        let tally =
            copies * (plan.bins as u128 * (2 * BYTES_PER_COUNT + BYTES_PER_SUM * sums) + BYTES_PER_TALLY);
        let tallies = u128::from(plan.realisations) * campaign.alphas().len() as u128;
        let incidence = tally.saturating_mul(tallies);
        let header = BYTES_PER_HEADING + BYTES_PER_DIGEST * u128::from(plan.realisations);
        let file = |incidences: usize| incidence.saturating_mul(incidences as u128).saturating_add(header);
        let bands = plan.bands();
        let in_bands = bands.len() > 1;
        let finished = bands.iter().map(|incidences| file(incidences.len())).filter(|_| in_bands);
        let finished = finished.fold(0, u128::saturating_add);
        let at_a_time = file(plan.band_incidences);
        let results = if plan.part.is_shard() { at_a_time } else { tables(campaign, plan, limit) };
        let until_then = at_a_time.saturating_mul(CHECKPOINTS).saturating_add(finished);
        let materials = if plan.part.is_shard() { 0 } else { campaign.optics.each().len() };
        Disk {
            results_bytes: saturated(results),
            realisations_bytes: (0..materials).map(|k| realisations_of(plan, k, limit)).max().unwrap_or(0),
            until_then_bytes: saturated(until_then),
        }
    }

    /// All that is there at once.
    pub fn bytes(self) -> u64 {
        self.results_bytes.saturating_add(self.until_then_bytes)
    }
}

/// Channels of Schlick's formula.
fn schlick_channels(plan: &Plan) -> usize {
    if plan.sums.serves_any_f0() { 2 + plan.sums.multiple_sums() } else { 0 }
}

/// The realisations' file of a table.
fn realisations_of(plan: &Plan, material: usize, limit: u64) -> u64 {
    let part = 2 * plan.sums.colours(material).len() + schlick_channels(plan);
    let count = plan.realisations as usize;
    match realisations::kept(&plan.grid, part, count, limit) {
        StoredRealisations::All => realisations::file_bytes(&plan.grid, part, count),
        StoredRealisations::Groups => realisations::file_bytes(&plan.grid, part, GROUPS),
        StoredRealisations::Nothing => 0,
    }
}

/// Tables, realisations, summaries and pages.
fn tables(campaign: &Campaign, plan: &Plan, limit: u64) -> u128 {
    let sums = &plan.sums;
    let schlick = schlick_channels(plan);
    let (incidences, bins) = (plan.incidences as u128, plan.bins as u128);
    let values = incidences.saturating_mul(bins);
    let of_material = |material: usize| {
        let colours = sums.colours(material).len();
        let orders = if sums.by_order() { sums.groups() } else { 0 };
        let left_map = usize::from(campaign.surface.kind.is_open_map());
        let channels = (colours * (5 + left_map + orders) + 2 * sums.mueller_sums() + 1 + schlick) as u128;
        let parts = realisations_of(plan, material, limit);
        let shown = values.saturating_mul(BYTES_PER_SHOWN_VALUE * colours as u128);
        let page = shown.saturating_add(BYTES_PER_PAGE).min(LARGEST_PAGE);
        let table = values.saturating_mul(4 * channels);
        table.saturating_add(u128::from(parts)).saturating_add(page + incidences * BYTES_PER_INCIDENCE)
    };
    let materials = (0..campaign.optics.each().len()).map(of_material).fold(0, u128::saturating_add);
    materials.saturating_mul(campaign.alphas().len() as u128)
}
