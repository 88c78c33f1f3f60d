//! The GGX lobe of a table, which says where its values may be large, and what the facets of a lobe do.
//!
//! Light that has gone through is as a mirror in the horizon shows it: all directions are above the horizon.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::incidence_values::IncidenceValues;
use crate::interchange::content::brdf::in_mirror;
use crate::optics::facet;
use crate::optics::layered::transmittance;
use crate::sphere;

/// How facets send light on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Facets {
    /// Into the mirror direction.
    Mirror,
    /// Through, by Snell's law.
    Refract {
        /// Index beyond over index here.
        eta: f64,
    },
}

impl Facets {
    /// The unit normal of the facets that send `wi` to `wo`; `None` where none do.
    pub fn normal(self, wi: DVec3, wo: DVec3) -> Option<DVec3> {
        let Facets::Refract { eta } = self else { return Some((wi + wo).normalize()) };
        let beyond = in_mirror(wo);
        let sum = if eta > 1.0 { -(wi + eta * beyond) } else { wi + eta * beyond };
        let h = sum.normalize();
        (h.z > 0.0 && wi.dot(h) > 0.0 && beyond.dot(h) < 0.0).then_some(h)
    }

    /// Where facets of unit normal `h` send `wi`; `None` below the horizon, and in total reflection.
    pub fn onward(self, wi: DVec3, h: DVec3) -> Option<DVec3> {
        let to = match self {
            Facets::Mirror => 2.0 * wi.dot(h) * h - wi,
            Facets::Refract { eta } => {
                if wi.dot(h) <= 0.0 {
                    return None;
                }
                in_mirror(facet::split(wi, h, eta).refracted?)
            }
        };
        (to.z > 0.0).then_some(to)
    }

    /// The solid angle of normals that fills a unit of solid angle about `wo`: 1/(4 wi.h), or
    /// eta^2 |wo.h|/(wi.h + eta wo.h)^2.
    pub fn normals_of(self, wi: DVec3, wo: DVec3, h: DVec3) -> f64 {
        match self {
            Facets::Mirror => 1.0 / (4.0 * wi.dot(h)),
            Facets::Refract { eta } => {
                let o = in_mirror(wo).dot(h);
                eta * eta * -o / (wi.dot(h) + eta * o).powi(2)
            }
        }
    }

    /// f of facets of normal `h` over D and masking, times both cosines: with F = 1 a fourth, else
    /// (1 - F) eta^2 (wi.h) |wo.h|/(wi.h + eta wo.h)^2.
    pub fn share(self, wi: DVec3, wo: DVec3, h: DVec3) -> f64 {
        match self {
            Facets::Mirror => 0.25,
            Facets::Refract { eta } => transmittance(wi.dot(h), eta) * wi.dot(h) * self.normals_of(wi, wo, h),
        }
    }
}

/// GGX in vector form.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GuideLobe {
    pub alpha_x: f64,
    pub alpha_y: f64,
    /// What its facets do.
    pub facets: Facets,
}

impl GuideLobe {
    /// 1/sr, positive everywhere.
    pub fn d(self, m: DVec3) -> f64 {
        let q = (m.x / self.alpha_x).powi(2) + (m.y / self.alpha_y).powi(2) + m.z * m.z;
        1.0 / (PI * self.alpha_x * self.alpha_y * q * q)
    }

    /// Projected area towards w: (w.z + sqrt(w.z^2 + ax^2 w.x^2 + ay^2 w.y^2))/2.
    pub fn sigma(self, w: DVec3) -> f64 {
        0.5 * (w.z + (w.z * w.z + (self.alpha_x * w.x).powi(2) + (self.alpha_y * w.y).powi(2)).sqrt())
    }

    /// So many times as wide.
    pub fn scaled(self, by: f64) -> Self {
        GuideLobe { alpha_x: by * self.alpha_x, alpha_y: by * self.alpha_y, ..self }
    }

    /// The one whose slopes have the medians that the light of the first incidence sees: of GGX, half the facets have a
    /// slope below alpha, and half a slope along x below alpha_x/sqrt 3.
    pub fn of(values: &IncidenceValues, facets: Facets) -> Self {
        let phi_i = values.phi_i()[0];
        let wi = sphere::direction(values.theta_i()[0], phi_i);
        let (polar, around) = (400, 72);
        let mut slopes = Vec::with_capacity(polar * around);
        for k in 0..polar * around {
            let theta = (0.5 + (k / around) as f64) / polar as f64 * 0.5 * FRAC_PI_2;
            let h = sphere::direction(theta, TAU * (k % around) as f64 / around as f64);
            if let Some(wo) = facets.onward(wi, h) {
                let value = values.at_incidence((0, 0), phi_i, wo)[values.middle()];
                let flux = value * wo.z * theta.sin() / facets.normals_of(wi, wo, h);
                slopes.push(([(h.x / h.z).abs(), (h.y / h.z).abs(), theta.tan()], flux));
            }
        }
        let median = |axis: usize| {
            let mut sorted: Vec<(f64, f64)> =
                slopes.iter().map(|(slope, flux)| (slope[axis], *flux)).collect();
            sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
            let half = 0.5 * sorted.iter().map(|s| s.1).sum::<f64>();
            let mut sum = 0.0;
            let found = sorted.iter().find(|s| {
                sum += s.1;
                sum >= half
            });
            // Any positive D will do; narrower than this no node of a warp would fall into it.
            found.map_or(1.0, |s| s.0).max(0.005)
        };
        if values.is_isotropic() {
            return GuideLobe { alpha_x: median(2), alpha_y: median(2), facets };
        }
        GuideLobe { alpha_x: 3f64.sqrt() * median(0), alpha_y: 3f64.sqrt() * median(1), facets }
    }
}
