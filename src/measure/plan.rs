//! What a campaign needs, and what it skips: decided here, once, before anything is allocated.

use glam::DVec2;
use serde::Serialize;

use super::bands::{self, Band};
use super::estimate::{Memory, cells_and_relief, memory, seconds};
use super::shards::Shard;
use super::skips::{Skip, skips};
use super::weighing::Weighing;
use crate::campaign::{Azimuth, Campaign, SurfaceKind};
use crate::error::{Error, Result};
use crate::files::memory::memory_limit;
use crate::instrument::{Grid, GridKind, Region, grid_of};
use crate::sphere;
use crate::surface::import::ABSURD_SDQ;
use crate::trace::BLOCK;

/// A sweep visits every cell: with more of them for each start, rays are faster.
const MOST_CELLS_PER_START: f64 = 20.0;
/// Starts of a stop on a patch for each of its cells from which on sorting the facets by slope pays.
const FEWEST_STARTS_PER_CELL: f64 = 1.0 / 64.0;
/// Apertures that cover more than this share of the hemisphere are not worth an index.
const LARGEST_SHARE: f64 = 0.25;
/// Largest sum of the flux that starts carry, of what falls on the patch in one block.
const LARGEST_FLUX: f64 = (1u64 << 36) as f64;
/// A run that would take longer is refused: 31 days.
const LONGEST_S: f64 = 31.0 * 86_400.0;

/// The decisions.
#[derive(Debug, Clone, Serialize)]
pub struct Plan {
    /// Stops and bins.
    #[serde(skip)]
    pub grid: Grid,
    /// Light stops.
    pub stops: usize,
    /// Which of them are measured: all, or those of a shard, increasing.
    #[serde(skip)]
    pub measured: Vec<usize>,
    /// The shard that they are, if they are not all.
    #[serde(skip)]
    pub shard: Option<Shard>,
    /// The band that they are, of a run in bands.
    #[serde(skip)]
    pub band: Option<Band>,
    /// Cells of a patch, as far as they are known before it is made.
    #[serde(skip)]
    pub cells: f64,
    /// Length in cells of the shadow of a measured map's whole relief at 45 degrees.
    #[serde(skip)]
    pub relief: f64,
    /// Sensor bins at each stop.
    pub bins: usize,
    /// Tables (one for each roughness and material).
    pub tables: usize,
    /// Groups that error bars come from: patches, or start regions of a measured map.
    pub realisations: u32,
    /// Blocks per stop and realisation.
    pub blocks: u64,
    /// Starts in a block: `BLOCK`; only `bench` lowers it.
    #[serde(skip)]
    pub block_starts: u64,
    /// Starts per stop and realisation: whole blocks.
    pub samples: u64,
    /// Starts of the whole run.
    pub total_samples: u64,
    /// Whether every block has an azimuth of its own.
    pub averages_azimuth: bool,
    /// Whether line sweeps may replace the search for starts and the light's rays (`is_swept`); tests and benches
    /// switch it off.
    pub sweeps: bool,
    /// Up to how many cells for each start of a block they do; benches raise it.
    #[serde(skip)]
    pub most_cells_per_start: f64,
    /// Whether only light towards the sensor's apertures counts: a facet that sends light elsewhere gets no ray, and
    /// albedos are not known. Tests switch it off.
    pub apertures_only: bool,
    /// Whether the facets that send light towards the apertures are found by an index of all facets by slope; tests
    /// and benches switch it off.
    pub indexed: bool,
    /// Whether starts follow the facets in the order of their slopes; tests and benches switch it off.
    pub by_slope: bool,
    /// Whether starts are found by rays from above instead, for comparison: only `bench --against forward` says so.
    #[serde(skip)]
    pub from_above: bool,
    /// Mirror images of each patch that serve as further samples (1: none).
    pub images: u64,
    /// For each stop, whether mirrored arrivals count as well.
    pub folded: Vec<bool>,
    /// Colours of all tables of a roughness.
    pub colours: usize,
    /// What is summed of every path; tests have colours traced that follow from others.
    #[serde(skip)]
    pub weighing: Weighing,
    /// What is left out, and why.
    pub skipped: Vec<Skip>,
    /// Stops that are measured and written at a time: all, or as many as fit the memory.
    pub band_stops: usize,
    /// Estimated peak memory.
    pub memory_bytes: u64,
    /// Estimated time on two cores.
    pub estimated_s: f64,
}

/// Decides how a campaign is measured. Errors: `Refused` where it would not fit the memory, or take too long.
pub fn plan(campaign: &Campaign) -> Result<Plan> {
    plan_of(campaign, None, memory_limit())
}

/// The same with so many bytes of memory. A table that exceeds them is measured in bands of stops.
pub fn plan_within(campaign: &Campaign, limit: u64) -> Result<Plan> {
    plan_of(campaign, None, limit)
}

/// The same for one shard of it, which is not measured in bands. Errors: as [`plan`]; `Usage` where the stops do not
/// suffice for so many shards, or where the clock would end each of them elsewhere.
pub fn plan_of(campaign: &Campaign, shard: Option<Shard>, limit: u64) -> Result<Plan> {
    let (mut plan, memory) = decided(campaign, shard)?;
    if plan.memory_bytes > limit
        && shard.is_none()
        && let Some(stops) = bands::stops_within(campaign, &plan, &memory, limit)
    {
        plan.band_stops = stops;
        plan.memory_bytes = saturated(memory.banded(stops));
    }
    checked(campaign, plan, limit)
}

/// The plan with all stops at once, whatever it takes, and what it takes.
pub(super) fn decided(campaign: &Campaign, shard: Option<Shard>) -> Result<(Plan, Memory)> {
    let grid = grid_of(campaign);
    let measured = match shard {
        Some(shard) => dealt(campaign, &grid, shard)?,
        None => (0..grid.stops()).collect(),
    };
    let (cells, relief) = cells_and_relief(campaign);
    let averages_azimuth = campaign.light.azimuth == Azimuth::Relative;
    let blocks = campaign.stop.samples.div_ceil(BLOCK);
    let roughnesses = campaign.alphas().len();
    let random = campaign.surface.kind.is_random_heights();
    let images = if random && campaign.surface.mirror_images && !averages_azimuth { 8 } else { 1 };
    let folded = folded_stops(campaign, &grid);
    let realisations = campaign.surface.realisations;
    // The statistical surface does not know where a path goes before it has left.
    let explicit = !matches!(campaign.surface.kind, SurfaceKind::Smith(_));
    let apertures_only = grid.kind == GridKind::Arm && campaign.trace.bounces == 1 && explicit;
    let total =
        [measured.len() as u128, u128::from(realisations), u128::from(blocks * BLOCK), roughnesses as u128];
    let indexed = apertures_only && random && few_apertures(&grid, &folded);
    let mut plan = Plan {
        stops: grid.stops(),
        measured,
        shard,
        band: None,
        cells,
        relief,
        bins: grid.bins(),
        tables: roughnesses * campaign.optics.each().len(),
        realisations,
        blocks,
        block_starts: BLOCK,
        samples: blocks * BLOCK,
        total_samples: saturated(total.iter().product()),
        averages_azimuth,
        sweeps: random && campaign.trace.visibility,
        most_cells_per_start: MOST_CELLS_PER_START,
        apertures_only,
        indexed,
        by_slope: random && !indexed && pays_by_slope(campaign, blocks * BLOCK),
        from_above: false,
        images,
        folded,
        colours: campaign.optics.colours(),
        weighing: Weighing::of(campaign),
        skipped: Vec::new(),
        band_stops: grid.stops(),
        memory_bytes: 0,
        estimated_s: 0.0,
        grid,
    };
    plan.skipped = skips(campaign, &plan);
    let memory = memory(campaign, &plan);
    plan.memory_bytes = saturated(memory.whole(&plan));
    plan.estimated_s = seconds(campaign, &plan).min(campaign.stop.seconds.unwrap_or(f64::INFINITY));
    Ok((plan, memory))
}

/// The plan, if it fits the memory and the time.
pub(super) fn checked(campaign: &Campaign, plan: Plan, limit: u64) -> Result<Plan> {
    if plan.memory_bytes > limit {
        return Err(Error::Refused(format!(
            "{}: needs about {} MiB of memory, {} MiB may be used; take fewer stops, bins, realisations or cells",
            campaign.name,
            plan.memory_bytes >> 20,
            limit >> 20
        )));
    }
    flux_fits(campaign, &plan)?;
    if plan.estimated_s > LONGEST_S {
        return Err(Error::Refused(format!(
            "{}: would take about {:.0} days on two cores, {:.0} are allowed; take fewer samples, stops or realisations",
            campaign.name,
            plan.estimated_s / 86_400.0,
            LONGEST_S / 86_400.0
        )));
    }
    Ok(plan)
}

/// Refuses light so near the horizon that the sums of flux would not hold it.
///
/// Starts carry the area that facets turn to the light, slope x tan(theta_i) of what falls on the patch in the mean,
/// lit or not; a sum holds 2^38 times that (`tally`). Slopes in the mean stay below alpha, of a map below the largest
/// that is let in: a factor of 4 is left.
fn flux_fits(campaign: &Campaign, plan: &Plan) -> Result<()> {
    let slope = match &campaign.surface.kind {
        SurfaceKind::File(_) => ABSURD_SDQ,
        SurfaceKind::VGroove { slope } => *slope,
        kind => kind.alphas().into_iter().flatten().fold(1.0, |most, alpha| alpha.x.max(alpha.y).max(most)),
    };
    let most = LARGEST_FLUX / (slope.max(1.0) * plan.blocks as f64);
    let theta = campaign.light.theta_i_deg.iter().copied().fold(0.0, f64::max);
    let (sin, cos) = sphere::sin_cos_deg(theta);
    if sin <= most * cos {
        return Ok(());
    }
    Err(Error::Refused(format!(
        "{}: light.theta_i_deg = {theta}: so near the horizon {} samples carry more flux than the sums hold; stay {:.0e} \
         degrees from 90, or take fewer samples",
        campaign.name,
        plan.samples,
        (1.0 / most).atan().to_degrees()
    )))
}

/// How many light stops a campaign has.
pub fn stops(campaign: &Campaign) -> usize {
    grid_of(campaign).stops()
}

/// The stops of a shard.
fn dealt(campaign: &Campaign, grid: &Grid, shard: Shard) -> Result<Vec<usize>> {
    if let Some(seconds) = campaign.stop.seconds {
        let why = "no budget of time with --shard: each shard would end somewhere else";
        return Err(Error::Usage(format!("{}: stop.seconds = {seconds}: {why}", campaign.name)));
    }
    let stops = shard.stops(grid);
    if stops.is_empty() || shard.of as usize > grid.stops() {
        let most = grid.stops();
        return Err(Error::Usage(format!(
            "--shard {shard}: {} has {most} stops, and no more shards",
            campaign.name
        )));
    }
    Ok(stops)
}

/// A count as it is reported: what exceeds 64 bits is refused or takes for ever in any case.
pub(super) fn saturated(count: u128) -> u64 {
    count.try_into().unwrap_or(u64::MAX)
}

/// For each stop, whether the surface's law is its own mirror image about the plane of incidence and arrivals are
/// therefore counted on both sides.
pub fn folded_stops(campaign: &Campaign, grid: &Grid) -> Vec<bool> {
    let symmetric = campaign.surface.kind.alphas().is_some();
    let along_an_axis = |stop: usize| {
        let phi = sphere::reduced_deg(grid.stop_deg(stop).1 - campaign.surface.rotation_deg);
        campaign.light.azimuth != Azimuth::Relative && phi % 90.0 == 0.0
    };
    let folds = |stop: usize| campaign.is_isotropic() || along_an_axis(stop);
    (0..grid.stops()).map(|stop| campaign.trace.fold && symmetric && folds(stop)).collect()
}

/// Whether an index of the facets is worth its making: whether at every stop the apertures, mirrored ones included,
/// cover little enough of the hemisphere.
///
/// Estimated break-even: see `LARGEST_SHARE`. Held by: `the_facet_index_changes_nothing_but_noise`.
fn few_apertures(grid: &Grid, folded: &[bool]) -> bool {
    folded.iter().enumerate().all(|(stop, &folded)| {
        let share = aperture_share(&grid.regions(stop));
        share * if folded { 2.0 } else { 1.0 } <= LARGEST_SHARE
    })
}

/// Whether sorting the facets of a patch by slope pays, for so many starts of a stop on it. A property of the stop alone:
/// further stops and roughnesses, which share the sort, leave its bytes as they are.
///
/// The sort takes 25 ns a cell. A start takes 1.1 times as long by slope as along a sweep, and an equal error a quarter
/// (alpha 0.05) to a half (alpha 0.8) of the starts, six stops from 0 to 75 degrees: some 350 ns are saved for each of
/// them (`gonio bench configs/ggx_isotropic.toml --against sweeps`). That pays for a sort from 0.07 starts a cell on, which
/// a campaign of five stops has where each has a 64th.
/// Held by: `starts_by_slope_change_nothing_but_noise` in `tests/it/measure/skips.rs`.
fn pays_by_slope(campaign: &Campaign, starts: u64) -> bool {
    starts as f64 >= FEWEST_STARTS_PER_CELL * f64::from(campaign.surface.cells).powi(2)
}

/// The share of the hemisphere's solid angle that apertures cover, overlaps counted as often as they are covered.
pub(super) fn aperture_share(regions: &[Region]) -> f64 {
    let of = |region: &Region| match region {
        Region::Cap { half_angle, .. } => 2.0 * (0.5 * half_angle).sin().powi(2),
        Region::Rectangle { .. } => 1.0,
    };
    regions.iter().map(of).sum()
}

/// Whether a stop's starts, and what the light sees of them, come from a line sweep over a patch of this height range
/// instead of from rays. A property of the stop alone: further stops leave it as it is.
///
/// Measured break-even on one core, blocks of 65,536 on 2^20 cells: a sweep takes 6 ms a stop where six share it and
/// 12 ms alone at 60 degrees; starts and rays 12 to 13 ms. Its time grows with the cells for each start, and with the
/// run-in of range x alpha tan(theta) cells before each line.
/// Held by: `tests/it/trace/sweep.rs`, and `a_swept_stop_agrees_with_rays` in `tests/it/measure/skips.rs`.
pub fn is_swept(
    campaign: &Campaign,
    plan: &Plan,
    stop: usize,
    (low, high): (f64, f64),
    alpha: DVec2,
) -> bool {
    let side = f64::from(campaign.surface.cells);
    let (sin, cos) = sphere::sin_cos_deg(plan.grid.stop_deg(stop).0);
    let run_in = (high - low) * alpha.max_element() * sin / cos;
    // An aperture gives every stop an azimuth of its own.
    let shared = campaign.light.aperture_deg == 0.0;
    plan.sweeps
        && shared
        && side * side <= plan.most_cells_per_start * plan.block_starts as f64
        && run_in <= side
}
