//! Uncertainty budgets of measured BRDF values: the law of propagation (JCGM 100) and, beside it, the propagation of
//! distributions (JCGM 101).
//!
//! Input: a campaign and its `[uncertainty]`. Output: for each pair of directions and colour the value, u_c, nu_eff, k and U
//! at 95 %, its components, and the interval of the Monte Carlo method. Sensitivities are measured: the campaign once more
//! with one variable moved, on the same patches and random numbers. Frame of tilts: the stage's; x is the light's azimuth
//! where that is averaged.

mod alternatives;
mod assembly;
pub mod differences;
pub mod gum;
mod instruments;
mod measured;
pub mod monte_carlo;
pub mod positions;
pub mod report;
pub mod response;
mod rig;
mod sensitivities;
mod steps;

pub use alternatives::LeftOut;
pub use instruments::Check;
pub use measured::{Measured, measure};
pub use report::{Budget, Component, Kind, Place, ValueBudget};

use crate::campaign::{Campaign, Uncertainty};
use crate::error::{Error, Result};

/// The budget of a campaign. `stage` is told what is done now.
///
/// Errors: `Refused` where an arm is too near the horizon to be moved, where no light arrives anywhere, and as
/// [`crate::measure::plan()`]; those of making patches.
pub fn budget(campaign: &Campaign, uncertainty: &Uncertainty, stage: &dyn Fn(&str)) -> Result<Budget> {
    let mut measured = measure(campaign, uncertainty, stage)?;
    measured.look_for_alternatives(stage)?;
    stage("drawing errors of the instrument");
    let factor = uncertainty
        .correlation_factor()
        .map_err(|quantity| Error::Internal(format!("correlations of {}", quantity.name())))?;
    measured.budget(uncertainty, &factor, stage)
}
