//! The laws that any table obeys, whatever its surface: energy and reciprocity.

use serde::{Deserialize, Serialize};

use super::pairs::PairValues;
use crate::instrument::GridKind;
use crate::stats;
use crate::table::BrdfTable;
use crate::table::brdf_table::flux;

/// Family level of the tests of this file.
const LEVEL: f64 = 0.01;

/// Energy: no incidence reflects more than it gets.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Energy {
    /// Why the law does not apply, where it does not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skipped: Option<String>,
    /// Largest albedo of an incidence and colour, all orders.
    pub largest_albedo: Option<f64>,
    /// Its standard error.
    pub largest_albedo_se: Option<f64>,
    /// Its colour, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_albedo_colour: Option<String>,
    /// Incidences and colours above 1 by more than three standard errors.
    pub violations: usize,
    /// Whether the errors of counting are allowed for where no others are known: the table was measured.
    #[serde(skip)]
    pub counted: bool,
}

/// Reciprocity: f(wi, wo) = f(wo, wi) over pairs of incidences.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Reciprocity {
    /// `exact`: equal apertures on both arms; `bin_means`: bins of different shape, corrected by the model.
    pub kind: String,
    /// Pairs of directions.
    pub pairs: usize,
    /// Those that are judged (`PairValues::is_judged`); `max_t`, `limit` and `mean_t2` speak of them alone.
    pub judged_pairs: usize,
    /// Why none is judged, where none is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_judged: Option<String>,
    /// Largest |t| of the differences beyond what the correction by the model may be off.
    pub max_t: Option<f64>,
    /// Sidak's limit for it at the 1 % level.
    pub limit: Option<f64>,
    /// Mean of t^2 (dof-2)/dof: 1 where the errors are right.
    pub mean_t2: Option<f64>,
    /// Sum of |differences| over the sum of values.
    pub l1: Option<f64>,
}

impl Energy {
    /// Takes further incidences in.
    pub fn join(&mut self, other: Energy) {
        self.skipped = other.skipped;
        self.violations += other.violations;
        self.counted |= other.counted;
        if other.largest_albedo > self.largest_albedo {
            (self.largest_albedo, self.largest_albedo_se) = (other.largest_albedo, other.largest_albedo_se);
            self.largest_albedo_colour = other.largest_albedo_colour;
        }
    }

    /// The law for a hemisphere table or some of its incidences; arms see too little to judge.
    pub fn of(table: &BrdfTable, visibility: bool) -> Self {
        let none = Energy::default();
        if !visibility {
            return Energy { skipped: Some("visibility is switched off".into()), ..none };
        }
        if matches!(table.grid.kind, GridKind::Arm | GridKind::Points) {
            let why = if table.grid.kind == GridKind::Arm { "an arm does" } else { "points do" };
            return Energy { skipped: Some(format!("{why} not see the whole hemisphere")), ..none };
        }
        let mut energy = Energy { counted: is_measured(table), ..none };
        let names = table.colour_names();
        for incidence in 0..table.grid.incidences() {
            for colour in 0..table.colours.len() {
                let (albedo, se) = albedo(table, incidence, colour);
                let noise = se.unwrap_or_else(|| counting_error(table, incidence, albedo));
                // f32 storage: 2^-24 of the value.
                energy.violations += usize::from(albedo > 1.0 + 3.0 * noise + 1e-6);
                if energy.largest_albedo.is_none_or(|largest| albedo > largest) {
                    (energy.largest_albedo, energy.largest_albedo_se) = (Some(albedo), se);
                    energy.largest_albedo_colour = (names.len() > 1).then(|| names[colour].clone());
                }
            }
        }
        energy
    }
}

/// Flux of all orders into all bins, with its error over the realisations, which the table holds: it is the same
/// whether their file is there or not.
fn albedo(table: &BrdfTable, incidence: usize, colour: usize) -> (f64, Option<f64>) {
    let sizes = table.grid.sizes(incidence);
    let flux = flux(&table.colours[colour].total[incidence * sizes.len()..][..sizes.len()], &sizes);
    (flux, table.colours[colour].albedo_se.get(incidence).map(|&se| f64::from(se)))
}

/// Whether a table says how it was measured; an imported one does not, and its `hits` are no counts.
pub(super) fn is_measured(table: &BrdfTable) -> bool {
    !table.campaign.is_empty()
}

/// What a table of one realisation may be off by, counting alone: it is allowed for and never printed as an error.
///
/// With n arrivals, all starts of an incidence carry one flux, and what a torus shows the light has no noise of its own, so
/// that it is flux sqrt(2/n); the 2 stands for arrivals that count on both sides of a folded incidence. 0 for a table that
/// was not measured here: of its errors nothing is known.
// Tested by `few_arrivals_of_one_realisation_break_no_law` (tests/it/measure/grazing_stability.rs).
fn counting_error(table: &BrdfTable, incidence: usize, flux: f64) -> f64 {
    let bins = table.grid.bins();
    let arrivals: u64 = table.hits[incidence * bins..][..bins].iter().map(|&hits| u64::from(hits)).sum();
    let counted = is_measured(table) && arrivals > 0;
    if counted { flux * (2.0 / arrivals as f64).sqrt() } else { 0.0 }
}

impl Reciprocity {
    /// Checks order 1 of the first colour; `None` where no two directions see each other.
    pub fn of_pairs(values: &PairValues) -> Option<Self> {
        let usable: Vec<usize> = (0..values.len()).filter(|&pair| values.is_usable(pair)).collect();
        if usable.is_empty() {
            return None;
        }
        let (mut t, mut squares, mut distance, mut sum) = (Vec::new(), Vec::new(), 0.0, 0.0);
        for &pair in &usable {
            distance += values.difference(pair).abs();
            sum += values.there(pair);
            if values.is_judged(pair) {
                let (mean, se) = values.mean_difference(pair);
                if let Some(se) = se.filter(|&se| se > 0.0) {
                    squares.push((mean / se).powi(2));
                    t.push((mean.abs() - values.allowance(pair)).max(0.0) / se);
                }
            }
        }
        let dof = values.realisations().saturating_sub(1);
        let known = dof > 2 && !t.is_empty();
        Some(Reciprocity {
            kind: if values.exact { "exact" } else { "bin_means" }.into(),
            pairs: usable.len(),
            judged_pairs: t.len(),
            not_judged: t.is_empty().then(|| {
                let why = if values.realisations() < 2 {
                    "the realisations are not at hand"
                } else {
                    "no pair of bins holds enough facets and arrivals in each realisation"
                };
                why.into()
            }),
            max_t: t.iter().copied().reduce(f64::max),
            limit: known.then(|| stats::student_limit(stats::sidak(LEVEL, t.len()), dof)),
            mean_t2: known.then(|| stats::mean(&squares) * (dof as f64 - 2.0) / dof as f64),
            l1: (sum > 0.0).then(|| distance / sum),
        })
    }
}
