//! The laws that any table obeys, whatever its surface: energy and reciprocity.

use serde::Serialize;

use super::model::StopMeans;
use super::pairs::PairValues;
use crate::instrument::{GridKind, Region};
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

/// The realisations of a table or of some of its stops.
#[derive(Clone, Copy)]
pub struct Parts<'a> {
    /// Those of the table.
    pub all: &'a Realisations,
    /// Which of their stops is the first of the table at hand.
    pub first_stop: usize,
}

impl<'a> Parts<'a> {
    /// Those of a whole table.
    pub fn of(all: Option<&'a Realisations>) -> Option<Self> {
        all.map(|all| Parts { all, first_stop: 0 })
    }
}

impl Energy {
    /// The law for a hemisphere table; arms see too little to judge.
    pub fn of(table: &BrdfTable, realisations: Option<&Realisations>, visibility: bool) -> Self {
        Self::of_band(table, Parts::of(realisations), visibility)
    }

    /// No stop yet.
    pub fn none() -> Self {
        Energy { skipped: None, largest_albedo: None, largest_albedo_se: None, violations: 0 }
    }

    /// Takes further stops in.
    pub fn join(&mut self, other: Energy) {
        self.skipped = other.skipped;
        self.violations += other.violations;
        if other.largest_albedo > self.largest_albedo {
            (self.largest_albedo, self.largest_albedo_se) = (other.largest_albedo, other.largest_albedo_se);
        }
    }

    /// The law for some stops of a table.
    pub fn of_band(table: &BrdfTable, realisations: Option<Parts>, visibility: bool) -> Self {
        let none = Energy::none();
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
fn albedo(table: &BrdfTable, realisations: Option<Parts>, stop: usize, colour: usize) -> (f64, Option<f64>) {
    let sizes: Vec<f64> = table.grid.regions(stop).iter().map(Region::projected_solid_angle).collect();
    let bins = sizes.len();
    let flux = |values: &[f32], stop: usize| {
        values[stop * bins..][..bins].iter().zip(&sizes).map(|(&f, w)| f64::from(f) * w).sum::<f64>()
    };
    match realisations {
        Some(Parts { all, first_stop }) if all.parts.len() > 1 => {
            stats::mean_and_se(all.parts.iter().map(|part| flux(&part.total[colour], first_stop + stop)))
        }
        _ => {
            let flux = flux(&table.colours[colour].total, stop);
            let arrivals: u64 = table.hits[stop * bins..][..bins].iter().map(|&hits| u64::from(hits)).sum();
            (flux, (arrivals > 0).then(|| flux * (2.0 / arrivals as f64).sqrt()))
        }
    }
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
        let mut values = PairValues::new(&table.grid, exact);
        values.add(table, 0, Parts::of(realisations), means);
        Self::of_pairs(&values)
    }

    /// The same of what was gathered stop by stop.
    pub fn of_pairs(values: &PairValues) -> Option<Self> {
        let usable: Vec<usize> = (0..values.len()).filter(|&pair| values.is_usable(pair)).collect();
        if usable.is_empty() {
            return None;
        }
        let (mut t, mut distance, mut sum) = (Vec::new(), 0.0, 0.0);
        for &pair in &usable {
            distance += values.difference(pair).abs();
            sum += values.there(pair);
            let (mean, se) = values.mean_difference(pair);
            t.extend(se.filter(|&se| se > 0.0).map(|se| mean / se));
        }
        let dof = values.realisations().saturating_sub(1);
        let known = dof > 2 && !t.is_empty();
        Some(Reciprocity {
            kind: if values.exact { "exact" } else { "bin_means" }.into(),
            pairs: usable.len(),
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
