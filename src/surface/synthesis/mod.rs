//! Random canonical patches (alpha = 1, unit cells, periodic) with a wanted slope law.
//!
//! Input: a law, a size, a stream. Output: heights, each an f32 value so that a file holds the very patch.
//!
//! Beckmann is a Gaussian field whose facet slopes have variance 1/2 per axis in the mean over patches. No spectrum
//! makes a Gaussian field GGX, so GGX and Student's laws are found by iteration: give every facet a slope of the
//! wanted length while keeping slope and height independent (what Smith's masking assumes), then find the heights
//! whose differences fit best. Scaling x, y, z is affine: one patch serves every alpha_x, alpha_y.

mod facets;
mod feedback;
mod harmonics;
mod height_ranks;
mod length_ranks;
mod ranking;
mod remap;
pub mod slope_law;
mod spectrum;
mod targets;

use rand_pcg::Pcg64Dxsm;

use super::heightfield::Heightfield;
use crate::campaign::HeightSpectrum;
use crate::lanes::Kernel;
use crate::psd::Psd;
use crate::rng;
use feedback::Feedback;
use remap::Remap;
use slope_law::SlopeLaw;
use spectrum::{Filter, Spectra, SquareFft};

/// Rounds of slope and height remapping: the slope law stops improving after about 14.
const ROUNDS: usize = 14;
/// The round from which the remapping learns what the fit does to its targets.
const LEARNING: usize = 9;

/// Makes patches of one law and size; holds the plans and tables that they share.
pub struct Synthesiser {
    law: SlopeLaw,
    cells: usize,
    correlation: f64,
    fft: SquareFft,
    gaussian: Filter,
    fit: Filter,
    remap: Remap,
}

impl Synthesiser {
    /// Plans patches of `cells` x `cells` with heights correlated over about `correlation` cells.
    pub fn new(law: SlopeLaw, cells: usize, correlation: f64) -> Self {
        Self::with_spectrum(law, cells, correlation, HeightSpectrum::Gaussian)
    }

    /// The same from a Gaussian field of another spectrum. Only the Beckmann law leaves the field as it is.
    pub fn with_spectrum(law: SlopeLaw, cells: usize, correlation: f64, spectrum: HeightSpectrum) -> Self {
        Self::with_power(law, cells, correlation, |k2| power(spectrum, k2, correlation))
    }

    /// Root mean square of the heights of a Gaussian field, and of their second differences along an axis, in the mean over
    /// patches.
    pub fn gaussian_moments(cells: usize, correlation: f64, spectrum: HeightSpectrum) -> [f64; 2] {
        let fft = SquareFft::new(cells);
        let field = GaussianField::new(&fft, |k2| power(spectrum, k2, correlation));
        // Along x and along y alike.
        let second = |k: f64| (2.0 * (0.5 * k).sin()).powi(4);
        let moments: [&dyn Fn(f64) -> f64; 2] = [&|_| 1.0, &second];
        let modes = (cells * cells) as f64;
        moments
            .map(|of| (fft.sum_over_modes(|kx, ky| field.amplitude(kx, ky).powi(2) * of(kx)) / modes).sqrt())
    }

    /// Gaussian heights of a power spectral density on cells of `pitch_um`, in units of their own roughness: a height of 1
    /// is alpha times the pitch.
    // Tested by `patches_have_the_moments_of_their_psd` (tests/it/surface/psd.rs).
    pub fn with_psd(psd: &Psd, pitch_um: f64, cells: usize) -> Self {
        let density = psd.on(pitch_um);
        let unit = std::f64::consts::TAU * pitch_um;
        Self::with_power(SlopeLaw::Beckmann, cells, 1.0, |k2| density(k2.sqrt() / unit))
    }

    /// From a Gaussian field of `power(k2)` at the squared wave number k2 > 0, (rad per cell)^2, in any unit.
    fn with_power(law: SlopeLaw, cells: usize, correlation: f64, power: impl Fn(f64) -> f64) -> Self {
        let fft = SquareFft::new(cells);
        let field = GaussianField::new(&fft, power);
        let gaussian = fft.filter(|kx, ky| field.amplitude(kx, ky));
        let fit = fft.filter(|kx, ky| fit_gain(correlation, kx, ky));
        Synthesiser {
            law,
            cells,
            correlation,
            fft,
            gaussian,
            fit,
            remap: Remap::new(law, cells, Kernel::widest()),
        }
    }

    /// One patch. All randomness comes from `rng`.
    pub fn patch(&self, rng: &mut Pcg64Dxsm) -> Heightfield {
        let mut room = self.fft.spectra();
        let mut heights = white_noise(self.cells * self.cells, rng);
        self.fft.apply(&self.gaussian, &mut heights, &mut room);
        if self.law != SlopeLaw::Beckmann {
            self.remap_to_law(&mut heights, &mut room);
        }
        Heightfield::new(self.cells, self.cells, true, heights.into_iter().map(f64::from).collect())
    }

    /// Rounds of remapped slopes, and of the heights whose differences fit them best.
    fn remap_to_law(&self, heights: &mut [f32], room: &mut Spectra) {
        let mut feedback = Feedback::new(self.correlation);
        for round in 0..ROUNDS {
            if round > 0 {
                self.remap.heights_half_way(heights);
            }
            let ranking = self.remap.ranking(heights);
            if round == 0 {
                self.remap.observe(heights, &ranking, &mut feedback);
            }
            self.remap.divergence_of_targets(heights, &ranking, &feedback);
            self.fft.apply(&self.fit, heights, room);
            if (LEARNING..ROUNDS - 1).contains(&round) {
                let ranking = self.remap.ranking(heights);
                self.remap.observe(heights, &ranking, &mut feedback);
            }
        }
    }
}

/// From the divergence of the wanted slopes to the heights whose differences fit them best: the Poisson equation
/// (2 cos kx + 2 cos ky - 4) h = divergence, with the longest waves damped so that the patch holds many bumps of the
/// correlation length instead of a few large ones.
fn fit_gain(correlation: f64, kx: f64, ky: f64) -> f64 {
    let k2 = kx * kx + ky * ky;
    let laplacian = 4.0 * ((0.5 * kx).sin().powi(2) + (0.5 * ky).sin().powi(2));
    let scaled = k2 * (correlation / 0.7).powi(2);
    if k2 == 0.0 { 0.0 } else { -(-scaled * scaled).exp_m1() / laplacian }
}

/// Correlation length, in cells, of what the exponential spectrum is smoothed with.
const INNER: f64 = 2.0;

/// Power at the squared wave number `k2` ((rad per cell)^2), not scaled.
///
/// Gaussian: exp(-(k L)^2/4). Exponential: (1 + (k L)^2)^(-3/2), smoothed below `INNER` cells, where facets end.
fn power(spectrum: HeightSpectrum, k2: f64, correlation: f64) -> f64 {
    let gaussian = |length: f64| (-0.25 * length * length * k2).exp();
    match spectrum {
        HeightSpectrum::Gaussian => gaussian(correlation),
        HeightSpectrum::Exponential => (1.0 + k2 * correlation * correlation).powf(-1.5) * gaussian(INNER),
    }
}

/// Amplitudes of a Gaussian field, scaled to a facet slope variance of 1/2 per axis.
///
/// On a grid split along one diagonal the two slopes of a facet share a corner, which correlates them by about
/// 1/(2 L^2): a preferred azimuth of the facets. The factor 1 - tilt sin(kx) sin(ky) on the power cancels it.
struct GaussianField<P> {
    power: P,
    tilt: f64,
    scale: f64,
}

impl<P: Fn(f64) -> f64> GaussianField<P> {
    fn new(fft: &SquareFft, power: P) -> Self {
        let power_at = |kx: f64, ky: f64| {
            if kx == 0.0 && ky == 0.0 { 0.0 } else { power(kx * kx + ky * ky) }
        };
        let versine = |k: f64| 2.0 * (0.5 * k).sin().powi(2);
        let shared = fft.sum_over_modes(|kx, ky| power_at(kx, ky) * versine(kx) * versine(ky));
        let mixed = fft.sum_over_modes(|kx, ky| power_at(kx, ky) * (kx.sin() * ky.sin()).powi(2));
        // Below 1.5 cells, where the smallest patches are, the whole of it would make powers negative.
        let tilt = (shared / mixed).min(1.0);
        let tilted = |kx: f64, ky: f64| power_at(kx, ky) * (1.0 - tilt * kx.sin() * ky.sin());
        // White noise of variance 1 has power 1 in each of the n^2 modes; the mean over them is the variance.
        let modes = fft.sum_over_modes(|_, _| 1.0);
        let slope_variance = fft.sum_over_modes(|kx, ky| tilted(kx, ky) * 2.0 * versine(kx)) / modes;
        GaussianField { power, tilt, scale: (0.5 / slope_variance).sqrt() }
    }

    fn amplitude(&self, kx: f64, ky: f64) -> f64 {
        if kx == 0.0 && ky == 0.0 {
            return 0.0;
        }
        let power = (self.power)(kx * kx + ky * ky);
        self.scale * (power * (1.0 - self.tilt * kx.sin() * ky.sin())).sqrt()
    }
}

/// Independent normal numbers of variance 1 (Box and Muller).
fn white_noise(count: usize, rng: &mut Pcg64Dxsm) -> Vec<f32> {
    let mut noise = Vec::with_capacity(count + 1);
    while noise.len() < count {
        // 1 - u lies in (0, 1]: the logarithm is finite.
        let radius = (-2.0 * (1.0 - rng::uniform(rng)).ln()).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * rng::uniform(rng)).sin_cos();
        noise.push((radius * cos) as f32);
        noise.push((radius * sin) as f32);
    }
    noise.truncate(count);
    noise
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, StreamId};

    const ID: StreamId = StreamId { seed: 1, purpose: Purpose::Test, realisation: 0, incidence: 0, block: 0 };

    #[test]
    fn every_kernel_makes_the_same_patch() {
        for law in [SlopeLaw::Ggx, SlopeLaw::student_t(4.0), SlopeLaw::Grains { coverage: 0.8 }] {
            // Rows that end within a vector, on the edge of one, and within a group of them.
            for cells in [17, 32, 56] {
                let of = |kernel| {
                    let mut synthesiser = Synthesiser::new(law, cells, 2.0);
                    synthesiser.remap = Remap::new(law, cells, kernel);
                    synthesiser.patch(&mut rng::stream(ID))
                };
                let expected = of(Kernel::Scalar);
                for kernel in Kernel::ALL.into_iter().filter(|kernel| kernel.available()) {
                    assert!(of(kernel) == expected, "{law:?}, {cells} cells, {}", kernel.name());
                }
            }
        }
    }

    #[test]
    fn the_smallest_patches_have_finite_heights() {
        for law in [SlopeLaw::Ggx, SlopeLaw::Beckmann, SlopeLaw::student_t(4.0)] {
            for cells in 8..=17 {
                // The only correlation that a campaign allows there.
                let patch = Synthesiser::new(law, cells, cells as f64 / 8.0).patch(&mut rng::stream(ID));
                let (low, high) = patch.range();
                assert!(
                    patch.heights().iter().all(|h| h.is_finite()) && low < high,
                    "{law:?}, {cells} cells"
                );
            }
        }
    }
}
