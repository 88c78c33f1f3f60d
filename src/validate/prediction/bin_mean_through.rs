//! Means of the analytic BTDF over sensor bins below the horizon.
//!
//! Input: a microfacet model, the light and regions below the horizon, the index beyond over the index here. Output: per
//! region and masking the mean of f_t, weighted with |cos(theta_r)|.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use rayon::prelude::*;

use super::bin_mean::{BinMeans, Estimate, MASKINGS, MAX_RECTANGLES, hemisphere};
use super::chart::{DirectionChart, FluxDensity, integrate_region};
use super::quadrature::{AT_KINKS, COMPONENTS, Components, Integral, Precision};
use crate::instrument::Region;
use crate::theory::transmission::{g2_opposite, normal_sum};
use crate::theory::{ArmSide, Masking, Microfacet};

/// The means over one bin below, in the order of `BinMeans::maskings`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ThroughMean {
    /// 1/sr.
    pub values: [f64; MASKINGS],
    /// Largest disagreement of the two orders of the cubature among them, 1/sr.
    pub error: f64,
}

impl BinMeans {
    /// The means of light that goes through, over `regions` below the horizon (stage's frame) under light from `source`.
    ///
    /// - `eta`: index beyond over index here, > 0 and not 1. Not for the maskings of grains. The rest as `evaluate`.
    /// - Numerics: 1 - F and the cosine at the facet vanish where facets end, so the integrand has a kink in its second
    ///   derivative there; where the normals end at the horizon it jumps, and bins are cut.
    ///   Measured at the default precision: 5e-8 of the bin at worst.
    // Tested by `means_below_match_mpmath` (tests/it/transmission_values.rs).
    pub fn evaluate_through(
        &self,
        model: &Microfacet,
        source: &[(DVec3, f64)],
        regions: &[Region],
        eta: f64,
    ) -> Vec<ThroughMean> {
        regions.par_iter().map(|region| self.through(model, source, region, eta)).collect()
    }

    fn through(&self, model: &Microfacet, source: &[(DVec3, f64)], region: &Region, eta: f64) -> ThroughMean {
        debug_assert!(region.is_below());
        let mut mean = ThroughMean::default();
        for &(wi, weight) in source {
            let lit = LitThrough::new(model, wi, &self.maskings, eta);
            let (value, error, size) = match *region {
                Region::Cap { axis, half_angle: 0.0 } => {
                    (lit.densities(model.to_sample(axis)), 0.0, axis.z.abs())
                }
                _ => {
                    let found = self.flux_through(&lit, region);
                    (found.value, found.error.into_iter().fold(0.0, f64::max), region.projected_solid_angle())
                }
            };
            for (sum, value) in mean.values.iter_mut().zip(value) {
                *sum += weight * value / size;
            }
            mean.error += weight * error / size;
        }
        mean
    }

    fn flux_through(&self, lit: &LitThrough, region: &Region) -> Integral {
        let relative = [AT_KINKS * self.relative; COMPONENTS];
        let precision = Precision { relative, absolute: self.absolute, max_rectangles: MAX_RECTANGLES };
        let chart = DirectionChart::of_region(lit.model, lit.wi, region, lit.end_of_normals());
        integrate_region(lit, &chart, &precision)
    }
}

/// Directional transmittance of the single-scattering model: the integral of f_t |cos(theta_r)| below the horizon.
///
/// - `wi`: unit vector, stage's frame, wi.z > 0; `eta` and `masking` as `evaluate_through`.
/// - Returns a share of the incident flux; with Smith's maskings its sum with `albedo` is at most 1.
/// - Numerics: the two orders agree to 1e-8: a tenth of what `albedo` asks for with a reflectance, for its kinks.
// Tested by `faint_interfaces_let_all_through_that_is_not_masked` (tests/it/validate/transmittance.rs).
pub fn transmittance(model: &Microfacet, wi: DVec3, masking: Masking, eta: f64) -> Estimate {
    let means = BinMeans::of_a_hemisphere(masking, 1e-7);
    let (region, times) = hemisphere(model, wi, [FRAC_PI_2, PI]);
    means.flux_through(&LitThrough::new(model, wi, &means.maskings, eta), &region).estimate(0, times)
}

/// The model under light from one direction, all in the sample's frame.
struct LitThrough<'a> {
    model: &'a Microfacet,
    maskings: &'a [Masking],
    wi: DVec3,
    side: ArmSide,
    eta: f64,
    /// 1/(width of the lobe in H.x), and of H.y.
    scale: [f64; 2],
}

impl<'a> LitThrough<'a> {
    fn new(model: &'a Microfacet, wi: DVec3, maskings: &'a [Masking], eta: f64) -> Self {
        let wi = model.to_sample(wi);
        LitThrough { model, maskings, wi, side: model.side(wi), eta, scale: scale(model, wi.z, eta) }
    }

    /// The polar angle beyond which (eta > 1: between the horizon and which) a facet would have to face down:
    /// H.z = 0, |cos_o| = cos_i/eta.
    fn end_of_normals(&self) -> Option<f64> {
        let cos = self.wi.z / self.eta;
        (cos < 1.0).then(|| (-cos).acos())
    }
}

/// How many widths of the lobe a unit of H = -(wi + eta wo) holds along x and y.
///
/// H.xy is linear in wo, and 0 where the facet lies flat; there H.z = |eta^2 - 1|/(cos_i + g), g = eta |cos_o|. D varies
/// over alpha H.z of it, the length of H over |cos_o| H.z, since H.z itself falls by tan(theta_o) of what is added to H
/// along the light's azimuth. Where total reflection leaves no such direction, g^2 < 0, its size stands for it.
fn scale(model: &Microfacet, cos_i: f64, eta: f64) -> [f64; 2] {
    let m = (eta - 1.0) * (eta + 1.0);
    let g2 = m + cos_i * cos_i;
    let height = m.abs() / (cos_i + g2.abs().sqrt());
    // Near the horizon the polar angle, and not its cosine, is what varies.
    let cos_o = (g2.max(0.0).sqrt() / eta).max(height);
    [model.alpha_x, model.alpha_y].map(|alpha| (1.0 / alpha).hypot(1.0 / cos_o) / height)
}

impl FluxDensity for LitThrough<'_> {
    fn densities(&self, wo: DVec3) -> Components {
        let mut values = [0.0; COMPONENTS];
        if let Some((flux, o)) = self.model.transmitted(&self.side, self.wi, wo, self.eta) {
            for (value, &masking) in values.iter_mut().zip(self.maskings) {
                *value = flux * g2_opposite(masking, &self.side, &o);
            }
        }
        values
    }

    /// Linear in wo, so it is defined also where no facet exists, and the refinement finds the lobe from there.
    fn feature(&self, wo: DVec3) -> [f64; 2] {
        let h = normal_sum(self.wi, wo, self.eta);
        [h.x * self.scale[0], h.y * self.scale[1]]
    }
}
