//! Means over sensor bins of the BRDF of matt facets, bare or under an interface.
//!
//! Input: a microfacet model, the light and regions above the horizon. Output: per region and masking the mean for facets of
//! albedo 1 (under an interface: without what that mirrors), weighted with cos(theta_r).

use std::f64::consts::FRAC_1_PI;
use std::sync::LazyLock;

use glam::DVec3;
use rayon::prelude::*;

use super::bin_mean::MASKINGS;
use super::chart::DirectionChart;
use super::quadrature::Rect;
use crate::instrument::Region;
use crate::optics::layered::Interface;
use crate::sphere;
use crate::theory::gauss_legendre::gauss_legendre;
use crate::theory::smith::visibility;
use crate::theory::{ArmSide, Masking, Microfacet};

/// Two rules on [0, 1] that must agree over a rectangle of directions.
static RULES: LazyLock<[Vec<(f64, f64)>; 2]> = LazyLock::new(|| [2, 3].map(gauss_legendre));

/// How well, of the whole bin; the higher one is far closer.
const AGREEMENT: f64 = 1e-5;

/// Halvings of a rectangle beyond which a kink is left as it is: a 1/4096 of the bin.
const DEEPEST: u32 = 12;

/// One number per masking.
type Values = [f64; MASKINGS];

/// The means over `regions` (stage's frame, above the horizon) under light from `source`, in the order of `maskings`, 1/sr.
///
/// - `maskings`: Smith's, at most `MASKINGS` of them. `interface`: what lies over each facet, if anything does.
/// - Numerics: the integrand is smooth (each facet shines everywhere): 2 x 2 and 3 x 3 points agree to 1e-5 of the bin, or
///   it is halved. Precision 1e-5 of the bin, most of it that of `facet_overlap`; a few times as
///   much where the direction-correlated masking has kinks.
/// - Cost: 13 integrals over facets for a rectangle, some 0.5 ms for GGX.
// Tested by `matt_bins_are_means_over_the_bin` (tests/it/diffuse_values.rs).
pub fn diffuse_means(
    model: &Microfacet,
    maskings: &[Masking],
    source: &[(DVec3, f64)],
    regions: &[Region],
    interface: Option<Interface>,
) -> Vec<Values> {
    let mean = |region: &Region| {
        let mut mean = [0.0; MASKINGS];
        for &(wi, weight) in source {
            let wi = model.to_sample(wi);
            let lit = LitDiffuse { model, maskings, wi, side: model.side(wi), interface };
            let (flux, size) = match *region {
                Region::Cap { axis, half_angle: 0.0 } => (lit.densities(model.to_sample(axis)), axis.z),
                _ => (lit.flux(region), region.projected_solid_angle()),
            };
            mean.iter_mut().zip(flux).for_each(|(sum, flux)| *sum += weight * flux / size);
        }
        mean
    };
    regions.par_iter().map(mean).collect()
}

/// Matt facets under light from one direction, all in the sample's frame.
struct LitDiffuse<'a> {
    model: &'a Microfacet,
    maskings: &'a [Masking],
    wi: DVec3,
    side: ArmSide,
    interface: Option<Interface>,
}

impl LitDiffuse<'_> {
    /// f cos(theta_r), 1/sr.
    fn densities(&self, wo: DVec3) -> Values {
        let o = self.model.side(wo);
        let overlap = match &self.interface {
            None => self.model.facet_overlap(self.wi, wo),
            Some(interface) => self.model.layered_overlap(self.wi, wo, interface),
        };
        let mut values = [0.0; MASKINGS];
        for (value, &masking) in values.iter_mut().zip(self.maskings) {
            *value = 4.0 * FRAC_1_PI * overlap * visibility(masking, &self.side, &o) * wo.z;
        }
        values
    }

    fn flux(&self, region: &Region) -> Values {
        // The larger Lambda of an isotropic sample changes hands at theta_i.
        let cut = self.model.is_isotropic().then(|| sphere::theta(self.wi));
        let (chart, rects) = DirectionChart::of_region(self.model, self.wi, region, cut);
        let [coarse, fine] = &*RULES;
        let over = |rect: Rect| (rect, self.over(&chart, rect, fine));
        let mut open: Vec<(Rect, Values, u32)> =
            rects.into_iter().map(over).map(|(rect, values)| (rect, values, 0)).collect();
        let whole = open.iter().fold([0.0; MASKINGS], |sum, (_, values, _)| added(sum, *values));
        let mut sum = [0.0; MASKINGS];
        while let Some((rect, values, depth)) = open.pop() {
            let check = self.over(&chart, rect, coarse);
            let agree = (0..MASKINGS).all(|k| (check[k] - values[k]).abs() <= AGREEMENT * whole[k]);
            if agree || depth == DEEPEST {
                sum = added(sum, values);
            } else {
                open.extend(rect.quarters().map(over).map(|(rect, values)| (rect, values, depth + 1)));
            }
        }
        sum
    }

    fn over(&self, chart: &DirectionChart, rect: Rect, rule: &[(f64, f64)]) -> Values {
        let (du, dv) = (rect.u[1] - rect.u[0], rect.v[1] - rect.v[0]);
        let mut sum = [0.0; MASKINGS];
        for &(x, weight_u) in rule {
            let u = (rect.u[0] + du * x).sin_cos();
            for &(y, weight_v) in rule {
                let (wo, area) = chart.at(u, (rect.v[0] + dv * y).sin_cos());
                let weight = du * dv * weight_u * weight_v * area;
                sum = added(sum, self.densities(wo).map(|value| weight * value));
            }
        }
        sum
    }
}

fn added(a: Values, b: Values) -> Values {
    std::array::from_fn(|k| a[k] + b[k])
}
