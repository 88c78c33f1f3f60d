//! A budget as its reader gets it.

use serde::Serialize;

use super::alternatives::LeftOut;
use super::gum::Combined;
use super::instruments::Check;
use super::monte_carlo::{Agreement, MonteCarlo};
use super::positions::Position;

/// Version of the names here.
pub const SCHEMA: u32 = 1;

/// The budget of a campaign.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Budget {
    /// Version of the names here.
    pub schema: u32,
    /// The campaign's name.
    pub name: String,
    /// The campaign with its `[uncertainty]`, TOML.
    pub campaign: String,
    /// Realisations behind every type A error.
    pub realisations: usize,
    /// Surface samples per incidence and realisation.
    pub samples: u64,
    /// A budget for each pair of directions and colour.
    pub values: Vec<ValueBudget>,
    /// Covariances of the values, (1/sr)^2, in their order: inputs and realisations that they share. What else they may be
    /// off by counts on the diagonal alone: how it is shared is not known.
    pub covariance: Vec<Vec<f64>>,
    /// The second-order surface against instruments that were measured.
    pub check: Check,
    /// What is no part of the budget, and why.
    pub left_out: Vec<LeftOut>,
    /// Pairs of directions in a colour that no light reached: they have no budget.
    pub dark: Vec<Place>,
    /// What a measured map had to say.
    pub notes: Vec<String>,
}

/// A value's place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Place {
    /// Directions.
    #[serde(flatten)]
    pub position: Position,
    /// Name of the colour.
    pub colour: String,
}

/// The budget of one value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ValueBudget {
    /// Where it is.
    #[serde(flatten)]
    pub place: Place,
    /// BRDF, mean over the aperture, 1/sr.
    pub value: f64,
    /// Paths behind it.
    pub hits: u64,
    /// By JCGM 100.
    #[serde(flatten)]
    pub gum: Combined,
    /// By JCGM 101.
    pub monte_carlo: MonteCarlo,
    /// Whether both say the same.
    pub agreement: Agreement,
    /// The components, the largest first.
    pub components: Vec<Component>,
}

/// Where a component comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// A quantity of `[uncertainty]`.
    Input,
    /// The spread of realisations.
    TypeA,
    /// The difference from the same measurement done otherwise.
    Alternative,
    /// What correlations of inputs add, or take away.
    Correlation,
}

/// One component of u_c^2.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Component {
    /// Its name.
    pub name: String,
    /// Where it comes from.
    pub kind: Kind,
    /// Its law.
    pub distribution: &'static str,
    /// Standard uncertainty of the input, in its unit; null of correlations.
    pub standard_uncertainty: Option<f64>,
    /// Degrees of freedom; null: infinitely many.
    pub dof: Option<f64>,
    /// dy/dx.
    pub sensitivity: Option<f64>,
    /// Its standard error, truncation included; null where it is exact.
    pub sensitivity_error: Option<f64>,
    /// The largest step of the finite differences; null where there were none.
    pub step: Option<f64>,
    /// |dy/dx| u(x), 1/sr; null of correlations.
    pub contribution: Option<f64>,
    /// Standard error of a difference that is no more than an estimate, 1/sr.
    pub contribution_error: Option<f64>,
    /// Its part of u_c^2; those of all components sum to 1.
    pub share: f64,
}
