//! From the sums of every realisation to the table: values, error bars, albedos.

use super::fresnel_sums::ColourSource;
use super::lost_light;
use super::slopes::{self, SeenBySlope, SlopeClass};
use super::table_source::{TableSource, entries};
use super::tally::Tally;
use super::tally_flux::TallyFlux;
use crate::campaign;
use crate::campaign::{Campaign, Optics};
use crate::measure::plan::Plan;
use crate::measure::rounds::FinishedTable;
use crate::measure::stopping::{IncidenceProgress, Look, StoppedBy};
use crate::stats;
use crate::table::brdf_table::HITS_OF_AN_EMPTY_BIN;
use crate::table::{BrdfTable, ColourChannels, RealisationPart, Realisations};

/// What an incidence shows besides its bins.
#[derive(Debug, Clone)]
pub struct IncidenceResult {
    /// Fraction of the incident flux in each order, one value for each realisation: \[order\]\[realisation\], mean of the
    /// colours. No realisation where only the light towards the apertures is followed.
    pub albedo_by_order: Vec<Vec<f64>>,
    /// The same of light that has gone through the surface; no order where none does.
    pub transmittance_by_order: Vec<Vec<f64>>,
    /// All orders on both sides, the cut paths and the absorbed ones, with F = 1 or as clear facets split it:
    /// \[realisation\]; empty where only the light towards the apertures is followed.
    pub closure: Vec<f64>,
    /// Whether F = 1.
    pub perfect: bool,
    /// Paths that leave, by order.
    pub orders: Vec<u64>,
    /// Those that leave on the other side than the light's, by order.
    pub through: Vec<u64>,
    /// Paths beyond the last order.
    pub cut: u64,
    /// Samples that the light does not see.
    pub hidden: u64,
    /// Paths over the edge of an open map.
    pub left_map: u64,
    /// What they may have added at most to the albedos of order 1 and of all orders, mean of the colours.
    pub lost_light: [f64; 2],
    /// Samples whose facets send light into no aperture, where only that is followed.
    pub outside: u64,
    /// Paths that end on a plane between grains which reflects nothing.
    pub absorbed: u64,
    /// Samples in each realisation.
    pub samples: u64,
    /// What ended it.
    pub stopped_by: StoppedBy,
    /// The relative error where it ended, if one was asked for.
    pub relative_error: Option<f64>,
    /// How many realisations would reach it, where the patches are the limit.
    pub realisations_needed: Option<u64>,
    /// The relative errors on the way.
    pub looks: Vec<Look>,
    /// What the light sees of the facets by their slope; `None` where that is not known.
    pub seen_by_slope: Option<Vec<SlopeClass>>,
}

/// A measured table with everything that the summary needs.
#[derive(Debug, Clone)]
pub struct Measured {
    /// The campaign of this table: one roughness, one material.
    pub campaign: Campaign,
    /// The table.
    pub table: BrdfTable,
    /// Every realisation.
    pub realisations: Realisations,
    /// Every incidence.
    pub incidences: Vec<IncidenceResult>,
}

/// The tables of one roughness, one for each material.
pub(crate) fn assemble(
    campaign: &Campaign,
    plan: &Plan,
    finished: &FinishedTable,
    patch_digest: &str,
) -> Vec<Measured> {
    let flux = finished.flux();
    let campaign = finished.alpha.map_or_else(|| campaign.clone(), |alpha| campaign.with_alpha(alpha));
    let sizes: Vec<Vec<f64>> = (0..plan.incidences)
        .map(|incidence| {
            plan.grid.regions(incidence).iter().map(|region| region.projected_solid_angle()).collect()
        })
        .collect();
    let empty = empty_bin_errors(plan, &flux, &sizes);
    let source = TableSource { plan, flux: &flux, sizes: &sizes };
    let of_material = |(material, optics): (usize, &Optics)| {
        let campaign = campaign.with_optics(optics);
        let colours = plan.sums.colours(material);
        let hits = total_hits(plan, &flux, material);
        let parts: Vec<RealisationPart> =
            flux.iter().map(|incidences| source.realisation(incidences, &colours)).collect();
        let wavelengths = optics.wavelengths_nm();
        let channels = |(place, &colour): (usize, &ColourSource)| {
            let measured = ColourChannels::of_realisations(&parts, place, &hits, &empty);
            let [mueller, stderr_mueller] = source.mueller(colour, &empty);
            let measured = ColourChannels { mueller, stderr_mueller, ..measured };
            ColourChannels {
                orders: source.orders(colour),
                wavelength_nm: wavelengths.get(place).copied(),
                ..if campaign.surface.kind.is_open_map() {
                    lost_light::covered(&source, colour, measured)
                } else {
                    measured
                }
            }
        };
        let table = BrdfTable {
            grid: plan.grid.clone(),
            campaign: campaign::to_toml(&campaign),
            version: env!("CARGO_PKG_VERSION").to_string(),
            seed: campaign.seed,
            patch_digest: patch_digest.to_string(),
            colours: colours.iter().enumerate().map(channels).collect(),
            hits,
            schlick: source.schlick(&flux),
        }
        .with_albedo_errors(&parts);
        let result = |(incidence, end)| incidence_result(&source, incidence, &colours, end);
        let incidences = finished.incidences.iter().enumerate().map(result).collect();
        Measured { campaign, table, realisations: Realisations { parts }, incidences }
    };
    campaign.optics.each().into_iter().enumerate().map(of_material).collect()
}

fn total_hits(plan: &Plan, flux: &[Vec<TallyFlux>], material: usize) -> Vec<u32> {
    let places = plan.sums.hit_places(material);
    let of = |incidence: usize, bin: usize| {
        let hits = flux.iter().map(|incidences| &incidences[incidence].tally.hits);
        hits.flat_map(|hits| places.clone().map(move |place| hits[place * plan.bins + bin])).sum::<u64>()
    };
    entries(plan, |incidence, bin| u32::try_from(of(incidence, bin)).unwrap_or(u32::MAX))
}

/// The BRDF of 1.5 hits: what an empty bin's error bar says.
fn empty_bin_errors(plan: &Plan, flux: &[Vec<TallyFlux>], sizes: &[Vec<f64>]) -> Vec<f32> {
    let share = |incidence: usize| {
        let counted: (u64, f64) = flux
            .iter()
            .flat_map(|incidences| {
                let Tally { outside, left_map, .. } = incidences[incidence].tally;
                let orders = incidences[incidence].tally.leaving().map(|order| (order.count, order.flux));
                let fates = [outside, left_map].map(|fate| (fate.count, fate.flux));
                orders.chain(fates).map(|(count, units)| (count, incidences[incidence].of(units)))
            })
            .fold((0, 0.0), |(count, flux), more| (count + more.0, flux + more.1));
        let fold = if plan.folded[incidence] { 0.5 } else { 1.0 };
        if counted.0 == 0 { 1.0 } else { fold * counted.1 / counted.0 as f64 / flux.len() as f64 }
    };
    let shares: Vec<f64> = (0..plan.incidences).map(share).collect();
    entries(plan, |incidence, bin| (HITS_OF_AN_EMPTY_BIN * shares[incidence] / sizes[incidence][bin]) as f32)
}

fn incidence_result(
    source: &TableSource,
    incidence: usize,
    colours: &[ColourSource],
    end: &IncidenceProgress,
) -> IncidenceResult {
    let plan = source.plan;
    let realisations: Vec<TallyFlux> = source.flux.iter().map(|incidences| incidences[incidence]).collect();
    let tallies: Vec<&Tally> = realisations.iter().map(|flux| flux.tally).collect();
    let orders = tallies[0].orders.len();
    // The light beyond the apertures is not known.
    let whole = if plan.apertures_only { &[] } else { &realisations[..] };
    let mean_of_colours = |of: &dyn Fn(&TallyFlux, ColourSource) -> f64| {
        let mean = |flux: &TallyFlux| {
            stats::mean(&colours.iter().map(|&colour| of(flux, colour)).collect::<Vec<_>>())
        };
        whole.iter().map(mean).collect()
    };
    let through = tallies[0].through.len();
    let paths = plan.sums.hit_sets() as f64;
    let closure = |flux: &TallyFlux| {
        let unit = |order| flux.order(order, ColourSource::Unit) + flux.through(order, ColourSource::Unit);
        ((0..orders).map(unit).sum::<f64>() + flux.truncated() + flux.absorbed()) / paths
    };
    IncidenceResult {
        albedo_by_order: (0..orders).map(|k| mean_of_colours(&|flux, c| flux.order(k, c))).collect(),
        transmittance_by_order: (0..through)
            .map(|k| mean_of_colours(&|flux, c| flux.through(k, c)))
            .collect(),
        closure: whole.iter().map(closure).collect(),
        perfect: colours == [ColourSource::Unit],
        orders: (0..orders).map(|k| tallies.iter().map(|tally| tally.orders[k].count).sum()).collect(),
        through: (0..through).map(|k| tallies.iter().map(|tally| tally.through[k].count).sum()).collect(),
        cut: tallies.iter().map(|tally| tally.cut.count).sum(),
        hidden: tallies.iter().map(|tally| tally.hidden.count).sum(),
        left_map: tallies.iter().map(|tally| tally.left_map.count).sum(),
        lost_light: lost_light::of_albedos(&realisations, colours),
        outside: tallies.iter().map(|tally| tally.outside.count).sum(),
        absorbed: tallies.iter().map(|tally| tally.absorbed.count).sum(),
        samples: end.blocks * plan.block_starts,
        stopped_by: end.by.unwrap_or(StoppedBy::Samples),
        relative_error: end.relative_error,
        realisations_needed: end.realisations_needed,
        looks: end.looks.clone(),
        seen_by_slope: seen_by_slope(&tallies),
    }
}

/// How often facets are seen, by slope; `None` where paths leave an open map, of which nobody knows what the light would
/// have met.
fn seen_by_slope(tallies: &[&Tally]) -> Option<Vec<SlopeClass>> {
    let left_map = tallies.iter().any(|tally| tally.left_map.count > 0);
    let seen: Vec<&SeenBySlope> = tallies.iter().map(|tally| &tally.seen).collect();
    if left_map { None } else { slopes::classes(&seen) }
}
