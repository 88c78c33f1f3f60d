//! Areal parameters, autocorrelation and power spectrum of a map on its own grid: ISO 25178-2.

mod correlation;
mod fourier;
mod parameters;
mod spectrum;

use serde::Serialize;

use crate::error::Checked;
use crate::surface::io::prepare::MapGrid;

pub use parameters::Parameters;

/// What is said of the roughness of a map. Lengths are in the unit of the heights.
#[derive(Debug, Clone, Serialize)]
pub struct Roughness {
    /// Numbers.
    #[serde(flatten)]
    pub parameters: Parameters,
    /// Lag along x and autocorrelation there, from 1 at lag 0.
    #[serde(skip)]
    pub acf_x: Vec<[f64; 2]>,
    /// The same along y.
    #[serde(skip)]
    pub acf_y: Vec<[f64; 2]>,
    /// Spatial frequency (one over a length) and areal power spectral density there (length^4), mean over all azimuths.
    #[serde(skip)]
    pub psd: Vec<[f64; 2]>,
}

impl Roughness {
    /// Of heights of mean zero, all finite.
    ///
    /// Errors: the transforms would take more memory than may be used.
    pub fn of(heights: &[f64], grid: &MapGrid) -> Checked<Self> {
        let acf = correlation::autocorrelation(heights, grid)?;
        let [sal, str_] = acf.decay_lengths();
        let parameters = Parameters::of(heights, grid, sal, str_);
        Ok(Roughness {
            parameters,
            acf_x: acf.along(0),
            acf_y: acf.along(1),
            psd: spectrum::radial(heights, grid)?,
        })
    }
}
