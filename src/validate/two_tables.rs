//! Two tables bin by bin: what differs, and what of it noise explains.
//!
//! Enters: tables A and B on one grid, with their realisations where they are known. Leaves the summary's measures
//! with A as f and B as m: l1 = sum |a-b| w / sum b w, l1_noise = sqrt(2/pi) sum se w/c4 / sum b w with
//! se^2 = se_a^2 + se_b^2. Tables of the very same patches are paired: se is that of the differences by realisation.
//! l1_difference, the distance without noise, has realisations turn each other's sign (`model_distance`); where neither
//! table has any, l1 and l1_noise alone say between which bounds it lies.

use std::path::Path;

use serde::Serialize;

use super::differences::{self as by_part, ValueIndex};
use super::model_distance::{self, Estimate};
use super::verdict::counted_bins;
use crate::campaign::Campaign;
use crate::error::Error;
use crate::instrument::{Grid, Region, folded_stops};
use crate::stats;
use crate::table::{BrdfTable, Realisations, TableRows};

/// Level of the t limit, shared by all bins.
const LEVEL: f64 = 0.01;
/// Realisations of a table that does not say how many it has: Student's t is the normal law by then.
const MANY: usize = 1000;

/// One of the two tables.
#[derive(Debug, Clone, Copy)]
pub struct ComparedTable<'a> {
    /// The values.
    pub table: &'a BrdfTable,
    /// How it was measured; `None` for an imported table.
    pub campaign: Option<&'a Campaign>,
    /// Its realisations, where they lie beside it.
    pub parts: Option<&'a Realisations>,
}

/// How A differs from B.
#[derive(Debug, Clone, Serialize)]
pub struct TableDifference {
    /// `total`: all orders.
    pub scope: &'static str,
    /// Bins, of all stops and colours, that t was computed for; of two that mirror each other, one.
    pub bins: usize,
    /// Whether the errors are those of differences by realisation: both were measured on the same patches.
    pub paired: bool,
    /// The measures over all stops and colours.
    #[serde(flatten)]
    pub figures: DifferenceFigures,
    /// The |t| that the largest of `bins` exceeds with probability 1 % where only noise differs.
    pub t_limit: Option<f64>,
    /// Each stop.
    pub stops: Vec<StopDifference>,
}

impl DifferenceFigures {
    /// The same with the distance without noise: by what each realisation adds to it, or between its bounds.
    fn with_difference(self, by_part: &[f64]) -> Self {
        let Some((l1, noise)) = self.l1.zip(self.l1_noise) else { return self };
        let found = Estimate::of(by_part, noise);
        let [low, high] = found.and_then(|found| found.interval).unwrap_or([(l1 - noise).max(0.0), l1]);
        DifferenceFigures {
            l1_difference: found.map(|found| found.mean),
            l1_difference_floor: found.map(|found| found.floor),
            l1_difference_se: found.and_then(|found| found.se),
            l1_difference_low: Some(low),
            l1_difference_high: Some(high),
            ..self
        }
    }

    /// What a column shows: the distance without noise, or the floor that it is below; its bounds without realisations.
    pub fn shown(&self) -> String {
        match (self.l1_difference, self.l1_difference_floor, self.l1_difference_low, self.l1_difference_high)
        {
            (Some(found), Some(floor), ..) if found <= floor => format!("< {floor:.5}"),
            (Some(found), ..) => format!("{found:.5}"),
            (None, _, Some(low), Some(high)) => format!("{low:.5} to {high:.5}"),
            _ => "n/a".into(),
        }
    }
}

impl TableDifference {
    /// What the tables differ by beyond their noise; `None` where noise explains it, or nothing differs.
    ///
    /// Where no bin has an error bar, any difference is one.
    pub fn disagreement(&self) -> Option<String> {
        let l1 = self.figures.l1.unwrap_or(0.0);
        match self.t_limit.zip(self.figures.max_t) {
            Some((limit, most)) if most > limit => Some(format!(
                "the tables differ: largest t {most:.2}, the 1 % limit of {} bins is {limit:.2}",
                self.bins
            )),
            None if l1 > 0.0 => {
                Some(format!("the tables differ by an L1 of {l1:.6}, and no errors are known"))
            }
            _ => None,
        }
    }
}

/// The measures of a difference; null what is not available.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct DifferenceFigures {
    /// Flux-weighted L1 distance relative to B.
    pub l1: Option<f64>,
    /// What noise alone would show.
    pub l1_noise: Option<f64>,
    /// The distance without noise, by the realisations: 0 on average where the tables agree, and so often below 0; null
    /// where neither table has 4 realisations.
    pub l1_difference: Option<f64>,
    /// Below this, `l1_difference` cannot be told from 0: where the tables agree, 95 % of the values are below.
    pub l1_difference_floor: Option<f64>,
    /// Its standard error.
    pub l1_difference_se: Option<f64>,
    /// Lower end of its 95 % interval, its largest bias included. Without realisations l1 - l1_noise: |d| is never larger
    /// than the mean of |d + e|, and never smaller than that less the mean of |e|.
    pub l1_difference_low: Option<f64>,
    /// Upper end; without realisations l1.
    pub l1_difference_high: Option<f64>,
    /// Largest |a - b|/se.
    pub max_t: Option<f64>,
    /// Share of the bins whose 95 % interval of the difference misses 0.
    pub share_outside_95: Option<f64>,
}

/// One stop of a comparison.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct StopDifference {
    /// Polar angle of the light.
    pub theta_i_deg: f64,
    /// Azimuth of the light.
    pub phi_i_deg: f64,
    /// The measures, means of the colours.
    #[serde(flatten)]
    pub figures: DifferenceFigures,
}

/// Compares two tables bin by bin; `Err` says in one line what does not fit.
///
/// - Gaps of either table are left out.
/// - Bins without hits in either table count in l1 and are left out of t's; a stderr of -1 anywhere makes the noise null.
/// - Degrees of freedom by Welch and Satterthwaite, rounded down; realisations - 1 where the tables are paired.
/// - Held by: `equal_laws_differ_by_their_noise_alone`, `the_measures_follow_their_definitions`.
pub fn difference(a: ComparedTable, b: ComparedTable) -> Result<TableDifference, String> {
    fits(a.table, b.table)?;
    let mut found = DifferenceRun::default();
    found.add(a, b, 0);
    Ok(found.finish())
}

/// The same of two stored tables, a band of stops after the other: both bands together hold `bytes` at most.
///
/// The sides give campaigns and realisations; their tables are not looked at. Held by:
/// `tables_compared_by_rows_differ_as_whole_ones` (tests/it/table/large_tables.rs).
pub fn difference_of_rows(
    (a, b): (&mut TableRows, &mut TableRows),
    campaigns: [Option<&Campaign>; 2],
    parts: [Option<&Realisations>; 2],
    bytes: u64,
) -> crate::error::Result<TableDifference> {
    let wrong = |path: &Path, why: String| Error::format(path, why);
    fits(a.header(), b.header()).map_err(|why| wrong(b.path(), why))?;
    a.verify()?;
    b.verify()?;
    let mut found = DifferenceRun::default();
    for stops in a.bands(bytes, a.row_bytes() + b.row_bytes()) {
        let first_stop = stops.start;
        let stops: Vec<usize> = stops.collect();
        let tables = [a.take(&stops)?, b.take(&stops)?];
        fits(&tables[0], &tables[1]).map_err(|why| wrong(b.path(), why))?;
        let [a, b] =
            [0, 1].map(|k| ComparedTable { table: &tables[k], campaign: campaigns[k], parts: parts[k] });
        found.add(a, b, first_stop);
    }
    Ok(found.finish())
}

/// A comparison under way: the stops come in their order, in bands.
#[derive(Default)]
struct DifferenceRun {
    stops: Vec<((f64, f64), DifferenceSums)>,
    paired: bool,
    most_dof: usize,
}

impl DifferenceRun {
    fn add(&mut self, a: ComparedTable, b: ComparedTable, first_stop: usize) {
        let pair = ComparedPair::new(a, b, first_stop);
        let grid = &a.table.grid;
        self.stops.extend((0..grid.stops()).map(|stop| (grid.stop_deg(stop), pair.stop(stop))));
        (self.paired, self.most_dof) = (pair.paired.is_some(), pair.most_dof());
    }

    fn finish(self) -> TableDifference {
        let sums: Vec<&DifferenceSums> = self.stops.iter().map(|(_, sums)| sums).collect();
        let whole = sums.iter().fold(DifferenceSums::default(), |all, stop| all.merged(stop));
        let row = |((theta_i_deg, phi_i_deg), sums): &((f64, f64), DifferenceSums)| StopDifference {
            theta_i_deg: *theta_i_deg,
            phi_i_deg: *phi_i_deg,
            figures: sums.figures(),
        };
        let judged = (whole.bins > 0).then_some(whole.bins);
        TableDifference {
            scope: "total",
            bins: whole.bins,
            paired: self.paired,
            t_limit: judged.map(|bins| stats::student_limit(stats::sidak(LEVEL, bins), self.most_dof)),
            figures: mean_of_stops(whole.figures(), &sums),
            stops: self.stops.iter().map(row).collect(),
        }
    }
}

/// l1, its noise and what realisations add as means over the stops that have light; t's over all bins.
fn mean_of_stops(whole: DifferenceFigures, stops: &[&DifferenceSums]) -> DifferenceFigures {
    let mean = |pick: fn(&DifferenceFigures) -> Option<f64>| {
        let values: Vec<f64> = stops.iter().filter_map(|stop| pick(&stop.figures())).collect();
        (!values.is_empty()).then(|| stats::mean(&values))
    };
    let parts: Vec<Vec<f64>> = stops.iter().map(|stop| stop.by_part()).filter(|p| !p.is_empty()).collect();
    let of_part = |k: usize| parts.iter().map(|parts| parts[k]).sum::<f64>() / parts.len() as f64;
    let by_part: Vec<f64> = (0..parts.first().map_or(0, Vec::len)).map(of_part).collect();
    DifferenceFigures { l1: mean(|f| f.l1), l1_noise: mean(|f| f.l1_noise), ..whole }
        .with_difference(&by_part)
}

/// Whether the tables have the same stops, bins and colours.
fn fits(a: &BrdfTable, b: &BrdfTable) -> Result<(), String> {
    if a.colours.len() != b.colours.len() {
        let names = [a, b].map(|table| table.colour_names().join(" "));
        return Err(format!("its colours are {}, the other table's {}", names[1], names[0]));
    }
    let (a, b) = (&a.grid, &b.grid);
    if a == b {
        return Ok(());
    }
    let axis = |name: &str, pick: fn(&Grid) -> &[f64]| {
        let (here, there) = (pick(b), pick(a));
        let at = here.iter().zip(there).find(|(here, there)| here != there);
        (here != there).then(|| match at {
            Some((here, there)) => format!("{name} has {here} where the other table has {there}"),
            None => format!("{name} has {} values, the other table's {}", here.len(), there.len()),
        })
    };
    let first = axis("theta_i_deg", |g| &g.theta_i_deg)
        .or_else(|| axis("phi_i_deg", |g| &g.phi_i_deg))
        .or_else(|| axis("theta_r_edges_deg", |g| &g.theta_r_edges_deg))
        .or_else(|| axis("phi_r_edges_deg", |g| &g.phi_r_edges_deg))
        .or_else(|| axis("theta_r_deg", |g| &g.theta_r_deg))
        .or_else(|| axis("phi_r_deg", |g| &g.phi_r_deg))
        .or_else(|| axis("aperture_deg", |g| g.aperture_deg.as_slice()));
    let what = first.unwrap_or_else(|| "kind or phi_r_relative differs".into());
    Err(format!("gonio.grid: {what}; only tables on the same grid are compared bin by bin"))
}

/// The realisations of both tables, where they were measured on the very same patches.
pub(super) fn paired<'a>(
    a: &ComparedTable<'a>,
    b: &ComparedTable<'a>,
) -> Option<(&'a Realisations, &'a Realisations)> {
    let same_patches = !a.table.patch_digest.is_empty() && a.table.patch_digest == b.table.patch_digest;
    let equal = |(a, b): &(&Realisations, &Realisations)| a.parts.len() == b.parts.len() && a.parts.len() > 1;
    a.parts.zip(b.parts).filter(|both| same_patches && equal(both))
}

/// Both tables with what their errors need.
struct ComparedPair<'a> {
    a: ComparedTable<'a>,
    b: ComparedTable<'a>,
    /// Which stop of the realisations is the tables' first.
    first_stop: usize,
    /// The realisations of both, where they can be paired.
    paired: Option<(&'a Realisations, &'a Realisations)>,
    /// The differences by realisation, paired or not.
    by_part: Option<by_part::BinDifferences<'a>>,
    realisations: [usize; 2],
    /// (95 % limit of t, c4) by degrees of freedom, from 1.
    limits: Vec<(f64, f64)>,
    folded: Vec<bool>,
}

impl<'a> ComparedPair<'a> {
    fn new(a: ComparedTable<'a>, b: ComparedTable<'a>, first_stop: usize) -> Self {
        let paired = paired(&a, &b);
        let count = |side: &ComparedTable| {
            side.campaign.map_or(MANY, |campaign| campaign.surface.realisations as usize).min(MANY)
        };
        let realisations = [count(&a), count(&b)];
        let most = match paired {
            Some((parts, _)) => parts.parts.len() - 1,
            None => (realisations[0] + realisations[1]).saturating_sub(2),
        };
        let limits = (1..=most).map(|dof| (stats::student_limit(0.05, dof), stats::c4(dof + 1))).collect();
        let folds =
            |side: &ComparedTable| side.campaign.map(|campaign| folded_stops(campaign, &side.table.grid));
        let none = || vec![false; a.table.grid.stops()];
        let (in_a, in_b) = (folds(&a).unwrap_or_else(none), folds(&b).unwrap_or_else(none));
        let folded = in_a.iter().zip(in_b).map(|(&a, b)| a && b).collect();
        let by_part = by_part::BinDifferences::new(a, b);
        ComparedPair { a, b, first_stop, paired, by_part, realisations, limits, folded }
    }

    fn most_dof(&self) -> usize {
        self.limits.len().max(1)
    }

    fn stop(&self, stop: usize) -> DifferenceSums {
        let grid = &self.a.table.grid;
        let bins = grid.bins();
        let counted = counted_bins(grid, stop, self.folded[stop]);
        let parts = self.by_part.as_ref().map_or(0, by_part::BinDifferences::count);
        let mut sums = DifferenceSums { parts: vec![0.0; parts], ..DifferenceSums::default() };
        for (bin, region) in grid.regions(stop).iter().enumerate() {
            for colour in 0..self.a.table.colours.len() {
                self.entry(TableEntry { at: stop * bins + bin, colour }, region, counted[bin], &mut sums);
            }
        }
        sums
    }

    fn entry(&self, entry: TableEntry, region: &Region, counted: bool, sums: &mut DifferenceSums) {
        let TableEntry { at, colour } = entry;
        if self.a.table.is_gap(at) || self.b.table.is_gap(at) {
            return;
        }
        let value = |side: &ComparedTable| f64::from(side.table.colours[colour].total[at]);
        let (a, b) = (value(&self.a), value(&self.b));
        let hit = self.a.table.hits[at] > 0 && self.b.table.hits[at] > 0;
        let w = region.projected_solid_angle();
        // Arms without an aperture have no size: their directions count alike.
        let w = if w > 0.0 { w } else { 1.0 };
        sums.distance += (a - b).abs() * w;
        sums.flux += b * w;
        if let Some(by_part) = &self.by_part {
            let stored = self.first_stop * self.a.table.grid.bins() + at;
            match by_part.at(ValueIndex { here: at, stored, colour }) {
                Some(x) => model_distance::add_products(&x, w, &mut sums.parts),
                None => sums.without_error = true,
            }
        }
        let Some((se, dof)) = self.error(entry, hit, a.max(b)) else {
            sums.without_error = true;
            return;
        };
        let (limit, c4) = self.limits[dof - 1];
        sums.noise += se * w / c4;
        if hit && counted && se > 0.0 {
            let t = (a - b).abs() / se;
            sums.max_t = Some(sums.max_t.map_or(t, |most: f64| most.max(t)));
            sums.outside += usize::from(t > limit);
            sums.bins += 1;
        }
    }

    /// Standard error of the difference and its degrees of freedom. An empty bin is off by no more than what the other
    /// table has there, whatever its 1.5 hits allow for.
    fn error(&self, TableEntry { at, colour }: TableEntry, hit: bool, larger: f64) -> Option<(f64, usize)> {
        if let Some((a, b)) = self.paired {
            let at = self.first_stop * self.a.table.grid.bins() + at;
            let value = |parts: &Realisations, k: usize| f64::from(parts.parts[k].total[colour][at]);
            let (_, se) = stats::mean_and_se((0..a.parts.len()).map(|k| value(a, k) - value(b, k)));
            return se.map(|se| (se, a.parts.len() - 1));
        }
        let se = [&self.a, &self.b].map(|side| f64::from(side.table.colours[colour].stderr[at]));
        if self.limits.is_empty() || se[0] < 0.0 || se[1] < 0.0 || self.realisations.contains(&1) {
            return None;
        }
        let [va, vb] = se.map(|se| se * se);
        let both = (va + vb).sqrt();
        let part = |variance: f64, count: usize| variance * variance / (count - 1) as f64;
        let spread = part(va, self.realisations[0]) + part(vb, self.realisations[1]);
        let dof =
            if spread > 0.0 { ((va + vb) * (va + vb) / spread).floor() as usize } else { self.limits.len() };
        Some((if hit { both } else { both.min(larger) }, dof.clamp(1, self.limits.len())))
    }
}

/// The place of a value in the tables.
#[derive(Clone, Copy)]
struct TableEntry {
    at: usize,
    colour: usize,
}

/// Sums over bins and colours.
#[derive(Debug, Clone, Default)]
struct DifferenceSums {
    distance: f64,
    /// What each realisation adds to the distance without noise.
    parts: Vec<f64>,
    noise: f64,
    flux: f64,
    without_error: bool,
    max_t: Option<f64>,
    outside: usize,
    bins: usize,
}

impl DifferenceSums {
    fn merged(mut self, other: &DifferenceSums) -> DifferenceSums {
        self.distance += other.distance;
        self.noise += other.noise;
        self.flux += other.flux;
        self.without_error |= other.without_error;
        self.max_t = [self.max_t, other.max_t].into_iter().flatten().reduce(f64::max);
        self.outside += other.outside;
        self.bins += other.bins;
        self
    }

    /// What each realisation adds to the distance relative to B; nothing where it is not known.
    fn by_part(&self) -> Vec<f64> {
        let known = self.flux > 0.0 && !self.without_error;
        let parts = if known { &self.parts[..] } else { &[] };
        parts.iter().map(|sum| sum / self.flux).collect()
    }

    fn figures(&self) -> DifferenceFigures {
        let known = !self.without_error;
        let l1 = (self.flux > 0.0).then(|| self.distance / self.flux);
        let l1_noise =
            (known && self.flux > 0.0).then(|| (2.0 / std::f64::consts::PI).sqrt() * self.noise / self.flux);
        DifferenceFigures {
            l1,
            l1_noise,
            max_t: self.max_t,
            share_outside_95: (self.bins > 0).then(|| self.outside as f64 / self.bins as f64),
            ..DifferenceFigures::default()
        }
        .with_difference(&self.by_part())
    }
}
