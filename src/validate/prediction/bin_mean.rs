//! Means of the analytic BRDF over sensor bins: what a table is compared with, bin mean against bin mean.
//!
//! Input: a microfacet model, the light (one direction, or nodes of its aperture) and the table's regions. Output:
//! per region and masking the mean, weighted with cos(theta_r), of D G2/(4 cos cos) ("unit", F = 1) and of the same
//! times (1 - c)^5 ("schlick"): Schlick's BRDF with any F0 is F0 unit + (1 - F0) schlick. Another reflectance may take
//! the place of (1 - c)^5: then the second mean is the BRDF itself.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec3;
use rayon::prelude::*;

use super::chart::{DirectionChart, FluxDensity, integrate_region, meridian_frame};
use super::critical::{critical_cosine, integrate_cut};
use super::quadrature::{AT_KINKS, COMPONENTS, Components, Integral, Precision};
use crate::instrument::Region;
use crate::optics::reflectance::Reflectance;
use crate::optics::{FacetAngle, Fresnel};
use crate::sphere;
use crate::theory::gauss_legendre::gauss_legendre;
use crate::theory::smith::visibility;
use crate::theory::{ArmSide, Masking, Microfacet};

/// Most maskings that one evaluation can carry.
pub const MASKINGS: usize = COMPONENTS / 2;

/// The means over one bin, in the order of `BinMeans::maskings`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BinMean {
    /// F = 1, 1/sr.
    pub unit: [f64; MASKINGS],
    /// Times (1 - c)^5, or the reflectance that was asked for, 1/sr.
    pub schlick: [f64; MASKINGS],
    /// Largest disagreement of the two orders of the cubature among the above, 1/sr.
    pub error: f64,
}

impl BinMean {
    /// The mean of Schlick's BRDF of the masking at `index`, 1/sr.
    pub fn with_f0(&self, index: usize, f0: f64) -> f64 {
        f0 * self.unit[index] + (1.0 - f0) * self.schlick[index]
    }
}

/// The analytic side of a comparison: which maskings, and how precisely.
#[derive(Debug, Clone, PartialEq)]
pub struct BinMeans {
    /// At most `MASKINGS` of them.
    pub maskings: Vec<Masking>,
    /// Of the bin's flux, for the maskings that are smooth. The direction-correlated one has kinks (max and min of the
    /// two Lambdas, the azimuth's absolute value), as those of grains have (facets that nothing hides), and keep to ten
    /// times as much.
    pub relative: f64,
    /// Share of the incidence's incident flux below which an error in one bin does not matter.
    pub absolute: f64,
    /// What the second mean is weighed by; `None`: (1 - c)^5.
    pub reflectance: Option<Reflectance>,
}

/// How much more the direction-correlated masking may be off.
const KINKED: f64 = 10.0;

/// Rectangles per bin and direction of light beyond which the cubature gives up (and `BinMean::error` tells).
pub(super) const MAX_RECTANGLES: usize = 200_000;

impl BinMeans {
    /// The given maskings at the default precision: the two orders agree to 1e-6 of the bin (1e-5 for the
    /// direction-correlated masking) or to 1e-9 of the incidence's flux. The integrals themselves are far closer.
    pub fn new(maskings: Vec<Masking>) -> Self {
        assert!(maskings.len() <= MASKINGS, "at most {MASKINGS} maskings at once");
        BinMeans { maskings, relative: 1e-6, absolute: 1e-9, reflectance: None }
    }

    /// One masking over all directions, to this part of their flux.
    pub(super) fn of_a_hemisphere(masking: Masking, relative: f64) -> Self {
        BinMeans { relative, absolute: 0.01 * relative, ..BinMeans::new(vec![masking]) }
    }

    /// The means over `regions` (stage's frame) under light from `source`: directions with weights that add up to 1.
    ///
    /// - Domain: sources and regions above the horizon. An aperture of half-angle 0 gets the value at its axis.
    /// - Returns one entry per region, the same bits for any number of threads.
    /// - Several source nodes stand for the aperture only if the bin or the lobe is wider than their distance.
    /// - Cost: 225 evaluations per rectangle; one rectangle per bin far from the lobe.
    // Tested by `bins_add_up_to_the_reference_albedo`, `a_lobe_of_a_ten_thousandth_is_found`.
    pub fn evaluate(&self, model: &Microfacet, source: &[(DVec3, f64)], regions: &[Region]) -> Vec<BinMean> {
        regions.par_iter().map(|region| self.mean(model, source, region)).collect()
    }

    fn mean(&self, model: &Microfacet, source: &[(DVec3, f64)], region: &Region) -> BinMean {
        let mut mean = BinMean::default();
        for &(wi, weight) in source {
            let lit = Lit::new(model, wi, self);
            let (value, error, size) = match *region {
                Region::Cap { axis, half_angle: 0.0 } => (lit.densities(model.to_sample(axis)), 0.0, axis.z),
                _ => {
                    let found = self.flux(&lit, model, region);
                    (found.value, found.error.into_iter().fold(0.0, f64::max), region.projected_solid_angle())
                }
            };
            for k in 0..self.maskings.len() {
                mean.unit[k] += weight * value[2 * k] / size;
                mean.schlick[k] += weight * value[2 * k + 1] / size;
            }
            mean.error += weight * error / size;
        }
        mean
    }

    fn flux(&self, lit: &Lit, model: &Microfacet, region: &Region) -> Integral {
        let mut relative = [self.relative; COMPONENTS];
        for (k, &masking) in self.maskings.iter().enumerate() {
            if matches!(masking, Masking::DirectionCorrelated | Masking::Grains | Masking::GrainsProduct) {
                relative[2 * k] *= KINKED;
                relative[2 * k + 1] *= KINKED;
            }
        }
        let precision = Precision { relative, absolute: self.absolute, max_rectangles: MAX_RECTANGLES };
        // In theta: theta_i of an isotropic sample, where the larger Lambda changes hands.
        let cut = model.is_isotropic().then(|| sphere::theta(lit.wi));
        let chart = DirectionChart::of_region(model, lit.wi, region, cut);
        match self.reflectance.map(|reflectance| reflectance.fresnel) {
            Some(Fresnel::Dielectric { eta }) if eta < 1.0 => {
                let relative = precision.relative.map(|relative| AT_KINKS * relative);
                let precision = Precision { relative, ..precision };
                integrate_cut(lit, &chart, (lit.wi, critical_cosine(eta)), &precision)
            }
            _ => integrate_region(lit, &chart, &precision),
        }
    }
}

/// An integral, and by how much two orders of its rule disagree: an upper estimate of its error for anything smooth.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Estimate {
    /// Of the higher order.
    pub value: f64,
    /// The disagreement, >= 0.
    pub error: f64,
}

impl Integral {
    /// One of the functions, so many times.
    pub(super) fn estimate(&self, component: usize, times: f64) -> Estimate {
        Estimate { value: times * self.value[component], error: times * self.error[component] }
    }
}

/// Directional albedos of the single-bounce model: the integrals over the hemisphere of f cos(theta_r) with F = 1, and
/// with (1 - c)^5 or the `reflectance` that is given.
///
/// - `wi`: unit vector, stage's frame, wi.z > 0. Returns numbers in [0, 1] (unless nothing is masked).
/// - Numerics: the two orders agree to 1e-8, with a `reflectance` to 1e-7; measured against the reference values in
///   `albedo_matches_the_reference`.
// Tested by `albedo_matches_the_reference` (tests/it/validate/bin_means.rs), `albedos_match_another_program`.
pub fn albedo(
    model: &Microfacet,
    wi: DVec3,
    masking: Masking,
    reflectance: Option<Reflectance>,
) -> [Estimate; 2] {
    let relative = if reflectance.is_some() { 1e-7 } else { 1e-8 };
    let means = BinMeans { reflectance, ..BinMeans::of_a_hemisphere(masking, relative) };
    let (region, times) = hemisphere(model, wi, [0.0, FRAC_PI_2]);
    let found = means.flux(&Lit::new(model, wi, &means), model, &region);
    [found.estimate(0, times), found.estimate(1, times)]
}

/// The directions between two polar angles: of an isotropic surface those on one side of the plane of incidence, which stand
/// for both.
pub(super) fn hemisphere(model: &Microfacet, wi: DVec3, theta: [f64; 2]) -> (Region, f64) {
    let (from, times) = if model.is_isotropic() { (sphere::phi(wi), 2.0) } else { (0.0, 1.0) };
    (Region::Rectangle { theta, phi: [from, from + TAU / times] }, times)
}

/// Directions with weights for light that fills the cone of `half_angle` about `axis` evenly in *projected* solid angle.
///
/// The density (w.z) sin psi dpsi deta in polar angles (psi, eta) about the axis becomes (w.z/cos psi) du deta with
/// u = sin^2 psi: Gauss-Legendre of `order` points in u, trapezoid of 2 order + 1 points in eta, the first in the
/// meridian of the axis.
///
/// - Domain: the cone stays above the horizon. A half-angle of 0 gives the axis alone.
/// - The weights add up to 1 (to rounding) and are positive.
// Tested by `source_nodes_integrate_the_cone` (tests/it/validate/bin_means.rs).
pub fn source_nodes(axis: DVec3, half_angle: f64, order: usize) -> Vec<(DVec3, f64)> {
    if half_angle == 0.0 {
        return vec![(axis, 1.0)];
    }
    let (down, across) = meridian_frame(axis);
    let around = 2 * order + 1;
    let mut nodes = Vec::with_capacity(order * around);
    for (u, weight) in gauss_legendre(order) {
        let sin_psi = u.sqrt() * half_angle.sin();
        let cos_psi = (1.0 - sin_psi * sin_psi).sqrt();
        for k in 0..around {
            let (sin, cos) = (TAU * k as f64 / around as f64).sin_cos();
            let w = axis * cos_psi + (down * cos + across * sin) * sin_psi;
            nodes.push((w, weight * w.z / (cos_psi * axis.z * around as f64)));
        }
    }
    nodes
}

/// The model under light from one direction, all in the sample's frame.
struct Lit<'a> {
    model: &'a Microfacet,
    maskings: &'a [Masking],
    reflectance: Option<Reflectance>,
    wi: DVec3,
    side: ArmSide,
}

impl<'a> Lit<'a> {
    fn new(model: &'a Microfacet, wi: DVec3, means: &'a BinMeans) -> Self {
        let wi = model.to_sample(wi);
        let BinMeans { maskings, reflectance, .. } = means;
        Lit { model, maskings, reflectance: *reflectance, wi, side: model.side(wi) }
    }
}

impl FluxDensity for Lit<'_> {
    /// D V cos(theta_r) of every masking, alone and times (1 - c)^5: outgoing flux per solid angle, 1/sr.
    fn densities(&self, wo: DVec3) -> Components {
        let (i, o) = (&self.side, self.model.side(wo));
        let d_cos = self.model.ndf.d_of_sum(self.wi + wo, self.model.alpha_x, self.model.alpha_y) * wo.z;
        let angle = FacetAngle::of_pair(self.wi, wo);
        let schlick =
            self.reflectance.map_or_else(|| angle.schlick_weight(), |reflectance| reflectance.at(angle));
        let mut values = [0.0; COMPONENTS];
        for (pair, &masking) in values.chunks_exact_mut(2).zip(self.maskings) {
            let unit = d_cos * visibility(masking, i, &o);
            pair.copy_from_slice(&[unit, unit * schlick]);
        }
        values
    }

    /// Slope of the half vector in units of alpha: D depends on its length alone.
    fn feature(&self, wo: DVec3) -> [f64; 2] {
        let h = self.wi + wo;
        [h.x / (self.model.alpha_x * h.z), h.y / (self.model.alpha_y * h.z)]
    }
}
