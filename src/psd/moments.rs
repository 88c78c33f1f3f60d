//! What patches made from a power spectral density have in the mean over patches: sums over the waves that a periodic
//! grid holds, (i, j)/(cells pitch), each with the share S df^2 of the variance.

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;

use super::model::Psd;

/// Moments of patches of cells x cells cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PsdMoments {
    /// Root mean square height, um.
    pub rms_um: f64,
    /// Root mean square slope of the facets along one axis: differences of neighbouring heights over the pitch.
    pub facet_slope: f64,
    /// The same of the waves themselves, (2 pi f)^2 S summed.
    pub wave_slope: f64,
    /// Root mean square of the second differences along one axis over the pitch squared, 1/um.
    pub curvature_per_um: f64,
    /// Area of one independent height, um^2: the sum of (S df)^2 over the variance squared.
    pub correlation_area_um2: f64,
}

/// Sums over the waves of a line.
type Sums = [f64; 5];

impl PsdMoments {
    /// Of a density on cells of a pitch; all 0 where no wave of the patch lies between its frequencies.
    ///
    /// The same bytes for any number of threads.
    // Tested by `patches_have_the_moments_of_their_psd` (tests/it/surface/psd.rs).
    pub fn of(psd: &Psd, cells: u32, pitch_um: f64) -> Self {
        let n = f64::from(cells);
        let side = n * pitch_um;
        let density = psd.on(pitch_um);
        // A wave, its mirror images and the same with x and y exchanged have one density.
        let images = |i: u32| if i == 0 || 2 * i == cells { 1.0 } else { 2.0 };
        let versine = |i: u32| 4.0 * (PI * f64::from(i) / n).sin().powi(2);
        let wave = |i: u32| (TAU * f64::from(i) / n).powi(2);
        let line = |i: u32| {
            let mut sums = Sums::default();
            for j in 0..=i {
                let s = density(f64::from(i).hypot(f64::from(j)) / side);
                let weight = images(i) * images(j) * if i == j { 1.0 } else { 2.0 };
                // Half: the mean of both axes.
                let along = |of: &dyn Fn(u32) -> f64| 0.5 * (of(i) + of(j));
                let second = |i: u32| versine(i).powi(2);
                let terms = [1.0, along(&versine), along(&wave), along(&second), s];
                sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += weight * s * term);
            }
            sums
        };
        // Line by line, then in their order: the sum does not depend on threads.
        let lines: Vec<Sums> = (1..=cells / 2).into_par_iter().map(line).collect();
        let sums = lines.iter().fold(Sums::default(), |mut sums, line| {
            sums.iter_mut().zip(line).for_each(|(sum, part)| *sum += part);
            sums
        });
        let step2 = 1.0 / (side * side);
        let [variance, facets, waves, second, squares] = sums.map(|sum| sum * step2);
        if variance <= 0.0 {
            return PsdMoments {
                rms_um: 0.0,
                facet_slope: 0.0,
                wave_slope: 0.0,
                curvature_per_um: 0.0,
                correlation_area_um2: 0.0,
            };
        }
        PsdMoments {
            rms_um: variance.sqrt(),
            facet_slope: facets.sqrt() / pitch_um,
            wave_slope: waves.sqrt() / pitch_um,
            curvature_per_um: second.sqrt() / (pitch_um * pitch_um),
            correlation_area_um2: squares / (variance * variance),
        }
    }

    /// Correlation length of heights of covariance exp(-(r/L)^2) with as large an area of one independent height, um:
    /// pi L^2/2.
    pub fn correlation_um(&self) -> f64 {
        (2.0 * self.correlation_area_um2 / PI).sqrt()
    }
}
