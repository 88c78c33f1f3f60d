//! A law that a table nearly follows, so that what is left, table over law, changes slowly from stop to stop.
//!
//! The law is an even part and a GGX lobe with separable masking: diffuse + gloss D(h)/(4 sigma(wi) sigma(wo)). It only
//! guides: at the stops the table is what it is, and every law gives the same values there.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::sampling::{Sampled, samples};
use crate::interchange::{Colour, Lookup};
use crate::sphere;

/// Directions of each kind in which the law is fitted.
const SAMPLES: usize = 256;
/// Stops at most that it is fitted to, and their last polar angle, rad: towards grazing light a lobe becomes narrower than
/// most bins.
const STOPS: usize = 16;
const LAST_FITTED: f64 = 65.0 * PI / 180.0;
/// Widths of the lobe that are tried, as parts of the one by the medians: an even part beside the lobe widens those.
const WIDTHS: [f64; 7] = [1.2, 0.85, 0.7, 0.5, 0.35, 0.25, 0.17];
/// They are taken where they leave less than this part of the squares: medians are the better estimate of a lobe that
/// stands alone.
const BETTER: f64 = 0.5;
/// Values below this part of a stop's mean weigh alike.
const DARK: f64 = 1e-3;

/// GGX in vector form.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GuideLobe {
    pub alpha_x: f64,
    pub alpha_y: f64,
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
        GuideLobe { alpha_x: by * self.alpha_x, alpha_y: by * self.alpha_y }
    }

    /// The one whose slopes have the medians that the light of the first stop sees: of GGX, half the facets have a
    /// slope below alpha, and half a slope along x below alpha_x/sqrt 3.
    pub fn of(lookup: &Lookup) -> Self {
        let phi_i = lookup.phi_i()[0];
        let wi = sphere::direction(lookup.theta_i()[0], phi_i);
        let (polar, around) = (400, 72);
        let mut slopes = Vec::with_capacity(polar * around);
        for k in 0..polar * around {
            let theta = (0.5 + (k / around) as f64) / polar as f64 * 0.5 * FRAC_PI_2;
            let h = sphere::direction(theta, TAU * (k % around) as f64 / around as f64);
            let wo = 2.0 * wi.dot(h) * h - wi;
            if wo.z > 0.0 {
                let value = lookup.at_stop((0, 0), phi_i, wo)[lookup.middle()];
                let flux = value * wo.z * 4.0 * wi.dot(h) * theta.sin();
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
        if lookup.is_isotropic() {
            return GuideLobe { alpha_x: median(2), alpha_y: median(2) };
        }
        GuideLobe { alpha_x: 3f64.sqrt() * median(0), alpha_y: 3f64.sqrt() * median(1) }
    }
}

/// The law.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Guide {
    lobe: GuideLobe,
    diffuse: Colour,
    gloss: Colour,
}

/// A direction of the sensor at a stop, what it weighs in an integral of f cos, and the table's value.
struct Known {
    wi: DVec3,
    to: Sampled,
    value: Colour,
}

impl Guide {
    /// The law that guides nothing: the same in all directions.
    pub fn even() -> Self {
        Guide { lobe: GuideLobe { alpha_x: 1.0, alpha_y: 1.0 }, diffuse: [1.0; 3], gloss: [0.0; 3] }
    }

    /// The law nearest to a table that has no guide yet.
    pub fn of(lookup: &Lookup) -> Self {
        let widest = GuideLobe::of(lookup);
        let rows = lookup.theta_i().partition_point(|&theta| theta <= LAST_FITTED).max(1);
        let stops = rows * lookup.phi_i().len();
        let mut known = Vec::new();
        for stop in (0..stops).step_by(stops.div_ceil(STOPS)) {
            let place = (stop / lookup.phi_i().len(), stop % lookup.phi_i().len());
            let phi_i = lookup.phi_i()[place.1];
            let wi = sphere::direction(lookup.theta_i()[place.0], phi_i);
            let of = |to: Sampled| Known { wi, to, value: lookup.at_stop(place, phi_i, to.wo) };
            known.extend(samples(wi, widest, SAMPLES).into_iter().map(of));
        }
        let middle = lookup.middle();
        let off = |width: &f64| fitted(&known, widest.scaled(*width), middle).1;
        let best = WIDTHS.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(1.0);
        let lobe = widest.scaled(if off(&best) < BETTER * off(&1.0) { best } else { 1.0 });
        let parts: [[f64; 2]; 3] =
            std::array::from_fn(|c| fitted(&known, lobe, c.min(lookup.last_colour())).0);
        Guide { lobe, diffuse: parts.map(|part| part[0]), gloss: parts.map(|part| part[1]) }
    }

    /// f of the law, positive.
    pub fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let lobe = lobe_brdf(self.lobe, wi, wo);
        std::array::from_fn(|c| self.diffuse[c] + self.gloss[c] * lobe)
    }

    /// The lobe, which says where values may be large.
    pub fn lobe(&self) -> GuideLobe {
        self.lobe
    }
}

fn lobe_brdf(lobe: GuideLobe, wi: DVec3, wo: DVec3) -> f64 {
    lobe.d((wi + wo).normalize()) / (4.0 * lobe.sigma(wi) * lobe.sigma(wo))
}

/// Even part and lobe, neither negative and not both 0, that are nearest to one colour; and the squares that are left.
/// Squares weigh with 1/value, so that lobe and floor count by their light.
fn fitted(known: &[Known], lobe: GuideLobe, colour: usize) -> ([f64; 2], f64) {
    let (sum, cosines) = known
        .iter()
        .fold((0.0, 0.0), |(sum, cosines), k| (sum + k.to.weight * k.value[colour], cosines + k.to.weight));
    if sum <= 0.0 {
        return ([1.0, 0.0], 0.0);
    }
    let least = DARK * sum / cosines;
    let mut m = [[0.0; 3]; 3];
    for k in known {
        let terms = [1.0, lobe_brdf(lobe, k.wi, k.to.wo), k.value[colour]];
        let weight = k.to.weight / (k.value[colour] + least);
        for (row, a) in m.iter_mut().zip(terms) {
            row.iter_mut().zip(terms).for_each(|(cell, b)| *cell += weight * a * b);
        }
    }
    let left = |[a, b]: [f64; 2]| {
        m[2][2] - 2.0 * (a * m[0][2] + b * m[1][2])
            + a * a * m[0][0]
            + 2.0 * a * b * m[0][1]
            + b * b * m[1][1]
    };
    let determinant = m[0][0] * m[1][1] - m[0][1] * m[0][1];
    let both = [
        (m[0][2] * m[1][1] - m[1][2] * m[0][1]) / determinant,
        (m[1][2] * m[0][0] - m[0][2] * m[0][1]) / determinant,
    ];
    let alone = [[m[0][2] / m[0][0], 0.0], [0.0, m[1][2] / m[1][1]]];
    let mut best = if left(alone[0]) < left(alone[1]) { alone[0] } else { alone[1] };
    if both.iter().all(|part| *part >= 0.0) && left(both) < left(best) {
        best = both;
    }
    (best, left(best))
}
