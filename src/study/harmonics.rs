//! The test of isotropy: harmonics of the half vector's azimuth over a whole turn, realisation by realisation.
//!
//! For every realisation z_m = sum over incidences and bins of f w K_m(r) exp(-i m phi_h)/norm, with phi_h the azimuth and r
//! the slope (in medians) of the bin's half vector, K_m = (r^2/(1 + r^2))^(m/2): for m = 2 that is the score of a GGX law
//! that is stretched. Where no azimuth is preferred, f depends on the bin and theta_i alone, and the evenly spaced turns
//! make E z_m = 0 exactly, whatever the BRDF, the masking or the bins. Realisations are independent, sums over thousands
//! of facets nearly normal: Hotelling's T^2 of (Re z, Im z) has its F distribution, and needs no model of the noise.

use serde::Serialize;

use crate::fit::FitData;
use crate::fit::pilot::{Pilot, pilot};
use crate::theory::transmission::half_vector;

/// Orders that are looked at: a tilt or blaze shows in 1 and 3, a brush in 2, crossed brushes in 4.
const ORDERS: [u32; 4] = [1, 2, 3, 4];
/// The order that a square grid of facets has of itself: 0.4 % of it on patches with a correlation length of 8 cells.
const OF_THE_GRID: u32 = 4;

/// One harmonic of the azimuth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AzimuthHarmonic {
    /// m: how often it repeats over a turn.
    pub order: u32,
    /// |mean z|: 0 for an isotropic law, but for noise.
    pub amplitude: f64,
    /// Root mean square of the standard errors of Re z and Im z.
    pub amplitude_se: Option<f64>,
    /// Azimuth of its first crest, deg, stage's frame.
    pub phase_deg: f64,
    /// Hotelling's test of z = 0; null with fewer than four realisations.
    pub p_value: Option<f64>,
    /// Whether the verdict counts it: the fourth order of random patches belongs to their grid, not to their law.
    pub counts: bool,
}

/// All harmonics of a measured turn; `on_a_grid` says that the surface is random heights on a square grid.
pub(super) fn harmonics(data: &FitData, on_a_grid: bool) -> Vec<AzimuthHarmonic> {
    let guess = pilot(data);
    let of = |&order: &u32| AzimuthHarmonic {
        counts: !(on_a_grid && order == OF_THE_GRID),
        ..harmonic(data, &guess, order)
    };
    ORDERS.iter().map(of).collect()
}

fn harmonic(data: &FitData, guess: &Pilot, order: u32) -> AzimuthHarmonic {
    let kernel = kernel(data, guess, order);
    let entries =
        || (0..data.size.len()).flat_map(|entry| (0..data.value.len()).map(move |colour| (entry, colour)));
    let strength = |k: [f64; 2]| k[0].hypot(k[1]);
    let norm: f64 =
        entries().map(|(entry, colour)| data.value[colour][entry] * strength(kernel[entry])).sum();
    let sum = |part: &Vec<Vec<f64>>| {
        entries().fold([0.0; 2], |sum, (entry, colour)| {
            let share = if norm > 0.0 { part[colour][entry] / norm } else { 0.0 };
            [sum[0] + share * kernel[entry][0], sum[1] + share * kernel[entry][1]]
        })
    };
    let all: Vec<[f64; 2]> = data.parts.iter().map(sum).collect();
    let count = all.len() as f64;
    let mean = [0, 1].map(|k| all.iter().map(|z| z[k]).sum::<f64>() / count);
    let scatter: f64 = all.iter().map(|z| (z[0] - mean[0]).powi(2) + (z[1] - mean[1]).powi(2)).sum();
    let phase = -mean[1].atan2(mean[0]) / f64::from(order);
    AzimuthHarmonic {
        order,
        amplitude: mean[0].hypot(mean[1]),
        amplitude_se: (all.len() > 1).then(|| (0.5 * scatter / (count * (count - 1.0))).sqrt()),
        phase_deg: phase.to_degrees().rem_euclid(360.0 / f64::from(order)),
        p_value: hotelling_p(&all),
        counts: true,
    }
}

/// w K_m(r) (cos m phi_h, -sin m phi_h) of every entry, the half vector taken at the bin's centre; 0 where no facet sends
/// light.
fn kernel(data: &FitData, guess: &Pilot, order: u32) -> Vec<[f64; 2]> {
    let (grid, median, eta) = (&data.grid, guess.log_alpha.exp(), guess.eta(data));
    let mut kernel = Vec::with_capacity(data.size.len());
    for incidence in 0..grid.incidences() {
        let wi = grid.wi(incidence);
        for region in grid.regions(incidence) {
            let h = half_vector(wi, region.middle(), eta);
            if h.z <= 0.0 {
                kernel.push([0.0; 2]);
                continue;
            }
            let (x, y) = (h.x / (median * h.z), h.y / (median * h.z));
            let r2 = x * x + y * y;
            let strength = data.size[kernel.len()] * (r2 / (1.0 + r2)).powf(0.5 * f64::from(order));
            let (sin, cos) = (f64::from(order) * y.atan2(x)).sin_cos();
            kernel.push([strength * cos, -strength * sin]);
        }
    }
    kernel
}

/// Probability that the mean of independent, equally distributed normal pairs lies as far from 0 as this one does.
///
/// T^2 = R zbar' S^-1 zbar, and (R - 2) T^2/(2 (R - 1)) follows F(2, R - 2), whose upper tail is
/// (1 + T^2/(R - 1))^(-(R - 2)/2). Source: Hotelling 1931.
///
/// - `None` for fewer than four pairs. Pairs without scatter: 0 if they differ from 0, else 1.
// Tested by `the_level_of_the_test_is_exact` and those of tests/it/study.rs.
pub fn hotelling_p(pairs: &[[f64; 2]]) -> Option<f64> {
    let count = pairs.len() as f64;
    if pairs.len() < 4 {
        return None;
    }
    let mean = [0, 1].map(|k| pairs.iter().map(|z| z[k]).sum::<f64>() / count);
    let moment = |i: usize, j: usize| {
        pairs.iter().map(|z| (z[i] - mean[i]) * (z[j] - mean[j])).sum::<f64>() / (count - 1.0)
    };
    let (xx, xy, yy) = (moment(0, 0), moment(0, 1), moment(1, 1));
    let determinant = xx * yy - xy * xy;
    if determinant.is_nan() || determinant <= 0.0 {
        return Some(if mean == [0.0, 0.0] { 1.0 } else { 0.0 });
    }
    let [x, y] = mean;
    let t2 = count * (yy * x * x - 2.0 * xy * x * y + xx * y * y) / determinant;
    Some((-0.5 * (count - 2.0) * (t2 / (count - 1.0)).ln_1p()).exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{self, Purpose, StreamId};

    #[test]
    fn the_level_of_the_test_is_exact() {
        let id = StreamId { seed: 3, purpose: Purpose::Test, realisation: 0, incidence: 0, block: 0 };
        let mut stream = rng::stream(id);
        for count in [4, 8, 16] {
            let trials = 40_000;
            let mut rejected = [0u32; 2];
            for _ in 0..trials {
                let pairs: Vec<[f64; 2]> = (0..count)
                    .map(|_| {
                        let (u, v) = (1.0 - rng::uniform(&mut stream), rng::uniform(&mut stream));
                        let r = (-2.0 * u.ln()).sqrt();
                        let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
                        // Unequal and correlated: the test does not depend on it.
                        [r * cos, 0.3 * r * cos + 5.0 * r * sin]
                    })
                    .collect();
                let p = hotelling_p(&pairs).expect("enough");
                rejected[0] += u32::from(p < 0.01);
                rejected[1] += u32::from(p < 0.2);
            }
            for (rejected, level) in rejected.into_iter().zip([0.01, 0.2]) {
                // Binomial: four standard errors.
                let share = f64::from(rejected) / f64::from(trials);
                let tolerance = 4.0 * (level * (1.0 - level) / f64::from(trials)).sqrt();
                assert!((share - level).abs() < tolerance, "{count}: {share} at {level}");
            }
        }
    }
}
