//! What the models say of a table: their means over its bins, and what apertures and Schlick's formula do to them.

pub mod aperture;
pub mod bin_mean;
pub mod bin_mean_diffuse;
pub mod bin_mean_through;
mod by_colour;
mod chart;
mod critical;
pub mod formulas;
mod layered;
mod lobes;
pub mod model;
pub mod quadrature;
pub mod schlick_error;

use crate::campaign::Campaign;
use crate::instrument::Grid;
use model::{IncidenceMeans, Model};

/// What theory predicts for every incidence and bin of a table.
pub struct Prediction {
    /// The model of the table's surface.
    pub model: Model,
    /// Its means, incidence by incidence.
    pub means: Vec<IncidenceMeans>,
}

impl Prediction {
    /// The prediction for a table's grid; `None` where theory has nothing to say of the surface.
    pub fn of(campaign: &Campaign, grid: &Grid) -> Option<Self> {
        let model = Model::of(campaign)?;
        let means = model.means(campaign, grid);
        Some(Prediction { model, means })
    }

    /// For the bins of a table of this grid on one side of the surface.
    pub fn half(&self, grid: &Grid, below: bool) -> Option<Self> {
        let half = grid.half(below)?;
        let of_bins = |values: &Vec<f64>| half.of(values, 1);
        let of_incidence = |means: &IncidenceMeans| IncidenceMeans {
            values: means.values.iter().map(|colours| colours.iter().map(of_bins).collect()).collect(),
        };
        Some(Prediction { model: self.model.clone(), means: self.means.iter().map(of_incidence).collect() })
    }
}
