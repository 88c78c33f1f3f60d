//! What a campaign needs, and what it skips: decided here, once, before anything is allocated.

pub mod bands;
pub(crate) mod disk;
pub(crate) mod estimate;
pub mod savings;
pub(crate) mod start_sampler;

use serde::Serialize;

use super::accumulate::fresnel_sums::FresnelSums;
use super::persist::shard::Shard;
use crate::campaign::{Azimuth, Campaign, SurfaceKind};
use crate::error::{Error, Result};
use crate::files::memory::memory_limit;
use crate::instrument::{Grid, GridKind, folded_stops, grid_of};
use crate::sphere;
use crate::surface::io::checks::ABSURD_SDQ;
use crate::trace::BLOCK;
use bands::Band;
use estimate::{Memory, cells_and_relief, memory, seconds};
use savings::{Saving, skips};
use start_sampler::StartSampler;

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
    /// Whether only light towards the sensor's apertures counts: a facet that sends light elsewhere gets no ray, and
    /// albedos are not known.
    pub apertures_only: bool,
    /// How the surface samples of a block are chosen.
    pub start_sampler: StartSampler,
    /// Mirror images of each patch that serve as further samples (1: none).
    pub images: u64,
    /// For each stop, whether mirrored arrivals count as well.
    pub folded: Vec<bool>,
    /// Colours of all tables of a roughness.
    pub colours: usize,
    /// What is summed of every path; tests have colours traced that follow from others.
    #[serde(skip)]
    pub sums: FresnelSums,
    /// What is left out, and why.
    pub skipped: Vec<Saving>,
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
    let samples = blocks * BLOCK;
    let roughnesses = campaign.alphas().len();
    let random = campaign.surface.kind.is_random_heights();
    let images = if random && campaign.surface.mirror_images && !averages_azimuth { 8 } else { 1 };
    let folded = folded_stops(campaign, &grid);
    let realisations = campaign.surface.realisations;
    // The statistical surface does not know where a path goes before it has left.
    let explicit = !matches!(campaign.surface.kind, SurfaceKind::Smith(_));
    let apertures_only = grid.kind == GridKind::Arm && campaign.trace.bounces == 1 && explicit;
    let total = [measured.len() as u128, u128::from(realisations), u128::from(samples), roughnesses as u128];
    let start_sampler = StartSampler::decided(campaign, &grid, &folded, (samples, apertures_only));
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
        samples,
        total_samples: saturated(total.iter().product()),
        averages_azimuth,
        apertures_only,
        start_sampler,
        images,
        folded,
        colours: campaign.optics.colours(),
        sums: FresnelSums::of(campaign),
        skipped: Vec::new(),
        band_stops: grid.stops(),
        memory_bytes: 0,
        estimated_s: 0.0,
        grid,
    };
    let memory = plan.estimate(campaign);
    Ok((plan, memory))
}

impl Plan {
    /// Notes what is skipped, and what the run will take.
    fn estimate(&mut self, campaign: &Campaign) -> Memory {
        self.skipped = skips(campaign, self);
        let memory = memory(campaign, self);
        self.memory_bytes = saturated(memory.whole(self));
        self.estimated_s = seconds(campaign, self).min(campaign.stop.seconds.unwrap_or(f64::INFINITY));
        memory
    }

    /// The same measurement with surface samples row by row, to compare with; `None` where the plan has no other ones.
    pub fn by_place(&self, campaign: &Campaign) -> Option<Plan> {
        self.start_sampler
            .is_indexed()
            .then(|| self.with(campaign, StartSampler::ByPlace, self.apertures_only))
    }

    /// The same measurement with light in all directions followed, not that into apertures alone, to compare with;
    /// `None` where the plan follows all of it.
    pub fn all_directions(&self, campaign: &Campaign) -> Option<Plan> {
        let sampler = match &self.start_sampler {
            StartSampler::IntoApertures(_) => StartSampler::BySlope,
            others => others.clone(),
        };
        self.apertures_only.then(|| self.with(campaign, sampler, false))
    }

    fn with(&self, campaign: &Campaign, start_sampler: StartSampler, apertures_only: bool) -> Plan {
        let mut plan = Plan { start_sampler, apertures_only, ..self.clone() };
        plan.estimate(campaign);
        plan
    }
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
