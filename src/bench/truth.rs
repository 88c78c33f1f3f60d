//! What the errors of a ladder are counted from, and the error itself.

use serde::{Deserialize, Serialize};

use crate::campaign::Campaign;
use crate::error::{Error, Result};
use crate::measure::{Measured, Plan};
use crate::table::BrdfTable;
use crate::validate::expect;
use crate::validate::prediction::model::Model;

/// The error measure by its name in tables, JSON and plot.
pub const ERROR_MEASURE: &str = "flux-weighted L1 of order 1, mean over incidences";

/// The kinds of truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TruthKind {
    /// The bin means of the microfacet model.
    Model,
    /// A run of the same campaign with another seed and four times the largest number of samples.
    Reference,
}

/// The true BRDF of every incidence, colour and bin.
pub struct Truth {
    /// Its name, with the masking where it is a model.
    pub name: String,
    /// [stop][colour][bin], 1/sr.
    values: Vec<Vec<Vec<f64>>>,
    /// [stop][bin]: projected solid angles.
    sizes: Vec<Vec<f64>>,
}

impl Truth {
    /// The model of the campaign's surface with the masking that it is tested against.
    pub fn model(campaign: &Campaign, plan: &Plan) -> Result<Self> {
        let model = Model::of(campaign)
            .ok_or_else(|| Error::Usage(format!("{}: no model speaks of this surface", campaign.name)))?;
        // A surface with one masking of its own has no choice.
        let index = model.masking_index(Some(expect::masking(campaign)));
        let means = model.means(campaign, &plan.grid).into_iter();
        Ok(Truth {
            name: format!("{} {}", model.name(), model.maskings()[index]),
            values: means.map(|mut means| means.values.swap_remove(index)).collect(),
            sizes: sizes(plan),
        })
    }

    /// A long run.
    pub fn reference(measured: &Measured, plan: &Plan, samples: u64) -> Self {
        let of = |incidence: usize| {
            let colours = measured.table.colours.iter();
            colours.map(|c| bins_of(&c.single, incidence, plan.bins).map(f64::from).collect()).collect()
        };
        Truth {
            name: format!("reference run of {samples} samples"),
            values: (0..plan.incidences).map(of).collect(),
            sizes: sizes(plan),
        }
    }

    /// Mean over incidences and colours of sum |f - m| w / sum m w: f the table's order 1, m the truth, w projected solid
    /// angle.
    // Tested by `the_error_is_the_flux_weighted_distance`.
    pub fn error_of(&self, table: &BrdfTable) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (incidence, (colours, size)) in self.values.iter().zip(&self.sizes).enumerate() {
            for (channels, truth) in table.colours.iter().zip(colours) {
                let (mut distance, mut flux) = (0.0, 0.0);
                for ((f, m), w) in bins_of(&channels.single, incidence, size.len()).zip(truth).zip(size) {
                    distance += (f64::from(f) - m).abs() * w;
                    flux += m * w;
                }
                sum += distance / flux;
                count += 1.0;
            }
        }
        sum / count
    }
}

fn bins_of(values: &[f32], incidence: usize, bins: usize) -> impl Iterator<Item = f32> + '_ {
    values[incidence * bins..(incidence + 1) * bins].iter().copied()
}

fn sizes(plan: &Plan) -> Vec<Vec<f64>> {
    (0..plan.incidences).map(|incidence| plan.grid.sizes(incidence)).collect()
}
