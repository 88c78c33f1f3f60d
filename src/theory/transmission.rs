//! The microfacet BTDF: light through a rough clear surface, 1/sr, without cosine.
//!
//! Input: a roughness, a pair of directions on opposite sides in the stage's frame, and the index beyond over the index
//! here. Output: flux per solid angle and incident flux, over |cos_o|: no eta^2 of radiance. Papers: Walter et al. 2007
//! (the value); Heitz et al. 2016, "Multiple-scattering microfacet BSDFs with the Smith model", section 3 (G2 of arms
//! on opposite sides).

use glam::DVec3;

use super::beta::beta_of_lambdas;
use super::microfacet::Microfacet;
use super::smith::{ArmSide, Masking, g2_separable};

/// The facet that refracts one direction into another, by |wi + wo|^2 alone.
///
/// With q = |wi + wo|^2, d = |eta - 1| and H = -(wi + eta wo) turned to the light, H.H = d^2 + eta q; for eta > 1
/// wi.H = d - eta q/2 and -wo.H = d + q/2, for eta < 1 wi.H = d + eta q/2 and -wo.H = d - q/2. There is no difference
/// of cosines in any of them, so neither a faint interface nor total reflection costs digits: light that is totally
/// reflected has no pair of directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RefractingFacet {
    /// Along the normal on the light's side, of length |H|.
    pub normal: DVec3,
    /// wi.H > 0.
    towards: f64,
    /// -wo.H > 0.
    beyond: f64,
    /// H.H.
    length2: f64,
    /// Cosine between -wi and wo: by how much light is turned.
    turn_cos: f64,
    eta: f64,
}

impl RefractingFacet {
    /// The facet; `None` where none does that: the light would have to come from its other side, or leave on this one, or
    /// the normal points below the horizon.
    ///
    /// - `wi`, `wo`: unit vectors; `eta`: index beyond over index here, > 0 and not 1.
    /// - Numerics: right to (wi + wo as it is rounded)/d.
    // Tested by `the_facet_refracts_by_snells_law`.
    pub fn new(wi: DVec3, wo: DVec3, eta: f64) -> Option<Self> {
        let difference = eta - 1.0;
        let d = difference.abs();
        debug_assert!(eta > 0.0 && d > 0.0);
        let normal = normal_sum(wi, wo, eta);
        let q = (wi + wo).length_squared();
        let (towards, beyond) = if difference > 0.0 {
            (d - 0.5 * eta * q, d + 0.5 * q)
        } else {
            (d + 0.5 * eta * q, d - 0.5 * q)
        };
        let exists = normal.z > 0.0 && towards > 0.0 && beyond > 0.0;
        let length2 = d * d + eta * q;
        exists.then_some(RefractingFacet { normal, towards, beyond, length2, turn_cos: 1.0 - 0.5 * q, eta })
    }

    /// What Fresnel's equations let through, unpolarised: T_s = 4 c g/(c + g)^2 and T_p = T_s/cos^2(turn).
    ///
    /// With c = wi.h and g = eta |wo.h|: c + g = |eta^2 - 1|/|H|, so T_s = 4 eta (wi.H)(-wo.H)/(eta^2 - 1)^2.
    // Tested by `the_facet_refracts_by_snells_law`.
    pub fn transmittance(&self) -> f64 {
        let m = (self.eta - 1.0) * (self.eta + 1.0);
        let across = 4.0 * self.eta * (self.towards / m) * (self.beyond / m);
        0.5 * across * (1.0 + 1.0 / (self.turn_cos * self.turn_cos))
    }

    /// |wi.h| |wo.h| eta^2/(wi.h + eta wo.h)^2: projected solid angles of facets into those of directions.
    fn spread(&self) -> f64 {
        (self.eta * self.towards / self.length2) * (self.eta * self.beyond / self.length2)
    }
}

/// What a facet's normal is along that sends light from `wi` to `wo`: wi + wo above the horizon, `normal_sum` below.
pub fn half_vector(wi: DVec3, wo: DVec3, eta: f64) -> DVec3 {
    if wo.z > 0.0 { wi + wo } else { normal_sum(wi, wo, eta) }
}

/// H = -(wi + eta wo), turned to the light's side, as (wi + wo) + (eta - 1) wo.
///
/// Smooth in both directions also where no facet exists; its z may then be negative.
pub fn normal_sum(wi: DVec3, wo: DVec3, eta: f64) -> DVec3 {
    let difference = eta - 1.0;
    let sum = (wi + wo) + difference * wo;
    if difference > 0.0 { -sum } else { sum }
}

/// G2 of arms on opposite sides, [0, 1]: the facet is seen by both.
///
/// None: 1. Separable: G1(wi) G1(wo). Height-correlated: B(1 + Li, 1 + Lo), as a facet that lies high is seen well from
/// above and badly from below. The azimuth says nothing there: the direction-correlated masking is the height-correlated
/// one.
///
/// - `o`: the arm below, turned up through the horizon: the law of slopes is the same from inside.
/// - Panics for the maskings of grains: what is seen from inside them has no closed form.
/// - Source: Heitz et al. 2016, section 3.
// Tested by `every_value_of_transmission_is_met` (tests/it/transmission_values.rs).
pub fn g2_opposite(masking: Masking, i: &ArmSide, o: &ArmSide) -> f64 {
    match masking {
        Masking::None => 1.0,
        Masking::Separable => g2_separable(i, o),
        Masking::HeightCorrelated | Masking::DirectionCorrelated => beta_of_lambdas(i.lambda(), o.lambda()),
        Masking::Grains | Masking::GrainsProduct => unreachable!("grains have no masking from inside"),
    }
}

impl Microfacet {
    /// f_t(wi, wo) = |wi.h| |wo.h|/(|cos_i| |cos_o|) eta^2 (1 - F) G2 D(h)/(wi.h + eta wo.h)^2, without cosine.
    ///
    /// - `wi`, `wo`: unit vectors of the stage's frame, the one above the horizon, the other below; else the value is 0.
    ///   `eta`: index below over index above, > 0 and not 1. Not for the maskings of grains.
    /// - Returns 1/sr, >= 0. f_t(wi, wo; eta)/eta^2 = f_t(wo, wi; 1/eta), seen from below.
    /// - Numerics: D from wi + eta wo without normalisation; the rest from |wi + wo|^2, see `RefractingFacet`.
    /// - Source: Walter et al. 2007, eq. 21, as flux.
    ///
    /// ```
    /// use gonio::sphere::direction_deg;
    /// use gonio::theory::{Masking, Microfacet, Ndf};
    ///
    /// let model = Microfacet::isotropic(Ndf::Ggx, 0.5);
    /// let (up, down) = (direction_deg(0.0, 0.0), direction_deg(180.0, 0.0));
    /// // D = 1/(pi alpha^2), 1 - F = 0.96, and normals spread by ((eta - 1)/eta)^2.
    /// let f = model.btdf(up, down, Masking::HeightCorrelated, 1.5);
    /// assert!((f * std::f64::consts::PI * 0.25 / (9.0 * 0.96) - 1.0).abs() < 1e-15);
    /// ```
    // Tested by `every_value_of_transmission_is_met` (tests/it/transmission_values.rs), `light_goes_back_as_it_came`.
    pub fn btdf(&self, wi: DVec3, wo: DVec3, masking: Masking, eta: f64) -> f64 {
        if wi.z <= 0.0 || wo.z >= 0.0 {
            return 0.0;
        }
        let (i, o) = (self.to_sample(wi), self.to_sample(wo));
        let flux = self.transmitted(&self.side(i), i, o, eta);
        flux.map_or(0.0, |(flux, o_side)| flux * g2_opposite(masking, &self.side(i), &o_side) / -wo.z)
    }

    /// f_t |cos_o|/G2 of a pair in the sample's frame, and the arm below, turned up; `None` where no facet refracts the one
    /// into the other.
    pub(crate) fn transmitted(
        &self,
        i_side: &ArmSide,
        i: DVec3,
        o: DVec3,
        eta: f64,
    ) -> Option<(f64, ArmSide)> {
        let facet = RefractingFacet::new(i, o, eta)?;
        let d = self.ndf.d_of_sum(facet.normal, self.alpha_x, self.alpha_y);
        let o_side = self.side(DVec3::new(o.x, o.y, -o.z));
        Some((d * facet.spread() * facet.transmittance() / i_side.cos, o_side))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::FacetAngle;
    use crate::optics::facet::split;
    use crate::optics::fresnel::dielectric::t_dielectric;
    use crate::rng::{Purpose, StreamId, stream, uniform};
    use crate::sphere::{self, direction_deg};
    use crate::theory::Ndf;
    use std::f64::consts::{FRAC_PI_2, TAU};

    const ETAS: [f64; 6] = [1.0001, 1.1, 1.5, 2.4, 1.0 / 1.5, 1.0 / 1.0001];

    #[test]
    fn the_facet_refracts_by_snells_law() {
        for eta in ETAS {
            for (tilt_deg, theta_deg) in [(0.0, 0.0), (10.0, 30.0), (30.0, 41.0), (50.0, 20.0)] {
                let (normal, wi) = (direction_deg(tilt_deg, 40.0), direction_deg(theta_deg, 190.0));
                let split = split(wi, normal, eta);
                let Some(wo) = split.refracted.filter(|wo| wo.z < 0.0) else { continue };
                let facet = RefractingFacet::new(wi, wo, eta).expect("a facet");
                // wi + wo rounds to an ulp, and H is d long; near the critical angle the root magnifies by as much.
                let tolerance = 64.0 * f64::EPSILON / (eta - 1.0).abs();
                assert!(facet.normal.normalize().distance(normal) < tolerance, "{eta} {tilt_deg}");
                let cos = wi.dot(normal);
                let angle = FacetAngle { cos, sin2: 1.0 - cos * cos };
                let found = facet.transmittance() / t_dielectric(angle, eta);
                assert!((found - 1.0).abs() < tolerance, "{eta} {tilt_deg}: {found}");
                let lengths = (facet.towards, facet.beyond, facet.length2.sqrt());
                assert!((lengths.0 / lengths.2 - cos).abs() < tolerance);
                assert!((lengths.1 / lengths.2 + wo.dot(normal)).abs() < tolerance);
            }
        }
    }

    #[test]
    fn light_goes_back_as_it_came() {
        let mut rng =
            stream(StreamId { seed: 8, purpose: Purpose::Test, realisation: 0, incidence: 0, block: 0 });
        let mut seen = 0;
        for pair in 0..100_000usize {
            let mut number = |scale: f64| scale * uniform(&mut rng);
            let mut arm = || sphere::direction(number(FRAC_PI_2), number(TAU));
            let (wi, wo) = (arm(), arm());
            let below = |w: DVec3| DVec3::new(w.x, w.y, -w.z);
            let eta = 1.0 + number(1.5);
            let model = Microfacet {
                ndf: if pair % 2 == 0 { Ndf::Ggx } else { Ndf::Beckmann },
                alpha_x: 0.1 + number(1.0),
                alpha_y: 0.1 + number(1.0),
                rotation: 0.3,
            };
            let masking = Masking::ALL[pair / 2 % 4];
            let there = model.btdf(wi, below(wo), masking, eta) / (eta * eta);
            let back = model.btdf(wo, below(wi), masking, 1.0 / eta);
            let Some(facet) = RefractingFacet::new(model.to_sample(wi), model.to_sample(below(wo)), eta)
            else {
                // 1/eta is rounded: where one way just ends, so does the other within an ulp of d.
                assert!(back <= 1e-12, "{wi} {wo} {eta}: {back}");
                continue;
            };
            seen += 1;
            // d and wi.H = d - eta q/2 round to an ulp of 1, D to its slopes' (s^2 < 745 of Beckmann where it is not 0).
            let slope2 = facet.normal.truncate().length_squared() / facet.normal.z.powi(2) / 0.01;
            let cond = 1.0 / (eta - 1.0) + 1.0 / facet.towards + slope2.min(745.0) / facet.normal.z;
            let tolerance = 64.0 * f64::EPSILON * cond * there;
            assert!((there - back).abs() <= tolerance + f64::MIN_POSITIVE, "{wi} {wo} {eta}: {there} {back}");
        }
        assert!(seen > 5_000, "{seen}");
    }

    #[test]
    fn there_is_no_light_where_no_facet_refracts() {
        let model = Microfacet::isotropic(Ndf::Ggx, 0.5);
        let up = direction_deg(20.0, 0.0);
        for masking in Masking::ALL {
            // On one side; in the horizon; turned by more than from grazing to the critical angle (48 degrees).
            for (wi, wo) in [(up, up), (-up, -up), (up, DVec3::X), (up, direction_deg(110.0, 180.0))] {
                assert_eq!(model.btdf(wi, wo, masking, 1.5), 0.0);
                assert_eq!(model.btdf(wi, wo, masking, 1.0 / 1.5), 0.0);
            }
        }
    }
}
