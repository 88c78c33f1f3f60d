//! Models of matt surfaces that know no masking: Lambert's and Oren and Nayar's, over the bins of one incidence.

use glam::DVec3;
use rayon::prelude::*;

use super::bin_mean::MAX_RECTANGLES;
use super::chart::{DirectionChart, FluxDensity, integrate_region};
use super::quadrature::{COMPONENTS, Components, Precision};
use crate::instrument::Region;
use crate::theory::Microfacet;
use crate::theory::empirical::{LAMBERT, oren_nayar, oren_nayar_full};

/// A model of the whole surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DiffuseModel {
    /// The surface is flat.
    Lambert,
    /// Oren and Nayar's qualitative model.
    OrenNayar,
    /// Oren and Nayar's full model of light reflected once.
    OrenNayarFull,
}

impl DiffuseModel {
    /// All, in the order of the comparisons.
    pub const ALL: [DiffuseModel; 3] =
        [DiffuseModel::Lambert, DiffuseModel::OrenNayar, DiffuseModel::OrenNayarFull];

    /// The name in comparisons.
    pub fn name(self) -> &'static str {
        match self {
            DiffuseModel::Lambert => "lambert",
            DiffuseModel::OrenNayar => "oren_nayar",
            DiffuseModel::OrenNayarFull => "oren_nayar_full",
        }
    }

    /// The value for an albedo of 1, 1/sr; `sigma`: rms slope along any direction.
    fn value(self, wi: DVec3, wo: DVec3, sigma: f64) -> f64 {
        match self {
            DiffuseModel::Lambert => LAMBERT,
            DiffuseModel::OrenNayar => oren_nayar(wi, wo, sigma),
            DiffuseModel::OrenNayarFull => oren_nayar_full(wi, wo, sigma),
        }
    }
}

/// The means over `regions` (stage's frame, above the horizon) for an albedo of 1, 1/sr: \[bin\]\[formula\].
///
/// - `surface`: isotropic, Gaussian slopes; its alpha is sqrt(2) sigma.
/// - Numerics: 1e-6 of the bin.
// Tested by `oren_nayars_means_are_those_of_midpoints`.
pub(super) fn formula_means(
    surface: &Microfacet,
    source: &[(DVec3, f64)],
    regions: &[Region],
) -> Vec<[f64; DiffuseModel::ALL.len()]> {
    let sigma = surface.alpha_x / 2f64.sqrt();
    let precision = Precision { relative: [1e-6; COMPONENTS], absolute: 0.0, max_rectangles: MAX_RECTANGLES };
    let mean = |region: &Region| {
        let mut mean = [0.0; DiffuseModel::ALL.len()];
        for &(wi, weight) in source {
            let density = Lit { wi, sigma };
            let (flux, size) = match *region {
                Region::Cap { axis, half_angle: 0.0 } => (density.densities(axis), axis.z),
                _ => {
                    // Every azimuth is alike: the stage's frame will do.
                    let flat = Microfacet { rotation: 0.0, ..*surface };
                    let chart = DirectionChart::of_region(&flat, wi, region, Some(crate::sphere::theta(wi)));
                    (integrate_region(&density, &chart, &precision).value, region.projected_solid_angle())
                }
            };
            mean.iter_mut().zip(flux).for_each(|(sum, flux)| *sum += weight * flux / size);
        }
        mean
    };
    regions.par_iter().map(mean).collect()
}

/// A surface under light from `wi`.
struct Lit {
    wi: DVec3,
    sigma: f64,
}

impl FluxDensity for Lit {
    fn densities(&self, wo: DVec3) -> Components {
        let mut values = [0.0; COMPONENTS];
        for (value, formula) in values.iter_mut().zip(DiffuseModel::ALL) {
            *value = formula.value(self.wi, wo, self.sigma) * wo.z;
        }
        values
    }

    /// Nothing is narrow.
    fn feature(&self, _: DVec3) -> [f64; 2] {
        [0.0, 0.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::{direction, direction_deg};
    use crate::theory::Ndf;

    #[test]
    fn oren_nayars_means_are_those_of_midpoints() {
        let surface = Microfacet::isotropic(Ndf::Beckmann, 0.5);
        let wi = direction_deg(55.0, 10.0);
        for (theta, phi) in [([0.9, 1.05], [0.1, 0.3]), ([0.4, 0.5], [1.5, 1.9]), ([1.2, 1.3], [3.0, 3.2])] {
            let found = formula_means(&surface, &[(wi, 1.0)], &[Region::Rectangle { theta, phi }])[0];
            let (n, mut sums, mut size) = (400, [0.0; 3], 0.0);
            for i in 0..n {
                for j in 0..n {
                    let at = |[a, b]: [f64; 2], k: i32| a + (b - a) * (f64::from(k) + 0.5) / f64::from(n);
                    let wo = direction(at(theta, i), at(phi, j));
                    let weight = wo.z * at(theta, i).sin();
                    size += weight;
                    for (sum, formula) in sums.iter_mut().zip(DiffuseModel::ALL) {
                        *sum += weight * formula.value(wi, wo, 0.5 / 2f64.sqrt());
                    }
                }
            }
            for (found, sum) in found.iter().zip(sums) {
                // Midpoints: second order in 1/400 of the bin, also at kinks.
                assert!((found * size / sum - 1.0).abs() < 1e-5, "{theta:?}: {found} {}", sum / size);
            }
        }
    }
}
