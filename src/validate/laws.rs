//! The laws that any table obeys, whatever its surface: energy and reciprocity.

use serde::Serialize;

use super::model::StopMeans;
use crate::instrument::{Grid, GridKind, Region, Sensor};
use crate::sphere;
use crate::stats;
use crate::table::{BrdfTable, Realisations};

/// Family level of the tests of this file.
const LEVEL: f64 = 0.01;

/// Energy: no stop reflects more than it gets.
#[derive(Debug, Clone, Serialize)]
pub struct Energy {
    /// Why the law does not apply, where it does not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skipped: Option<String>,
    /// Largest albedo of a stop and colour, all orders.
    pub largest_albedo: Option<f64>,
    /// Its standard error.
    pub largest_albedo_se: Option<f64>,
    /// Stops and colours above 1 by more than three standard errors.
    pub violations: usize,
}

/// Reciprocity: f(wi, wo) = f(wo, wi) over pairs of stops.
#[derive(Debug, Clone, Serialize)]
pub struct Reciprocity {
    /// `exact`: equal apertures on both arms; `bin_means`: bins of different shape, corrected by the model.
    pub kind: String,
    /// Pairs of directions.
    pub pairs: usize,
    /// Largest |t| of the differences.
    pub max_t: Option<f64>,
    /// Sidak's limit for it at the 1 % level.
    pub limit: Option<f64>,
    /// Mean of t^2 (dof-2)/dof: 1 where the errors are right.
    pub mean_t2: Option<f64>,
    /// Sum of |differences| over the sum of values.
    pub l1: Option<f64>,
}

impl Energy {
    /// The law for a hemisphere table; arms see too little to judge.
    pub fn of(table: &BrdfTable, realisations: Option<&Realisations>, visibility: bool) -> Self {
        let none = Energy { skipped: None, largest_albedo: None, largest_albedo_se: None, violations: 0 };
        if !visibility {
            return Energy { skipped: Some("visibility is switched off".into()), ..none };
        }
        if matches!(table.grid.kind, GridKind::Arm | GridKind::Points) {
            let why = if table.grid.kind == GridKind::Arm { "an arm does" } else { "points do" };
            return Energy { skipped: Some(format!("{why} not see the whole hemisphere")), ..none };
        }
        let mut energy = none;
        for stop in 0..table.grid.stops() {
            for colour in 0..table.colours.len() {
                let (albedo, se) = albedo(table, realisations, stop, colour);
                // f32 storage: 2^-24 of the value.
                energy.violations += usize::from(albedo > 1.0 + 3.0 * se.unwrap_or(0.0) + 1e-6);
                if energy.largest_albedo.is_none_or(|largest| albedo > largest) {
                    (energy.largest_albedo, energy.largest_albedo_se) = (Some(albedo), se);
                }
            }
        }
        energy
    }
}

/// Flux of all orders into all bins, with its error over the realisations where they are at hand.
///
/// Without them, with that of the number of arrivals n: all starts of a stop carry one flux, and what a torus shows
/// the light has no noise of its own, so se = flux sqrt(2/n); the 2 stands for arrivals that count on both sides of
/// a folded stop. Held by: `few_arrivals_of_one_realisation_break_no_law` (tests/grazing_stability.rs).
fn albedo(
    table: &BrdfTable,
    realisations: Option<&Realisations>,
    stop: usize,
    colour: usize,
) -> (f64, Option<f64>) {
    let sizes: Vec<f64> = table.grid.regions(stop).iter().map(Region::projected_solid_angle).collect();
    let bins = sizes.len();
    let flux = |values: &[f32]| {
        values[stop * bins..][..bins].iter().zip(&sizes).map(|(&f, w)| f64::from(f) * w).sum::<f64>()
    };
    match realisations {
        Some(r) if r.parts.len() > 1 => {
            stats::mean_and_se(r.parts.iter().map(|part| flux(&part.total[colour])))
        }
        _ => {
            let flux = flux(&table.colours[colour].total);
            let arrivals: u64 = table.hits[stop * bins..][..bins].iter().map(|&hits| u64::from(hits)).sum();
            (flux, (arrivals > 0).then(|| flux * (2.0 / arrivals as f64).sqrt()))
        }
    }
}

/// A pair of measurements that should agree: (stop, bin) with the arms one way and the other way round.
struct Pair {
    there: (usize, usize),
    back: (usize, usize),
}

impl Reciprocity {
    /// Checks order 1 of the first colour. `means` are a model's bin means by stop, needed where the bins of the
    /// two ways differ in shape; without realisations the two errors are taken as independent.
    pub fn of(
        table: &BrdfTable,
        realisations: Option<&Realisations>,
        exact: bool,
        means: Option<&[StopMeans]>,
    ) -> Option<Self> {
        let pairs = pairs(&table.grid);
        let (bins, single) = (table.grid.bins(), &table.colours[0].single);
        let at = |(stop, bin): (usize, usize)| stop * bins + bin;
        let ratio = |pair: &Pair| match means {
            Some(means) if !exact => {
                let model = |(stop, bin): (usize, usize)| means[stop].values[0][0][bin];
                model(pair.there) / model(pair.back)
            }
            _ => 1.0,
        };
        let usable = |pair: &&Pair| {
            table.hits[at(pair.there)] > 0 && table.hits[at(pair.back)] > 0 && ratio(pair).is_finite()
        };
        let pairs: Vec<&Pair> = pairs.iter().filter(usable).collect();
        if pairs.is_empty() || (!exact && means.is_none()) {
            return None;
        }
        let (mut t, mut distance, mut sum) = (Vec::new(), 0.0, 0.0);
        for pair in &pairs {
            let (there, back, ratio) = (at(pair.there), at(pair.back), ratio(pair));
            let difference = |values: &[f32]| f64::from(values[there]) - ratio * f64::from(values[back]);
            distance += difference(single).abs();
            sum += f64::from(single[there]);
            let (mean, se) = match realisations {
                Some(r) if r.parts.len() > 1 => {
                    stats::mean_and_se(r.parts.iter().map(|part| difference(&part.single[0])))
                }
                _ => {
                    let se = |entry: usize| {
                        Some(f64::from(table.colours[0].stderr_single[entry])).filter(|&se| se > 0.0)
                    };
                    let both = se(there).zip(se(back)).map(|(a, b)| a.hypot(ratio * b));
                    (difference(single), both)
                }
            };
            t.extend(se.filter(|&se| se > 0.0).map(|se| mean / se));
        }
        let dof = realisations.map_or(0, |r| r.parts.len().saturating_sub(1));
        let known = dof > 2 && !t.is_empty();
        Some(Reciprocity {
            kind: if exact { "exact" } else { "bin_means" }.into(),
            pairs: pairs.len(),
            max_t: t.iter().map(|t| t.abs()).reduce(f64::max),
            limit: known.then(|| stats::student_limit(stats::sidak(LEVEL, t.len()), dof)),
            mean_t2: known.then(|| {
                let squares: Vec<f64> = t.iter().map(|t| t * t).collect();
                stats::mean(&squares) * (dof as f64 - 2.0) / dof as f64
            }),
            l1: (sum > 0.0).then(|| distance / sum),
        })
    }
}

/// Pairs of stops whose directions the sensor sees from each other. In a 3-D table every column is such a pair.
fn pairs(grid: &Grid) -> Vec<Pair> {
    let sensor = Sensor::new(grid);
    let stops = grid.stops();
    let mut pairs = Vec::new();
    for a in 0..stops {
        for b in a + 1..stops {
            let relative_3d = grid.phi_r_relative && grid.phi_i_deg.len() == 1;
            if relative_3d && grid.kind == GridKind::Hemisphere {
                let columns = grid.phi_r_edges_deg.len() - 1;
                let (row_a, row_b) = (row_of(grid, a), row_of(grid, b));
                // Columns beyond half a turn repeat the others mirrored.
                pairs.extend((0..=columns / 2).map(|column| Pair {
                    there: (a, row_b * columns + column),
                    back: (b, row_a * columns + column),
                }));
            } else if let (Some(there), Some(back)) =
                (bin_of(grid, &sensor, a, b), bin_of(grid, &sensor, b, a))
            {
                pairs.push(Pair { there: (a, there), back: (b, back) });
            }
        }
    }
    pairs
}

/// The row of bins that holds the polar angle of a stop.
fn row_of(grid: &Grid, stop: usize) -> usize {
    let theta = grid.stop_deg(stop).0;
    grid.theta_r_edges_deg.partition_point(|&edge| edge <= theta) - 1
}

/// The bin at stop `from` that looks along the direction of stop `to`; of an arm, only a position that is there.
fn bin_of(grid: &Grid, sensor: &Sensor, from: usize, to: usize) -> Option<usize> {
    let back = if grid.phi_r_relative { -grid.stop_deg(from).1 } else { 0.0 };
    let wo = sphere::turned(grid.wi(to), sphere::sin_cos_deg(back));
    let mut found = None;
    sensor.each_bin(wo, |bin| {
        let same = match grid.regions(from)[bin] {
            Region::Cap { axis, .. } => axis.distance(grid.wi(to)) < 1e-9,
            Region::Rectangle { .. } => true,
        };
        if same {
            found = Some(bin);
        }
    });
    found
}
