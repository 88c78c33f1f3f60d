//! How a campaign is measured: what it needs, what fits the memory, and what is refused.

use super::decisions::Plan;
use super::estimate::{Memory, cells_and_relief, memory, seconds};
use super::savings::skips;
use super::start_sampler::StartSampler;
use crate::campaign::{Azimuth, Campaign, SurfaceKind};
use crate::error::{Error, Result};
use crate::files::memory::memory_limit;
use crate::instrument::{Grid, GridKind, folded_incidences, grid_of};
use crate::measure::accumulate::fresnel_sums::FresnelSums;
use crate::measure::persist::part::Part;
use crate::sphere;
use crate::surface::io::checks::ABSURD_SDQ;
use crate::trace::BLOCK;

/// Largest sum of the flux that starts carry, of what falls on the patch in one block.
const LARGEST_FLUX: f64 = (1u64 << 36) as f64;
/// A run that would take longer is refused: 31 days.
const LONGEST_S: f64 = 31.0 * 86_400.0;
/// One part in so many of the memory is left free by bands, and may be taken by patches that all of them share.
pub(crate) const KEPT_FRACTION: u64 = 4;

/// Decides how a campaign is measured. Errors: `Refused` where it would not fit the memory, or take too long.
///
/// ```
/// use gonio::{campaign, measure};
///
/// let text = "name = \"a\"\n[surface.ggx]\nalpha = 0.3\n[light]\ntheta_i_deg = [0, 45]\n[sensor.hemisphere]\n\
///             theta_r_bins = 9\nphi_r_bins = 18\n[stop]\nsamples = 65_536\n";
/// let plan = measure::plan(&campaign::parse(text, "a.toml", ".".as_ref())?.campaign)?;
/// assert_eq!((plan.incidences, plan.samples), (2, 65_536));
/// # Ok::<(), gonio::error::Error>(())
/// ```
pub fn plan(campaign: &Campaign) -> Result<Plan> {
    plan_of(campaign, None, memory_limit())
}

/// The same with so many bytes of memory. A table that exceeds them is measured in bands of incidences.
pub fn plan_within(campaign: &Campaign, limit: u64) -> Result<Plan> {
    plan_of(campaign, None, limit)
}

/// The same for one shard of it, which is not measured in bands. Errors: as [`plan`]; `Usage` where the incidences do not
/// suffice for so many shards, or where the clock would end each of them elsewhere.
pub fn plan_of(campaign: &Campaign, shard: Option<Part>, limit: u64) -> Result<Plan> {
    let (mut plan, memory) = decided(campaign);
    if let Some(shard) = shard {
        may_be_dealt(campaign, &plan.grid, shard)?;
        plan = plan.of_part(shard)?;
        estimate(campaign, &mut plan);
    } else if plan.memory_bytes > limit
        && let Some(incidences) = incidences_within(campaign, &plan, &memory, limit)
    {
        in_bands(&mut plan, &memory, incidences);
    }
    checked(campaign, plan, limit)
}

/// The plan of other directions than the campaign's, such as a list of points with an aperture about each.
///
/// - `grid`: its azimuths count from the light where the campaign averages over the light's azimuth.
/// - `drawn_at`: angles of the incidence whose random numbers all of them use; `None`: each its own.
/// - `size`: `cells` and `relief` of a plan on the same patches, which of a map are known once it is read.
///
/// Errors: as [`plan`].
pub fn plan_at(
    campaign: &Campaign,
    grid: Grid,
    drawn_at: Option<(f64, f64)>,
    size: Option<(f64, f64)>,
    limit: u64,
) -> Result<Plan> {
    let (plan, _) = decided_on(campaign, grid, size.unwrap_or_else(|| cells_and_relief(campaign)));
    checked(campaign, Plan { drawn_at, ..plan }, limit)
}

/// The plan of a run that began with so many incidences at a time, or with all.
///
/// Errors: `Refused` where these do not fit `limit` bytes; as [`plan`].
pub fn resumed(campaign: &Campaign, band_incidences: Option<u64>, limit: u64) -> Result<Plan> {
    let (mut plan, memory) = decided(campaign);
    let incidences =
        band_incidences.map_or(Some(plan.incidences), |incidences| usize::try_from(incidences).ok());
    let Some(incidences) = incidences.filter(|incidences| (1..=plan.incidences).contains(incidences)) else {
        return Err(Error::Refused(format!("{}: bands of other lengths than a run has", campaign.name)));
    };
    if incidences < plan.incidences {
        in_bands(&mut plan, &memory, incidences);
    }
    if plan.memory_bytes > limit {
        let at_a_time = if incidences < plan.incidences {
            format!("bands of {incidences} incidences")
        } else {
            "all incidences at once".into()
        };
        return Err(Error::Refused(format!(
            "{}: is resumed with {at_a_time}, as it began, which needs about {} MiB of memory, {} MiB may be used; \
             --memory-mb allows more, --force starts again in bands that fit",
            campaign.name,
            plan.memory_bytes.div_ceil(1 << 20),
            limit >> 20
        )));
    }
    checked(campaign, plan, limit)
}

/// The plan with all incidences at once, whatever it takes.
pub(crate) fn at_once(campaign: &Campaign) -> Plan {
    decided(campaign).0
}

/// The `plan` of incidences that are there, as they are merged within `limit` bytes: so many at a time next to the
/// `largest` file of a shard, bytes.
pub(crate) fn merged(campaign: &Campaign, mut plan: Plan, largest: u128, limit: u64) -> Result<Plan> {
    let memory = memory(campaign, &plan);
    let takes = |incidences: usize| memory.banded(incidences).saturating_add(largest);
    if takes(1) > u128::from(limit) || plan.incidences == 0 {
        return Err(Error::Refused(format!(
            "{}: one stop and the largest shard need about {} MiB of memory, {} MiB may be used; --memory-mb allows \
             more, shards of fewer incidences need less",
            campaign.name,
            takes(1).div_ceil(1 << 20),
            limit >> 20
        )));
    }
    // But for the first incidence.
    plan.band_incidences =
        memory.incidences_in(left_by_bands(limit).saturating_sub(takes(0))).clamp(1, plan.incidences);
    plan.memory_bytes = saturated(takes(plan.band_incidences));
    Ok(plan)
}

/// How many incidences fit `limit` bytes at a time; `None` where not one does, or where bands make no sense: a budget of
/// time would hold for each of them.
fn incidences_within(campaign: &Campaign, plan: &Plan, memory: &Memory, limit: u64) -> Option<usize> {
    let possible = campaign.stop.seconds.is_none() && plan.grid.of_incidences([]).is_some();
    let incidences = memory.incidences_in(left_by_bands(limit).checked_sub(memory.shared)?);
    (possible && incidences > 0).then_some(incidences.min(plan.incidences))
}

fn left_by_bands(limit: u64) -> u128 {
    u128::from(limit - limit / KEPT_FRACTION)
}

fn in_bands(plan: &mut Plan, memory: &Memory, incidences: usize) {
    plan.band_incidences = incidences;
    plan.memory_bytes = saturated(memory.banded(incidences));
}

/// The plan with all incidences at once, and what it takes.
fn decided(campaign: &Campaign) -> (Plan, Memory) {
    decided_on(campaign, grid_of(campaign), cells_and_relief(campaign))
}

/// The same on another grid than the campaign's.
fn decided_on(campaign: &Campaign, grid: Grid, (cells, relief): (f64, f64)) -> (Plan, Memory) {
    let averages_azimuth = campaign.light.azimuth == Azimuth::Relative;
    let blocks = campaign.stop.samples.div_ceil(BLOCK);
    let samples = blocks * BLOCK;
    let roughnesses = campaign.alphas().len();
    let random = campaign.surface.kind.has_random_patches();
    let images = if random && campaign.surface.mirror_images && !averages_azimuth { 8 } else { 1 };
    let folded = folded_incidences(campaign, &grid);
    let realisations = campaign.surface.realisations;
    // The statistical surface does not know where a path goes before it has left, and facets must leave no choice.
    let explicit = !matches!(campaign.surface.kind, SurfaceKind::Smith(_));
    let known = explicit && campaign.optics.mirrors();
    let cones = matches!(grid.kind, GridKind::Arm | GridKind::Points);
    let apertures_only = cones && campaign.trace.bounces == 1 && known;
    let total =
        [grid.incidences() as u128, u128::from(realisations), u128::from(samples), roughnesses as u128];
    let start_sampler = StartSampler::decided(campaign, &grid, &folded, (samples, apertures_only));
    let mut plan = Plan {
        incidences: grid.incidences(),
        part: Part::whole(grid.incidences()),
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
        drawn_at: None,
        skipped: Vec::new(),
        band_incidences: grid.incidences(),
        memory_bytes: 0,
        estimated_s: 0.0,
        grid,
    };
    let memory = estimate(campaign, &mut plan);
    (plan, memory)
}

/// Notes what is skipped, and what the run will take.
fn estimate(campaign: &Campaign, plan: &mut Plan) -> Memory {
    plan.skipped = skips(campaign, plan);
    let memory = memory(campaign, plan);
    plan.memory_bytes = saturated(memory.whole(plan));
    plan.estimated_s = seconds(campaign, plan).min(campaign.stop.seconds.unwrap_or(f64::INFINITY));
    memory
}

impl Plan {
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
        estimate(campaign, &mut plan);
        plan
    }
}

/// The plan, if it fits the memory and the time.
fn checked(campaign: &Campaign, plan: Plan, limit: u64) -> Result<Plan> {
    if plan.memory_bytes > limit {
        return Err(Error::Refused(format!(
            "{}: needs about {} MiB of memory, {} MiB may be used; take fewer incidences, bins, realisations or cells",
            campaign.name,
            plan.memory_bytes >> 20,
            limit >> 20
        )));
    }
    flux_fits(campaign, &plan)?;
    if plan.estimated_s > LONGEST_S {
        return Err(Error::Refused(format!(
            "{}: would take about {:.0} days on two cores, {:.0} are allowed; take fewer samples, incidences or realisations",
            campaign.name,
            plan.estimated_s / 86_400.0,
            LONGEST_S / 86_400.0
        )));
    }
    Ok(plan)
}

/// Refuses light so near the horizon that the sums of flux would not hold it.
///
/// Samples carry the area that facets turn to the light, slope x tan(theta_i) of what falls on the patch in the mean,
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

/// How many incidences a campaign has.
pub fn incidences(campaign: &Campaign) -> usize {
    grid_of(campaign).incidences()
}

/// Refuses a shard that no campaign of these incidences has.
fn may_be_dealt(campaign: &Campaign, grid: &Grid, shard: Part) -> Result<()> {
    if let Some(seconds) = campaign.stop.seconds {
        let why = "no budget of time with --shard: each shard would end somewhere else";
        return Err(Error::Usage(format!("{}: stop.seconds = {seconds}: {why}", campaign.name)));
    }
    if shard.of as usize > grid.incidences() {
        let most = grid.incidences();
        return Err(Error::Usage(format!(
            "--shard {shard}: {} has {most} incidences, and no more shards",
            campaign.name
        )));
    }
    Ok(())
}

/// A count as it is reported: what exceeds 64 bits is refused or takes for ever in any case.
pub(super) fn saturated(count: u128) -> u64 {
    count.try_into().unwrap_or(u64::MAX)
}
