//! A surface by its power spectral density, and the physical scale of a campaign, checked.

use serde::Serialize;

use super::alpha::Alpha;
use crate::psd::{Psd, PsdMoments};

/// Gaussian heights of a power spectral density: `[surface.psd]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PsdSurface {
    /// The density.
    #[serde(flatten)]
    pub psd: Psd,
    /// Distance of neighbouring heights, um.
    pub pitch_um: f64,
    /// Root mean square height that the patches were checked against, um.
    pub rms_um: Option<f64>,
    /// The one roughness that belongs to it: Beckmann's alpha, sqrt(2) times the rms slope of the facets along an axis, to
    /// six digits.
    pub alphas: Vec<Alpha>,
}

impl PsdSurface {
    /// The surface on patches of cells x cells cells, and its correlation length in cells, from 2 to an eighth of them.
    ///
    /// `None`: no wave of the patch lies between the frequencies of the density.
    // Tested by `patches_have_the_moments_of_their_psd` (tests/it/surface/psd.rs).
    pub fn new(psd: Psd, pitch_um: f64, rms_um: Option<f64>, cells: u32) -> Option<(Self, f64)> {
        let moments = PsdMoments::of(&psd, cells, pitch_um);
        if moments.rms_um == 0.0 {
            return None;
        }
        let alpha = six_digits(std::f64::consts::SQRT_2 * moments.facet_slope);
        let longest = f64::from(cells) / 8.0;
        let correlation_cells = (moments.correlation_um() / pitch_um).clamp(longest.min(2.0), longest);
        Some((PsdSurface { psd, pitch_um, rms_um, alphas: vec![Alpha::isotropic(alpha)] }, correlation_cells))
    }
}

/// As many digits as anybody reads; the same number on every machine.
fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// Lengths that decide whether geometric optics holds, where nothing else says them: `[scale]`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct PhysicalScale {
    /// Distance of neighbouring columns of random heights, um.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pitch_um: Option<f64>,
    /// Wavelength of the light in vacuum, nm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wavelength_nm: Option<f64>,
}
