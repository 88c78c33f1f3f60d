//! From the sums of every realisation to the table: values, error bars, albedos.

use super::optics::colours_of;
use super::plan::Plan;
use super::rounds::Finished;
use super::slopes::{self, SeenBySlope, SlopeClass};
use super::stopping::{Look, Progress, StoppedBy};
use super::tally::{Tally, from_units};
use crate::campaign::{self, Campaign};
use crate::stats;
use crate::table::{BrdfTable, ColourChannels, RealisationPart, Realisations};

/// Hits that a bin without any is given as its upper bound.
const HITS_OF_AN_EMPTY_BIN: f64 = 1.5;

/// One stop and realisation, flux as a share of the incident flux.
#[derive(Debug, Clone)]
pub struct StopRecord {
    single: Vec<f64>,
    schlick: Vec<f64>,
    multiple: Vec<Vec<f64>>,
    hits: Vec<u64>,
    orders: Vec<OrderRecord>,
    cut: (u64, f64),
    hidden: u64,
    left_map: u64,
    outside: (u64, f64),
    seen: SeenBySlope,
}

#[derive(Debug, Clone, Copy)]
struct OrderRecord {
    count: u64,
    colours: [f64; 3],
    unit: f64,
}

/// What a stop shows besides its bins.
#[derive(Debug, Clone)]
pub struct StopResult {
    /// Share of the incident flux in each order, one value for each realisation: [order][realisation], mean of the
    /// colours. No realisation where only the light towards the apertures is followed.
    pub albedo_by_order: Vec<Vec<f64>>,
    /// All orders and the cut paths with F = 1: [realisation]; empty where only the light towards the apertures is
    /// followed.
    pub closure: Vec<f64>,
    /// Paths that leave, by order.
    pub orders: Vec<u64>,
    /// Paths beyond the last order.
    pub cut: u64,
    /// Starts that the light does not see.
    pub hidden: u64,
    /// Paths over the edge of an open map.
    pub left_map: u64,
    /// Starts whose facets send light into no aperture, where only that is followed.
    pub outside: u64,
    /// Starts in each realisation.
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
    /// The campaign of this table: one roughness.
    pub campaign: Campaign,
    /// The table.
    pub table: BrdfTable,
    /// Every realisation.
    pub realisations: Realisations,
    /// Every stop.
    pub stops: Vec<StopResult>,
}

impl StopRecord {
    /// The record of a finished tally.
    pub fn new(tally: &Tally) -> Self {
        let flux = |sums: &[u128]| sums.iter().map(|&units| from_units(units)).collect::<Vec<_>>();
        StopRecord {
            single: flux(&tally.single),
            schlick: flux(&tally.schlick),
            multiple: tally.multiple.iter().map(|sums| flux(sums)).collect(),
            hits: tally.hits.clone(),
            orders: tally
                .orders
                .iter()
                .map(|o| OrderRecord {
                    count: o.count,
                    colours: o.colours.map(from_units),
                    unit: from_units(o.flux),
                })
                .collect(),
            cut: (tally.cut.count, from_units(tally.cut.flux)),
            hidden: tally.hidden.count,
            left_map: tally.left_map.count,
            outside: (tally.outside.count, from_units(tally.outside.flux)),
            seen: SeenBySlope::of(tally),
        }
    }

    /// This and further blocks of the same stop and realisation.
    pub fn plus(mut self, other: &Self) -> Self {
        let add = |mine: &mut [f64], theirs: &[f64]| mine.iter_mut().zip(theirs).for_each(|(a, b)| *a += b);
        add(&mut self.single, &other.single);
        add(&mut self.schlick, &other.schlick);
        self.multiple.iter_mut().zip(&other.multiple).for_each(|(mine, theirs)| add(mine, theirs));
        self.hits.iter_mut().zip(&other.hits).for_each(|(mine, theirs)| *mine += theirs);
        for (mine, theirs) in self.orders.iter_mut().zip(&other.orders) {
            mine.count += theirs.count;
            mine.unit += theirs.unit;
            add(&mut mine.colours, &theirs.colours);
        }
        self.cut = (self.cut.0 + other.cut.0, self.cut.1 + other.cut.1);
        self.hidden += other.hidden;
        self.left_map += other.left_map;
        self.outside = (self.outside.0 + other.outside.0, self.outside.1 + other.outside.1);
        self.seen.merge(&other.seen);
        self
    }

    /// All flux times `factor`; counts stay.
    pub fn scaled(mut self, factor: f64) -> Self {
        if factor == 1.0 {
            return self;
        }
        let flux = self.single.iter_mut().chain(&mut self.schlick).chain(self.multiple.iter_mut().flatten());
        flux.for_each(|flux| *flux *= factor);
        for order in &mut self.orders {
            order.unit *= factor;
            order.colours.iter_mut().for_each(|flux| *flux *= factor);
        }
        self.cut.1 *= factor;
        self.outside.1 *= factor;
        self
    }

    /// Flux of order 1 in one colour: F0 times the whole plus (1 - F0) times the (1-c)^5 part.
    pub fn single_flux(&self, f0: Option<f64>, bin: usize) -> f64 {
        match f0 {
            None => self.single[bin],
            Some(f0) => f0 * self.single[bin] + (1.0 - f0) * self.schlick[bin],
        }
    }

    /// Flux of the orders above 1 in one colour.
    pub fn multiple_flux(&self, colour: usize, bin: usize) -> f64 {
        self.multiple.get(colour).map_or(0.0, |sums| sums[bin])
    }
}

/// The table of one roughness.
pub(super) fn assemble(
    campaign: &Campaign,
    plan: &Plan,
    Finished { alpha, records, stops: ends }: Finished,
    patch_digest: &str,
) -> Measured {
    let campaign = alpha.map_or_else(|| campaign.clone(), |alpha| campaign.with_alpha(alpha));
    let sizes: Vec<Vec<f64>> = (0..plan.stops)
        .map(|stop| plan.grid.regions(stop).iter().map(|region| region.projected_solid_angle()).collect())
        .collect();
    let colour_f0 = colours_of(&campaign.optics);
    let parts: Vec<RealisationPart> =
        records.iter().map(|stops| realisation_part(stops, &sizes, &colour_f0)).collect();
    let hits = total_hits(plan, &records);
    let empty = empty_bin_errors(plan, &records, &sizes);
    let colours = (0..colour_f0.len()).map(|colour| channels(&parts, colour, &hits, &empty)).collect();
    let schlick = (colour_f0[0].is_some() && campaign.trace.bounces == 1)
        .then(|| schlick_channel(plan, &records, &sizes));
    let table = BrdfTable {
        grid: plan.grid.clone(),
        campaign: campaign::to_toml(&campaign),
        version: env!("CARGO_PKG_VERSION").to_string(),
        seed: campaign.seed,
        patch_digest: patch_digest.to_string(),
        colours,
        hits,
        schlick,
    };
    let result = |(stop, end)| stop_result(&records, stop, colour_f0.len(), end, plan);
    let stops = ends.iter().enumerate().map(result).collect();
    Measured { campaign, table, realisations: Realisations { parts }, stops }
}

/// BRDF values of one realisation: flux over projected solid angle.
fn realisation_part(stops: &[StopRecord], sizes: &[Vec<f64>], f0: &[Option<f64>]) -> RealisationPart {
    let mut part = RealisationPart { total: vec![Vec::new(); f0.len()], single: vec![Vec::new(); f0.len()] };
    for (record, sizes) in stops.iter().zip(sizes) {
        for (bin, size) in sizes.iter().enumerate() {
            for (colour, &f0) in f0.iter().enumerate() {
                let single = record.single_flux(f0, bin) / size;
                part.single[colour].push(single as f32);
                part.total[colour].push((single + record.multiple_flux(colour, bin) / size) as f32);
            }
        }
    }
    part
}

/// Mean and standard error over the realisations, of the very f32 values that the realisations' file holds.
fn channels(parts: &[RealisationPart], colour: usize, hits: &[u32], empty: &[f32]) -> ColourChannels {
    let mut channels = ColourChannels::default();
    for (entry, &hits) in hits.iter().enumerate() {
        let of = |pick: fn(&RealisationPart) -> &Vec<Vec<f32>>| {
            let values = parts.iter().map(move |part| f64::from(pick(part)[colour][entry]));
            let (mean, se) = stats::mean_and_se(values);
            // No light of the asked-for orders in any realisation, though others may have hit: as in an empty bin.
            let se = if hits == 0 || mean == 0.0 { empty[entry] } else { se.map_or(-1.0, |se| se as f32) };
            (mean, if parts.len() > 1 { se } else { -1.0 })
        };
        let (total, stderr) = of(|part| &part.total);
        let (single, stderr_single) = of(|part| &part.single);
        channels.total.push(total as f32);
        channels.single.push(single as f32);
        channels.multiple.push((total - single) as f32);
        channels.stderr.push(stderr);
        channels.stderr_single.push(stderr_single);
    }
    channels
}

fn total_hits(plan: &Plan, records: &[Vec<StopRecord>]) -> Vec<u32> {
    let of = |stop: usize, bin: usize| records.iter().map(|stops| stops[stop].hits[bin]).sum::<u64>();
    entries(plan, |stop, bin| u32::try_from(of(stop, bin)).unwrap_or(u32::MAX))
}

/// The BRDF of 1.5 hits: what an empty bin's error bar says.
fn empty_bin_errors(plan: &Plan, records: &[Vec<StopRecord>], sizes: &[Vec<f64>]) -> Vec<f32> {
    let share = |stop: usize| {
        let counted: (u64, f64) = records
            .iter()
            .flat_map(|stops| {
                let StopRecord { orders, outside, .. } = &stops[stop];
                orders.iter().map(|order| (order.count, order.unit)).chain([*outside])
            })
            .fold((0, 0.0), |(count, flux), more| (count + more.0, flux + more.1));
        let fold = if plan.folded[stop] { 0.5 } else { 1.0 };
        if counted.0 == 0 { 1.0 } else { fold * counted.1 / counted.0 as f64 / records.len() as f64 }
    };
    let shares: Vec<f64> = (0..plan.stops).map(share).collect();
    entries(plan, |stop, bin| (HITS_OF_AN_EMPTY_BIN * shares[stop] / sizes[stop][bin]) as f32)
}

fn schlick_channel(plan: &Plan, records: &[Vec<StopRecord>], sizes: &[Vec<f64>]) -> Vec<f32> {
    let count = records.len() as f64;
    entries(plan, |stop, bin| {
        let flux: f64 = records.iter().map(|stops| stops[stop].schlick[bin]).sum();
        (flux / count / sizes[stop][bin]) as f32
    })
}

fn entries<T>(plan: &Plan, of: impl Fn(usize, usize) -> T) -> Vec<T> {
    (0..plan.stops)
        .flat_map(|stop| (0..plan.bins).map(move |bin| (stop, bin)))
        .map(|(s, b)| of(s, b))
        .collect()
}

fn stop_result(
    records: &[Vec<StopRecord>],
    stop: usize,
    colours: usize,
    end: &Progress,
    plan: &Plan,
) -> StopResult {
    let records: Vec<&StopRecord> = records.iter().map(|stops| &stops[stop]).collect();
    let orders = records[0].orders.len();
    // The light beyond the apertures is not known.
    let whole = if plan.apertures_only { &[] } else { &records[..] };
    let of_order = |k: usize| {
        let albedo = |record: &&StopRecord| stats::mean(&record.orders[k].colours[..colours]);
        whole.iter().map(albedo).collect()
    };
    let closure = |record: &&StopRecord| record.orders.iter().map(|o| o.unit).sum::<f64>() + record.cut.1;
    StopResult {
        albedo_by_order: (0..orders).map(of_order).collect(),
        closure: whole.iter().map(closure).collect(),
        orders: (0..orders).map(|k| records.iter().map(|record| record.orders[k].count).sum()).collect(),
        cut: records.iter().map(|record| record.cut.0).sum(),
        hidden: records.iter().map(|record| record.hidden).sum(),
        left_map: records.iter().map(|record| record.left_map).sum(),
        outside: records.iter().map(|record| record.outside.0).sum(),
        samples: end.blocks * plan.block_starts,
        stopped_by: end.by.unwrap_or(StoppedBy::Samples),
        relative_error: end.relative_error,
        realisations_needed: end.realisations_needed,
        looks: end.looks.clone(),
        seen_by_slope: slopes::classes(&records.iter().map(|record| &record.seen).collect::<Vec<_>>()),
    }
}
