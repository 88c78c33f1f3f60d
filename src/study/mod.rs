//! Isotropy and anisotropy: the sample is turned through 360 degrees under arms that stay.
//!
//! Input: a campaign. Output: how far the BRDF depends on the turn (noise removed), a test of isotropy, where a 3-D
//! table would be wrong, and the fitted alpha_x, alpha_y and rotation. Mirror images and folding assume the very
//! symmetry under test and are switched off; the unit of every error is the realisation.

mod harmonics;
mod index;
pub mod turned;

pub use harmonics::{AzimuthHarmonic, hotelling_p};
pub use index::{IncidenceIndex, Worst};
pub use turned::turned;

use serde::Serialize;

use crate::campaign::SurfaceKind;
use crate::fit::{self, FitData, FitLaw, MicrofacetLaw};
use crate::measure::Measured;
use crate::theory::{Masking, Ndf};
use crate::validate::prediction::model::ndf_of;

/// Level of the test of isotropy.
pub const LEVEL: f64 = 0.01;

/// What a turn of the sample shows.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Study {
    /// Root mean square deviation of the turned BRDFs from their mean over the turn, relative to that mean.
    pub anisotropy_index: f64,
    /// Its standard error by leaving out one realisation at a time; null with fewer than three.
    pub anisotropy_index_se: Option<f64>,
    /// Probability that an isotropic sample shows harmonics of the azimuth as large as these; null with too few
    /// realisations.
    pub p_value: Option<f64>,
    /// 3 where isotropy stands at the level of 1 %, 4 where it does not; null without a test.
    pub dimensions: Option<u32>,
    /// Model of the fit.
    pub model: Option<&'static str>,
    /// Masking of the fit.
    pub masking: Option<&'static str>,
    /// Slope scale along the sample's x axis; that of every axis where isotropy stands.
    pub alpha_x: Option<f64>,
    /// Its standard error.
    pub alpha_x_se: Option<f64>,
    /// Slope scale along y.
    pub alpha_y: Option<f64>,
    /// Its standard error.
    pub alpha_y_se: Option<f64>,
    /// Azimuth of the x axis, within 45 degrees of the campaign's; null where isotropy stands.
    pub rotation_deg: Option<f64>,
    /// Its standard error.
    pub rotation_deg_se: Option<f64>,
    /// Realisations behind every error.
    pub realisations: usize,
    /// Turns of the sample.
    pub turns: usize,
    /// Harmonics of the half vector's azimuth, orders 1 to 4; p_value is of those that count.
    pub harmonics: Vec<AzimuthHarmonic>,
    /// The index of each theta_i.
    #[serde(rename = "stops")]
    pub incidences: Vec<IncidenceIndex>,
    /// Where the isotropic assumption costs most.
    pub worst: Option<Worst>,
}

/// What the measured turn of a sample shows; `measured` comes from a campaign and plan of [`turned()`].
// Tested by `a_brushed_law_returns_its_roughnesses_and_its_turn` (tests/it/study.rs).
pub fn examine(measured: &Measured) -> Study {
    let mut study = examine_isotropy(measured);
    let data = data_of(measured);
    let laws = laws(measured, &data, study.dimensions == Some(4));
    if laws.is_empty() || study.p_value.is_none() {
        return study;
    }
    let fit = fit::best(&data, &laws);
    let value = |name: &str, alone: &str| [name, alone].into_iter().find_map(|name| fit.parameters.get(name));
    let error =
        |name: &str, alone: &str| [name, alone].into_iter().find_map(|name| fit.standard_errors.get(name));
    (study.alpha_x, study.alpha_x_se) = (value("alpha_x", "alpha"), error("alpha_x", "alpha"));
    (study.alpha_y, study.alpha_y_se) = (value("alpha_y", "alpha"), error("alpha_y", "alpha"));
    study.rotation_deg = fit.parameters.get("rotation_deg");
    study.rotation_deg_se = fit.standard_errors.get("rotation_deg");
    (study.model, study.masking) = (Some(fit.model), fit.masking);
    study
}

/// The same without the fit: index and test need no model.
// Tested by `an_isotropic_law_is_rejected_as_often_as_the_level_says` (tests/it/study.rs).
pub fn examine_isotropy(measured: &Measured) -> Study {
    let data = data_of(measured);
    let harmonics = harmonics::harmonics(&data, measured.campaign.surface.kind.has_random_patches());
    let p_value = joint(&harmonics);
    let index = index::index(&data);
    Study {
        anisotropy_index: index.value,
        anisotropy_index_se: index.se,
        p_value,
        dimensions: p_value.map(|p| if p < LEVEL { 4 } else { 3 }),
        realisations: data.parts.len(),
        turns: data.grid.phi_i_deg.len(),
        harmonics,
        incidences: index.incidences,
        worst: index.worst,
        ..Study::default()
    }
}

fn data_of(measured: &Measured) -> FitData {
    FitData::new(&measured.table, Some(&measured.campaign), Some(&measured.realisations))
}

/// The p of the smallest of those that count: 1 - (1 - p)^n (Sidak), exact for independent tests and near it otherwise.
fn joint(harmonics: &[AzimuthHarmonic]) -> Option<f64> {
    let counted = harmonics.iter().filter(|harmonic| harmonic.counts);
    let all = counted.map(|harmonic| harmonic.p_value).collect::<Option<Vec<f64>>>()?;
    let smallest = all.iter().copied().reduce(f64::min)?;
    Some(if smallest >= 1.0 { 1.0 } else { -(all.len() as f64 * (-smallest).ln_1p()).exp_m1() })
}

/// Models of the campaign's law, or of both where it has none; nothing for a mirror. Two roughnesses only where isotropy
/// does not stand: axes that are chosen to make the most of the noise always lie apart.
fn laws(measured: &Measured, data: &FitData, anisotropic: bool) -> Vec<FitLaw> {
    let ndfs = match &measured.campaign.surface.kind {
        SurfaceKind::VGroove { .. } | SurfaceKind::File(_) => vec![Ndf::Ggx, Ndf::Beckmann],
        kind => ndf_of(kind).into_iter().collect(),
    };
    let maskings = if measured.campaign.trace.visibility { &Masking::ALL[1..] } else { &Masking::ALL[..1] };
    let clear = data.clear.first().copied();
    let laws = ndfs.into_iter().flat_map(|ndf| {
        let law = move |&masking| {
            FitLaw::Microfacet(MicrofacetLaw { clear, ..MicrofacetLaw::new(ndf, masking, anisotropic) })
        };
        maskings.iter().map(law)
    });
    laws.collect()
}
