//! A matt base under a smooth clear interface, as of lacquer, plastic and glaze: what one facet of it does to light.
//!
//! Of light that falls on it F is mirrored. The rest is scattered by the base (Lambert's law, albedo rho); of what comes up
//! the interface sends F_di back down, so that rho (1 - F_di)/(1 - rho F_di) of what has gone in leaves. By Snell's law it does so
//! in proportion to (1 - F(w)) cos(w). The facet's own BRDF, beside the mirror direction, is
//! rho (1 - F_i)(1 - F_o)/(pi eta^2 (1 - rho F_di)).
//! Input: the index of the interface, directions, uniform numbers. Output: shares of the light, a direction.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use super::facet::lambert_direction;
use super::fresnel::FacetAngle;
use super::fresnel::dielectric::{f_dielectric, t_dielectric};

/// The reflectance of the interface under diffuse light from outside: F_de, the integral of 2 c F(c) dc.
///
/// With sqrt(eta^2 - 1) sinh t in place of c all is analytic; the trapezoid rule of 81 points in s, where t goes with
/// tanh(pi/2 sinh s) from one end to the other (Takahasi and Mori 1974).
///
/// - `eta`: index of the inside over the outside, (1, 4].
/// - Numerics: sums of positive terms; relative error below 1e-13.
// Tested by `diffuse_reflectances_meet_mpmath` (tests/it/facets/layered_values.rs).
pub fn diffuse_reflectance_outside(eta: f64) -> f64 {
    const STEP: f64 = 0.08;
    let m = (eta - 1.0) * (eta + 1.0);
    let end = (1.0 / m.sqrt()).asinh();
    let at = |k: i32| {
        let s = STEP * f64::from(k);
        let x = FRAC_PI_2 * s.sinh();
        // (1 + tanh x)/2, and what a step of s adds to it.
        let (share, slope) =
            (1.0 / (1.0 + (-2.0 * x).exp()), FRAC_PI_2 * s.cosh() / (2.0 * x.cosh().powi(2)));
        let t = end * share;
        let cos = (m.sqrt() * t.sinh()).min(1.0);
        let angle = FacetAngle { cos, sin2: (1.0 - cos) * (1.0 + cos) };
        end * slope * m * (2.0 * t).sinh() * f_dielectric(angle, eta).mean()
    };
    STEP * (-40..=40).map(at).sum::<f64>()
}

/// The same from inside: F_di = (eta^2 - 1 + F_de)/eta^2, since as much of the light that fills a half-sphere goes through
/// either way.
// Tested by `diffuse_reflectances_meet_mpmath` (tests/it/facets/layered_values.rs).
pub fn diffuse_reflectance_inside(eta: f64) -> f64 {
    ((eta - 1.0) * (eta + 1.0) + diffuse_reflectance_outside(eta)) / (eta * eta)
}

/// The share of the light that has gone in which leaves again: rho (1 - F_di)/(1 - rho F_di), all reflections between base and
/// interface together; [0, 1], and 1 for a base of albedo 1.
pub fn base_reflectance(albedo: f64, eta: f64) -> f64 {
    let inside = diffuse_reflectance_inside(eta);
    // 1 - rho F as a sum of positive terms.
    albedo * (1.0 - inside) / ((1.0 - albedo) + albedo * (1.0 - inside))
}

/// 1 - F of a direction whose cosine at the facet is `cos`; 0 below it.
pub fn transmittance(cos: f64, eta: f64) -> f64 {
    if cos <= 0.0 {
        return 0.0;
    }
    let cos = cos.min(1.0);
    t_dielectric(FacetAngle { cos, sin2: (1.0 - cos) * (1.0 + cos) }, eta)
}

/// A direction about `normal` (of any length) in which light from the base leaves, in proportion to (1 - F(w)) cos(w): of
/// directions by Lambert's law outside each is taken with the probability 1 - F, three numbers from `uniform` a try.
// Tested by `light_from_the_base_leaves_by_fresnels_equations` (tests/it/facets/layered_values.rs).
pub fn leaving_direction(normal: DVec3, eta: f64, mut uniform: impl FnMut() -> f64) -> DVec3 {
    let n = normal.normalize();
    loop {
        let (u, v) = (uniform(), uniform());
        let w = lambert_direction(n, u, v);
        // Light along the facet is never taken: most tries end at once, and 3 of 5 do at eta = 4.
        if uniform() < transmittance(w.dot(n), eta) {
            return w;
        }
    }
}

/// What an interface does to the light of the base below it, beside the albedo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interface {
    /// Index of the inside over the outside, (1, 4].
    pub eta: f64,
    /// 1/(1 - F_de).
    gain: f64,
}

impl Interface {
    /// Of an index.
    pub fn new(eta: f64) -> Self {
        Interface { eta, gain: 1.0 / (1.0 - diffuse_reflectance_outside(eta)) }
    }

    /// (1 - F_i)(1 - F_o)/(1 - F_de), which times base_reflectance/pi is the facet's own BRDF without its mirror term:
    /// eta^2 (1 - F_di) = 1 - F_de.
    // Tested by `reference_values_of_layered_facets_are_met` (tests/it/facets/layered_values.rs).
    pub fn weight(&self, cos_i: f64, cos_o: f64) -> f64 {
        transmittance(cos_i, self.eta) * transmittance(cos_o, self.eta) * self.gain
    }
}
