//! What a run will need, before it begins: memory and time, from measured costs.

use super::decisions::Plan;
use super::start_sampler::{StartSampler, aperture_fraction};
use crate::campaign::{Alpha, Azimuth, Campaign, GrainShape, SurfaceKind};
use crate::measure::prepared_patch::CELLS_PER_START;
use crate::sphere;
use crate::surface::grains::{cell_side, density, mean_count};
use crate::surface::io::import;
use crate::trace::{BLOCK, BatchedStarts};

// Measured on one core of about 4 GHz, patches of 1024 x 1024 cells, correlation 8.
const NS_PER_SYNTHESISED_CELL: f64 = 450.0;
/// A ray in the lanes, and each cell that it crosses.
const NS_PER_RAY: f64 = 45.0;
const NS_PER_CROSSED_CELL: f64 = 0.3;
/// Cells that a ray towards the light crosses in the mean at most, for each of the range of heights: at grazing light
/// those few samples that are lit, a fraction of 2/(alpha tan theta), send rays of range x alpha tan theta cells, the others
/// are blocked close by.
const MOST_CROSSED: f64 = 4.0;
/// A ray over a measured map: each cell that it is followed through one by one, at most so many of them; then each
/// crossing of the map, at most so many before it hits something.
const NS_PER_MAP_CELL: f64 = 5.0;
const MAP_CELLS: f64 = 64.0;
const NS_PER_MAP_CROSSING: f64 = 200.0;
const MAP_CROSSINGS: f64 = 64.0;
/// Reflection, bin and tally of a surface sample.
const NS_PER_START: f64 = 60.0;
/// The search for the samples.
const NS_PER_FACET: f64 = 2.5;
/// Lanes' copy and digest of a patch.
const NS_PER_MOUNTED_CELL: f64 = 30.0;
/// The index of the facets; a surface sample on a wanted facet, its rays included; the choice of a surface sample by slope.
const NS_PER_INDEXED_CELL: f64 = 25.0;
const NS_PER_WANTED_START: f64 = 260.0;
const NS_PER_START_BY_SLOPE: f64 = 40.0;
/// A ray among grains, and a grain in a cell that it crosses; memory of a grain, and what making it takes.
const NS_PER_GRAIN_RAY: f64 = 60.0;
const NS_PER_GRAIN: f64 = 2.5;
const NS_PER_PLACED_GRAIN: f64 = 200.0;
const BYTES_PER_GRAIN: u128 = 300;
/// The model's mean over a bin with three maskings under light of one direction; of a bin and colour the errors, the
/// comparison, and what is written.
const NS_PER_PREDICTED_BIN: f64 = 35_000.0;
const NS_PER_WRITTEN_BIN: f64 = 6000.0;
/// A step of the statistical surface's walk.
const NS_PER_WALK: f64 = 150.0;

// Bytes for each cell.
const SYNTHESIS: u128 = 45;
const HEIGHTS: u128 = 8;
/// f32 heights, and the table of their maxima.
const LANES: u128 = 12;
/// Two facets, and their bins while they are sorted.
const INDEX: u128 = 12;
/// Sums of turned areas, of a thread.
const SUMS: u128 = 2;
/// Facets in order of their slopes and heights, while the page's certificate of the first patch is made.
const CERTIFICATE: u128 = 56;
/// Samples that a thread follows together.
const STARTS: u128 = BatchedStarts::BYTES as u128 / CELLS_PER_START as u128;

/// What a run takes, bytes.
pub(crate) struct Memory {
    /// Patches in flight or kept, what is made of them, tallies.
    pub shared: u128,
    /// Records and tables of each incidence.
    pub incidence: u128,
    /// What is made of each incidence when the table is written: directions and predictions.
    pub written: u128,
}

impl Memory {
    /// All incidences at once.
    pub fn whole(&self, plan: &Plan) -> u128 {
        self.shared.saturating_add(self.incidence.saturating_mul(plan.incidences as u128))
    }

    /// How many incidences of a band fit so many bytes.
    pub fn incidences_in(&self, room: u128) -> usize {
        usize::try_from(room / (self.incidence + self.written).max(1)).unwrap_or(usize::MAX)
    }

    /// A band of incidences at a time.
    pub fn banded(&self, incidences: usize) -> u128 {
        self.shared.saturating_add((self.incidence + self.written).saturating_mul(incidences as u128))
    }
}

/// Patches in flight or kept, what is made of them, tallies and tables; bytes.
pub(crate) fn memory(campaign: &Campaign, plan: &Plan) -> Memory {
    let threads = rayon::current_num_threads() as u128;
    let cells = plan.cells as u128;
    let lanes = if campaign.trace.visibility { LANES } else { 0 };
    let by_slope = plan.start_sampler == StartSampler::BySlope;
    let index = if plan.start_sampler.is_indexed() { INDEX } else { 0 };
    let lit = campaign.optics.light_sides().len() as u128;
    // Of clear facets both sides of a patch are there.
    let sides = if campaign.optics.lets_through() { 2 } else { 1 };
    let mounted = sides * (HEIGHTS + lanes) + lit * index;
    let rounds = campaign.stop.relative_error.is_some() || campaign.stop.seconds.is_some();
    // Patches that are looked at again are all kept.
    let kept = if rounds { u128::from(plan.realisations).max(threads) } else { threads };
    let synthesis = if campaign.surface.kind.is_random_heights() { SYNTHESIS } else { HEIGHTS };
    // The map itself stays beside what is mounted of it.
    let map = if matches!(campaign.surface.kind, SurfaceKind::File(_)) { HEIGHTS } else { 0 };
    let grains = campaign.surface.kind.explicit_grains().is_some();
    let surface = if grains {
        kept.max(threads) * BYTES_PER_GRAIN
    } else {
        let of_thread = synthesis.max(SUMS).max(if by_slope { STARTS } else { 0 });
        map + kept * mounted + (threads - 1) * of_thread + of_thread.max(CERTIFICATE)
    };
    let bins = plan.bins as u128;
    // Hits, and fixed-point sums of 16 bytes, of every realisation, and about as much for the bytes of a checkpoint; those
    // that threads have in hand; f32 tables and realisations' files, with the sums of Schlick's formula in each.
    let sums = 1 + plan.sums.sums_of_a_bin() as u128;
    let (realisations, roughnesses) = (u128::from(plan.realisations), campaign.alphas().len() as u128);
    // Of an open map the sums of what leaves it besides.
    let copies = if campaign.surface.kind.is_open_map() { 2 } else { 1 };
    let hits = 8 * plan.sums.hit_sets() as u128;
    let records = 2 * copies * bins * realisations * roughnesses * (hits + 16 * sums);
    let tallies = 4 * copies * threads * bins * (hits + 16 * sums);
    let kept = if plan.sums.serves_any_f0() { sums * plan.tables as u128 } else { 0 };
    let colours = (plan.colours as u128) * roughnesses;
    let files = bins * 4 * ((2 * colours + kept) * realisations + 8 * colours + kept);
    // Projected solid angles; means of each colour with three maskings; the same as bands are examined one by one.
    let written = bins * 8 * (1 + 3 * colours);
    Memory { shared: cells * surface + tallies, incidence: records + files, written }
}

/// Cells of a patch, and how many cells long the shadow of a map's whole relief is at 45 degrees; 0 of a map that cannot
/// be read, which whoever measures it will say.
pub(crate) fn cells_and_relief(campaign: &Campaign) -> (f64, f64) {
    let cells = match &campaign.surface.kind {
        SurfaceKind::Grains(grains) if grains.shape != GrainShape::Heights => {
            grains.alphas.iter().filter_map(|alpha| Some(mean_count(grains.side, alpha.coverage?))).sum()
        }
        SurfaceKind::Smith(_) | SurfaceKind::Mirror | SurfaceKind::VGroove { .. } => 64.0,
        SurfaceKind::File(map) => {
            let Ok(map) = import::load(map) else { return (0.0, 0.0) };
            let (low, high) = map.field.range();
            let cells = (map.field.cells_x() * map.field.cells_y()) as f64;
            return (cells, (high - low) * map.alpha_x.max(map.alpha_y));
        }
        SurfaceKind::Ggx(_)
        | SurfaceKind::Beckmann { .. }
        | SurfaceKind::StudentT { .. }
        | SurfaceKind::BlinnPhong { .. }
        | SurfaceKind::Psd(_)
        | SurfaceKind::Grains(_) => f64::from(campaign.surface.cells).powi(2),
    };
    (cells, 0.0)
}

/// Lowest and highest height to be expected: measured on patches of 1024 x 1024 cells.
fn heights(campaign: &Campaign) -> (f64, f64) {
    let range = match &campaign.surface.kind {
        SurfaceKind::Ggx(_) | SurfaceKind::StudentT { .. } => 7.0 * campaign.surface.correlation_cells,
        SurfaceKind::Beckmann { .. } | SurfaceKind::BlinnPhong { .. } | SurfaceKind::Psd(_) => {
            2.0 * campaign.surface.correlation_cells
        }
        _ => 1.0,
    };
    (0.0, range)
}

/// A rough time on two cores, in seconds, of all that `gonio measure` does.
pub(crate) fn seconds(campaign: &Campaign, plan: &Plan) -> f64 {
    tracing_seconds(campaign, plan) + 0.5e-9 * (plan.tables as f64) * written(campaign, plan)
}

/// What is made of a table once it is measured, ns: theory's means over its bins, verdict, files and page.
fn written(campaign: &Campaign, plan: &Plan) -> f64 {
    let bins = (plan.incidences * plan.bins * plan.colours) as f64;
    if campaign.surface.kind.alphas().is_none() {
        return bins * NS_PER_WRITTEN_BIN;
    }
    // Mirror images are not worked out again.
    let averaged = campaign.light.azimuth == Azimuth::Relative && !campaign.is_isotropic();
    let turns = if averaged { 36.0 } else { 1.0 };
    let nodes = if campaign.light.aperture_deg > 0.0 { 78.0 } else { 1.0 };
    let predicted = 0.5 * (plan.incidences * plan.bins) as f64 * turns * nodes;
    predicted * NS_PER_PREDICTED_BIN + bins * NS_PER_WRITTEN_BIN
}

/// The same of patches and paths alone.
fn tracing_seconds(campaign: &Campaign, plan: &Plan) -> f64 {
    let cells = plan.cells;
    let random = campaign.surface.kind.is_random_heights();
    let tracing: f64 = campaign.alphas().iter().map(|&alpha| table(campaign, plan, alpha)).sum();
    if campaign.surface.kind.explicit_grains().is_some() {
        return 0.5e-9 * f64::from(plan.realisations) * (tracing + NS_PER_PLACED_GRAIN * cells);
    }
    let mut patch = if random { NS_PER_MOUNTED_CELL } else { 0.0 };
    if random && !matches!(campaign.surface.kind, SurfaceKind::Beckmann { .. } | SurfaceKind::Psd(_)) {
        patch += NS_PER_SYNTHESISED_CELL;
    }
    if plan.start_sampler.is_indexed() {
        patch += NS_PER_INDEXED_CELL;
    }
    0.5e-9 * f64::from(plan.realisations) * (tracing + patch * cells)
}

/// All blocks of all incidences on one patch, ns.
fn table(campaign: &Campaign, plan: &Plan, alpha: Option<Alpha>) -> f64 {
    let coverage = alpha.and_then(|alpha| alpha.coverage);
    let alpha = alpha.map_or(glam::DVec2::splat(0.3), |alpha| glam::DVec2::new(alpha.x, alpha.y));
    let explicit = campaign.surface.kind.explicit_grains().is_some();
    let block = |incidence: usize| match coverage.filter(|_| explicit) {
        Some(coverage) => block_on_grains(campaign, plan, incidence, (alpha, coverage)),
        None => block(campaign, plan, incidence, alpha),
    };
    let ways = plan.sums.paths_of_a_start() as f64;
    // Both parts of split light share the light's ray.
    let ways = if campaign.trace.bounces == 1 && ways > 1.0 { 0.75 * ways } else { ways };
    ways * plan.blocks as f64 * (0..plan.incidences).map(block).sum::<f64>()
}

/// One block of an incidence on grains, ns: two rays of each start at order 1, from cell to cell as far as they rise to the
/// tops of the grains, or meet one.
fn block_on_grains(
    campaign: &Campaign,
    plan: &Plan,
    incidence: usize,
    (alpha, coverage): (glam::DVec2, f64),
) -> f64 {
    let (sin, cos) = sphere::sin_cos_deg(plan.grid.incidence_deg(incidence).0);
    let (density, side) = (density(coverage), cell_side(density(coverage)));
    let near = density * (side + 2.0).powi(2);
    // A level ray meets a grain after 1/density radii or so.
    let crossed = |reach: f64| 1.0 + reach.min(1.0 / density) / side;
    let ray = |reach: f64| NS_PER_GRAIN_RAY + (NS_PER_CROSSED_CELL + NS_PER_GRAIN * near) * crossed(reach);
    let further = 0.4 * f64::from(campaign.trace.bounces - 1).min(3.0);
    let reach = alpha.max_element() * sin / cos;
    BLOCK as f64 * (NS_PER_START + ray(reach) + ray(alpha.max_element()) * (1.0 + further))
}

/// One block of an incidence, ns.
fn block(campaign: &Campaign, plan: &Plan, incidence: usize, alpha: glam::DVec2) -> f64 {
    let (cells, starts) = (plan.cells, BLOCK as f64);
    let further = 0.4 * f64::from(campaign.trace.bounces - 1).min(3.0);
    if matches!(campaign.surface.kind, SurfaceKind::Smith(_)) {
        return starts * NS_PER_WALK * (1.0 + further);
    }
    let (low, high) = heights(campaign);
    let (sin, cos) = sphere::sin_cos_deg(plan.grid.incidence_deg(incidence).0);
    let run_in = (high - low) * alpha.max_element() * sin / cos;
    let visible = if campaign.trace.visibility { 1.0 } else { 0.0 };
    let ray = |crossed: f64| {
        let crossed = crossed.min(MOST_CROSSED * (high - low));
        visible * (NS_PER_RAY + NS_PER_CROSSED_CELL * crossed)
    };
    let over_a_map = |crossed: f64| {
        let crossings = if cells > 0.0 { crossed / cells.sqrt() } else { 0.0 };
        let far = NS_PER_MAP_CROSSING * crossings.min(MAP_CROSSINGS);
        visible * (NS_PER_RAY + NS_PER_MAP_CELL * crossed.min(MAP_CELLS) + far)
    };
    // Towards the light, and from the facet.
    let (to_light, onwards) = if campaign.surface.kind.is_map() {
        (over_a_map(plan.relief * sin / cos), over_a_map(1.5 * plan.relief))
    } else {
        (ray(run_in), ray(1.5 * (high - low) * alpha.max_element()))
    };
    let asked_for =
        if plan.apertures_only { aperture_fraction(&plan.grid.regions(incidence)).min(1.0) } else { 1.0 };
    if matches!(plan.start_sampler, StartSampler::IntoApertures(_)) {
        // Light falls into the apertures more often than their solid angle says.
        return starts * (4.0 * asked_for).min(1.0) * NS_PER_WANTED_START;
    }
    let path = starts * (NS_PER_START + asked_for * onwards * (1.0 + further));
    match plan.start_sampler {
        StartSampler::BySlope => path + starts * (to_light + NS_PER_START_BY_SLOPE),
        _ => path + starts * to_light + 2.0 * cells * NS_PER_FACET,
    }
}
