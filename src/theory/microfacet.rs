//! The microfacet BRDF f = D(h) V F(c), 1/sr, without cosine.
//!
//! Input: a roughness, the turn of the sample and a pair of directions in the stage's frame. Output: the value of
//! the single-bounce model. Paper: Walter et al. 2007; Heitz 2014 for the maskings.

use glam::DVec3;

use super::ndf::Ndf;
use super::smith::{ArmSide, Masking, visibility};
use crate::optics::{FacetAngle, Fresnel};
use crate::sphere;

/// A rough surface of flat mirrors, as the theory sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Microfacet {
    /// Law of the normals.
    pub ndf: Ndf,
    /// Slope scale along the sample's x, > 0.
    pub alpha_x: f64,
    /// Slope scale along the sample's y, > 0.
    pub alpha_y: f64,
    /// The sample turned counter-clockwise seen from +z, rad.
    pub rotation: f64,
}

impl Microfacet {
    /// An unturned surface with one roughness.
    pub fn isotropic(ndf: Ndf, alpha: f64) -> Self {
        Microfacet { ndf, alpha_x: alpha, alpha_y: alpha, rotation: 0.0 }
    }

    /// Whether every azimuth is alike.
    pub fn is_isotropic(&self) -> bool {
        self.alpha_x == self.alpha_y
    }

    /// A direction of the stage in the sample's own frame, whose x is the axis of `alpha_x`.
    pub fn to_sample(&self, w: DVec3) -> DVec3 {
        if self.rotation == 0.0 {
            return w;
        }
        let (sin, cos) = self.rotation.sin_cos();
        sphere::turned(w, (-sin, cos))
    }

    /// An arm of the sample's frame as the masking sees it.
    pub fn side(&self, w: DVec3) -> ArmSide {
        ArmSide::new(self.ndf, w, self.alpha_x, self.alpha_y)
    }

    /// f(wi, wo) = D(h) G2 F(c)/(4 cos_i cos_o), without cosine.
    ///
    /// - `wi`, `wo`: unit vectors of the stage's frame. Below the horizon the value is 0. One arm may lie in the
    ///   horizon (not with `Masking::None`); with both there the value is infinite.
    /// - Returns 1/sr, >= 0. Swapping the arms gives the same bits.
    /// - Numerics: D from wi + wo, V and c in forms without cancellation; relative error 2^-52 (16 + 4 cond).
    /// - Source: Walter et al. 2007; Heitz 2014.
    ///
    /// ```
    /// use gonio::optics::Fresnel;
    /// use gonio::sphere::direction_deg;
    /// use gonio::theory::{Masking, Microfacet, Ndf};
    ///
    /// let model = Microfacet::isotropic(Ndf::Ggx, 0.5);
    /// let up = direction_deg(0.0, 0.0);
    /// // D(0) = 1/(pi alpha^2), no masking: f = 1/(4 pi alpha^2).
    /// let f = model.brdf(up, up, Masking::HeightCorrelated, &Fresnel::Perfect);
    /// assert!((f * std::f64::consts::PI - 1.0).abs() < 1e-15);
    /// ```
    // Tested by `every_reference_value_is_met` (tests/it/formula_values.rs), `swapped_arms_give_the_same_bits`.
    pub fn brdf(&self, wi: DVec3, wo: DVec3, masking: Masking, fresnel: &Fresnel) -> f64 {
        if wi.z < 0.0 || wo.z < 0.0 {
            return 0.0;
        }
        let (i, o) = (self.to_sample(wi), self.to_sample(wo));
        let v = visibility(masking, &self.side(i), &self.side(o));
        let d = self.ndf.d_of_sum(i + o, self.alpha_x, self.alpha_y);
        d * v * fresnel.reflectance(FacetAngle::of_pair(wi, wo))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, StreamId, stream, uniform};
    use std::f64::consts::{FRAC_PI_2, TAU};

    #[test]
    fn swapped_arms_give_the_same_bits() {
        let mut rng =
            stream(StreamId { seed: 7, purpose: Purpose::Test, realisation: 0, incidence: 0, block: 0 });
        let materials = [
            Fresnel::Perfect,
            Fresnel::Schlick { f0: 0.04 },
            Fresnel::Dielectric { eta: 1.5 },
            Fresnel::Conductor { eta: 0.18, k: 3.4 },
        ];
        for pair in 0..100_000usize {
            let mut number = |scale: f64| scale * uniform(&mut rng);
            let mut arm = || sphere::direction(number(FRAC_PI_2), number(TAU));
            let (wi, wo) = (arm(), arm());
            let model = Microfacet {
                ndf: if pair % 2 == 0 { Ndf::Ggx } else { Ndf::Beckmann },
                alpha_x: 1e-4 + number(2.0).powi(4),
                alpha_y: 1e-4 + number(2.0).powi(4),
                rotation: if pair % 3 == 0 { 0.0 } else { number(TAU) },
            };
            let masking = Masking::ALL[pair / 2 % 4];
            let there = model.brdf(wi, wo, masking, &materials[pair / 8 % 4]);
            let back = model.brdf(wo, wi, masking, &materials[pair / 8 % 4]);
            assert!(there.is_finite() && there >= 0.0, "{model:?} {wi} {wo}: {there}");
            assert_eq!(there.to_bits(), back.to_bits(), "{model:?} {masking:?} {wi} {wo}");
        }
    }

    #[test]
    fn turning_the_sample_is_turning_the_arms_back() {
        let still = Microfacet { ndf: Ndf::Ggx, alpha_x: 0.1, alpha_y: 0.4, rotation: 0.0 };
        let turned = Microfacet { rotation: 0.5, ..still };
        let arms = |shift: f64| (sphere::direction(0.7, 1.0 + shift), sphere::direction(1.1, 3.5 + shift));
        let value = |model: &Microfacet, (wi, wo): (DVec3, DVec3)| {
            model.brdf(wi, wo, Masking::DirectionCorrelated, &Fresnel::Perfect)
        };
        let (a, b) = (value(&still, arms(0.0)), value(&turned, arms(0.5)));
        // The turn moves each component by 2 ulp; D magnifies by at most 4/alpha.
        assert!((a - b).abs() < 100.0 * f64::EPSILON * a, "{a} {b}");
    }

    #[test]
    fn below_the_horizon_there_is_no_light() {
        let model = Microfacet::isotropic(Ndf::Ggx, 0.5);
        let up = sphere::direction(0.3, 0.0);
        assert_eq!(model.brdf(up, -up, Masking::None, &Fresnel::Perfect), 0.0);
        assert_eq!(model.brdf(-up, up, Masking::Separable, &Fresnel::Perfect), 0.0);
    }
}
