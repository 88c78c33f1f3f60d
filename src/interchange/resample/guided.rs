//! A table between its incidences: the ratio to a law that it nearly follows ([`Guide`]), cubic at equal half vector.
//!
//! There the mirrored light (that which has gone through: the refracted one) is alike (f(wi, wo) = D(h) times what varies slowly), where at equal `wo` two lobes would
//! show; and masking and the two cosines, by which the values at one half vector grow many times over towards grazing
//! light, are the law's. Beyond the incidences the ratio of the nearest holds.

use glam::DVec3;

use super::axis::Taps;
use super::guide::Guide;
use super::incidence_values::IncidenceValues;
use super::lobe::Facets;
use crate::interchange::Colour;
use crate::sphere;

/// The values of a table, and the law between them.
pub struct Guided {
    pub values: IncidenceValues,
    pub guide: Guide,
    /// The projected area of the law's lobe towards the light of every incidence, [theta_i][phi_i]. Where every azimuth of the
    /// light is alike, so is the lobe.
    sigmas: Vec<f64>,
}

impl Guided {
    /// A table between its incidences, with the law that it nearly follows.
    pub fn new(values: IncidenceValues, facets: Facets) -> Self {
        let guide = Guide::of(&values, facets);
        let sigmas = values.all_wi().iter().map(|&wi| guide.lobe().sigma(wi)).collect();
        Guided { values, guide, sigmas }
    }

    /// The value at any pair of directions; `theta` and `phi` are those of `wi`.
    pub fn brdf(&self, wi: DVec3, (theta, phi): (f64, f64), wo: DVec3) -> Colour {
        let over = |taps, all| self.over_incidences((wi, phi), wo, taps, all);
        let cubic = over(self.values.incidence_taps(theta, phi), true);
        let found = cubic.or_else(|| over(self.values.linear_taps(theta, phi), false));
        // Every mirrored arm below the horizon: light and sensor both graze; the nearest incidence as it is.
        found.map_or_else(|| self.values.nearest(theta, phi, wo), |value| value.map(|v| v.max(0.0)))
    }

    /// The sum over the incidences of the taps of the ratio to the guide, at equal half vector, times the guide; `None`
    /// where a mirrored arm is below the horizon and `all` are wanted.
    fn over_incidences(
        &self,
        (wi, phi): (DVec3, f64),
        wo: DVec3,
        (polar, circle): (Taps<'_>, Taps<'_>),
        all: bool,
    ) -> Option<Colour> {
        let lobe = self.guide.lobe();
        let facets = lobe.facets;
        // D is that of all incidences: they are seen at the same half vector.
        let h = facets.normal(wi, wo).map(|h| (h, lobe.d(h)));
        let law = |wi, sigma, wo| {
            h.map_or(self.guide.diffuse(), |facet| self.guide.brdf_of_facets(facet, (wi, sigma), wo))
        };
        let colours = 0..=self.values.last_colour();
        // Where every azimuth of the light is alike, the incidences have that of `wi`.
        let turn = self.values.is_isotropic().then(|| phi.sin_cos());
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for t in polar.iter() {
            for p in circle.iter() {
                let weight = t.weight * p.weight;
                if weight == 0.0 {
                    continue;
                }
                let at = self.values.wi(t.node, p.node);
                let (phi_i, from) = match turn {
                    Some(turn) => (phi, sphere::turned(at, turn)),
                    None => (self.values.phi_i()[p.node], at),
                };
                let to = match h {
                    Some((h, _)) => facets.onward(from, h),
                    // Light that met several facets, at equal `wo` of incidences where it did.
                    None => Some(wo).filter(|&wo| facets.normal(from, wo).is_none()),
                };
                let Some(to) = to else {
                    if all {
                        return None;
                    }
                    continue;
                };
                let value = self.values.at_incidence((t.node, p.node), phi_i, to);
                let law = law(from, self.sigmas[t.node * self.values.phi_i().len() + p.node], to);
                colours.clone().for_each(|c| sum[c] += weight * value[c] / law[c]);
                weights += weight;
            }
        }
        let law = law(wi, lobe.sigma(wi), wo);
        (weights > 0.0).then(|| std::array::from_fn(|c| law[c] * sum[c] / weights))
    }
}
