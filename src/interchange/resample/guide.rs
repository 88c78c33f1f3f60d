//! A law that a table nearly follows, so that what is left, table over law, changes slowly from incidence to incidence.
//!
//! The law is an even part and a GGX lobe with separable masking: diffuse + gloss D(h)/(4 sigma(wi) sigma(wo)), of light that has
//! gone through with the half vector of refraction and what facets let through in place of the fourth. It only
//! guides: at the incidences the table is what it is, and every law gives the same values there.

use std::f64::consts::PI;

use glam::DVec3;

use super::incidence_values::IncidenceValues;
use super::lobe::{Facets, GuideLobe};
use super::sampling::{Sampled, samples};
use crate::interchange::Colour;
use crate::sphere;

/// Directions of each kind in which the law is fitted.
const SAMPLES: usize = 256;
/// Incidences at most that it is fitted to, and their last polar angle, rad: towards grazing light a lobe becomes
/// narrower than most bins.
const INCIDENCES: usize = 16;
const LAST_FITTED: f64 = 65.0 * PI / 180.0;
/// Widths of the lobe that are tried, as parts of the one by the medians: an even part next to the lobe widens those.
const WIDTHS: [f64; 7] = [1.2, 0.85, 0.7, 0.5, 0.35, 0.25, 0.17];
/// They are taken where they leave less than this part of the squares: medians are the better estimate of a lobe that
/// stands alone.
const BETTER: f64 = 0.5;
/// Values below this part of an incidence's mean weigh alike.
const DARK: f64 = 1e-3;

/// The law.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Guide {
    lobe: GuideLobe,
    diffuse: Colour,
    gloss: Colour,
}

/// A direction of the sensor at an incidence, what it weighs in an integral of f cos, and the table's value.
struct Known {
    wi: DVec3,
    to: Sampled,
    value: Colour,
}

impl Guide {
    /// The law nearest to a table.
    pub fn of(values: &IncidenceValues, facets: Facets) -> Self {
        let widest = GuideLobe::of(values, facets);
        let rows = values.theta_i().partition_point(|&theta| theta <= LAST_FITTED).max(1);
        let incidences = rows * values.phi_i().len();
        let mut known = Vec::new();
        for incidence in (0..incidences).step_by(incidences.div_ceil(INCIDENCES)) {
            let place = (incidence / values.phi_i().len(), incidence % values.phi_i().len());
            let phi_i = values.phi_i()[place.1];
            let wi = sphere::direction(values.theta_i()[place.0], phi_i);
            let of = |to: Sampled| Known { wi, to, value: values.at_incidence(place, phi_i, to.wo) };
            known.extend(samples(wi, widest, SAMPLES).into_iter().map(of));
        }
        let middle = values.middle();
        let off = |width: &f64| fitted(&known, widest.scaled(*width), middle).1;
        let best = WIDTHS.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(1.0);
        let lobe = widest.scaled(if off(&best) < BETTER * off(&1.0) { best } else { 1.0 });
        let parts: [[f64; 2]; 3] =
            std::array::from_fn(|c| fitted(&known, lobe, c.min(values.last_colour())).0);
        // Where no facet refracts light to is nothing but the even part: it is there.
        let least = |c: usize| match facets {
            Facets::Mirror => 0.0,
            Facets::Refract { .. } => DARK * mean(&known, c.min(values.last_colour())),
        };
        let diffuse = std::array::from_fn(|c| parts[c][0].max(least(c)));
        Guide { lobe, diffuse, gloss: parts.map(|part| part[1]) }
    }

    /// f of the law, positive.
    pub fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        self.with_lobe(lobe_brdf(self.lobe, wi, wo))
    }

    /// The same at facets of normal `h`, the one that sends `wi` to `wo`, where D(h) and the projected area `sigma` of the
    /// lobe towards `wi` are known.
    pub fn brdf_of_facets(&self, (h, d): (DVec3, f64), (wi, sigma): (DVec3, f64), wo: DVec3) -> Colour {
        let share = self.lobe.facets.share(wi, wo, h);
        self.with_lobe(d * share / (sigma * self.lobe.sigma(wo)))
    }

    /// The even part alone: f where no facet sends light.
    pub fn diffuse(&self) -> Colour {
        self.diffuse
    }

    fn with_lobe(&self, lobe: f64) -> Colour {
        std::array::from_fn(|c| self.diffuse[c] + self.gloss[c] * lobe)
    }

    /// The lobe, which says where values may be large.
    pub fn lobe(&self) -> GuideLobe {
        self.lobe
    }
}

fn lobe_brdf(lobe: GuideLobe, wi: DVec3, wo: DVec3) -> f64 {
    let of = |h| lobe.d(h) * lobe.facets.share(wi, wo, h) / (lobe.sigma(wi) * lobe.sigma(wo));
    lobe.facets.normal(wi, wo).map_or(0.0, of)
}

/// The mean of a colour over all incidences, 1 where none is positive.
fn mean(known: &[Known], colour: usize) -> f64 {
    let (sum, cosines) = known
        .iter()
        .fold((0.0, 0.0), |(sum, cosines), k| (sum + k.to.weight * k.value[colour], cosines + k.to.weight));
    if sum > 0.0 { sum / cosines } else { 1.0 }
}

/// Even part and lobe, neither negative and not both 0, that are nearest to one colour; and the squares that are left.
/// Squares weigh with 1/value, so that lobe and floor count by their light.
fn fitted(known: &[Known], lobe: GuideLobe, colour: usize) -> ([f64; 2], f64) {
    if known.iter().all(|k| k.to.weight * k.value[colour] <= 0.0) {
        return ([1.0, 0.0], 0.0);
    }
    let least = DARK * mean(known, colour);
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
