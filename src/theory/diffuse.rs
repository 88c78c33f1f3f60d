//! The BRDF of a rough surface of matt facets, bare or under an interface, order 1, 1/sr, without cosine.
//!
//! Input: a roughness and a pair of directions in the stage's frame. Output: the value for facets of albedo 1: each scatters
//! by Lambert's law. Papers: Oren and Nayar 1994 (matt facets); Heitz and Dupuy 2015, "Implementing a simple anisotropic
//! rough diffuse material with stochastic evaluation" (with Smith's masking).

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};
use std::sync::LazyLock;

use glam::DVec3;

use super::gauss_legendre::gauss_legendre;
use super::microfacet::Microfacet;
use super::smith::{Masking, visibility};
use crate::optics::layered::Interface;

/// Rules on [0, 1]: over the normal's polar angle, and two over an arc of azimuth that must agree.
static RULES: LazyLock<[Vec<(f64, f64)>; 3]> = LazyLock::new(|| [24, 4, 6].map(gauss_legendre));

/// How well two orders must agree over the azimuth, of the whole; the higher one is far closer.
const AGREEMENT: f64 = 1e-6;

/// Arcs beyond which halving ends: of 2^-30 of a turn.
const NARROWEST: f64 = TAU / (1u64 << 30) as f64;

impl Microfacet {
    /// f(wi, wo) = G2/(pi cos_i cos_o) * integral of D(m) max(0, wi.m) max(0, wo.m) dm over the facets' normals.
    ///
    /// - `wi`, `wo`: unit vectors of the stage's frame, above the horizon; else the value is 0. Smith's maskings, whose G2 is
    ///   the same for every facet; not those of grains.
    /// - Returns 1/sr, >= 0, for facets of albedo 1.
    /// - Numerics and cost: those of `facet_overlap`.
    // Tested by `matt_facets_meet_mpmath` (tests/it/diffuse_values.rs), `smooth_matt_surfaces_are_lambert`.
    pub fn diffuse(&self, wi: DVec3, wo: DVec3, masking: Masking) -> f64 {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return 0.0;
        }
        let (i, o) = (self.to_sample(wi), self.to_sample(wo));
        let v = visibility(masking, &self.side(i), &self.side(o));
        4.0 * FRAC_1_PI * v * self.facet_overlap(i, o)
    }

    /// The integral of D(m) max(0, wi.m) max(0, wo.m) dm over the normals, (0, 1].
    ///
    /// Over the canonical normal (b, p): m is along h = (alpha_x sin b cos p, alpha_y sin b sin p, cos b) of length L, and
    /// the integrand alpha_x alpha_y D(m) sin b (w_i.h)(w_o.h)/L^5 db dp. It ends where an arm meets the facet's plane,
    /// tan b = -w.z/k with k = alpha_x w.x cos p + alpha_y w.y sin p: the rule in b ends there, the one in p is cut where
    /// a k is 0 and where both ends meet.
    ///
    /// - `i`, `o`: unit vectors of the sample's frame, above the horizon. Swapping them changes roundings alone.
    /// - Numerics: 24 points in tan(b/2), denser towards its end, and arcs of azimuth halved until 4 and 6 points agree to
    ///   1e-6 of the whole. Relative error below 5e-6, measured from alpha 1e-3 to 2 and up to 89 degrees.
    /// - Cost: about 170 azimuths, 30 us for GGX.
    // Tested by `matt_facets_meet_mpmath` (tests/it/diffuse_values.rs).
    pub fn facet_overlap(&self, i: DVec3, o: DVec3) -> f64 {
        self.weighed_overlap(i, o, |_, _| 1.0)
    }

    /// The same of matt facets under an interface: what of the light of each its base sends on, for a base that loses none.
    ///
    /// - Numerics: relative error below 1e-5, measured for indices from 1.5 to 4 and up to 89 degrees; at 1.01, where F falls
    ///   within the last degrees, 2e-4 at 89 degrees and 2e-6 at 85.
    // Tested by `reference_values_of_layered_facets_are_met` (tests/it/facets/layered_values.rs).
    pub fn layered_overlap(&self, i: DVec3, o: DVec3, interface: &Interface) -> f64 {
        self.weighed_overlap(i, o, |cos_i, cos_o| interface.weight(cos_i, cos_o))
    }

    /// `weight`: of the cosines of both arms at a facet.
    fn weighed_overlap(&self, i: DVec3, o: DVec3, weight: impl Fn(f64, f64) -> f64) -> f64 {
        let [_, coarse, fine] = &*RULES;
        let over = |[from, to]: [f64; 2], rule: &[(f64, f64)]| -> f64 {
            let at = |&(x, part): &(f64, f64)| part * self.over_polar(i, o, from + (to - from) * x, &weight);
            (to - from) * rule.iter().map(at).sum::<f64>()
        };
        let marks = self.azimuths_of_kinks(i, o);
        let mut arcs: Vec<([f64; 2], f64)> =
            marks.windows(2).map(|ends| [ends[0], ends[1]]).map(|arc| (arc, over(arc, fine))).collect();
        let allowed = AGREEMENT * arcs.iter().map(|(_, value)| value).sum::<f64>();
        let mut sum = 0.0;
        while let Some((arc @ [from, to], value)) = arcs.pop() {
            if (over(arc, coarse) - value).abs() <= allowed || to - from < NARROWEST {
                sum += value;
            } else {
                let middle = 0.5 * (from + to);
                arcs.extend([[from, middle], [middle, to]].map(|half| (half, over(half, fine))));
            }
        }
        sum
    }

    /// Once around, from the first kink to itself.
    fn azimuths_of_kinks(&self, i: DVec3, o: DVec3) -> Vec<f64> {
        let lean = |w: DVec3| [self.alpha_x * w.x, self.alpha_y * w.y];
        let (k_i, k_o) = (lean(i), lean(o));
        let apart = [0, 1].map(|axis| i.z * k_o[axis] - o.z * k_i[axis]);
        let across =
            |[x, y]: [f64; 2]| [FRAC_PI_2, -FRAC_PI_2].map(|turn| (y.atan2(x) + turn).rem_euclid(TAU));
        let mut marks: Vec<f64> = [k_i, k_o, apart].into_iter().flat_map(across).collect();
        marks.sort_by(f64::total_cmp);
        marks.push(marks[0] + TAU);
        marks
    }

    /// The integral over b for one azimuth, in t = tan(b/2): sin b = 2t/(1 + t^2), db = 2 dt/(1 + t^2); t = end u (2 - u).
    fn over_polar(&self, i: DVec3, o: DVec3, azimuth: f64, weight: impl Fn(f64, f64) -> f64) -> f64 {
        let (sin, cos) = azimuth.sin_cos();
        let (x, y) = (self.alpha_x * cos, self.alpha_y * sin);
        let (k_i, k_o) = (x * i.x + y * i.y, x * o.x + y * o.y);
        let end_of = |z: f64, k: f64| if k < 0.0 { z.atan2(-k) } else { 0.5 * PI };
        let end = (0.5 * end_of(i.z, k_i).min(end_of(o.z, k_o))).tan();
        let at = |&(u, part): &(f64, f64)| {
            let t = end * u * (2.0 - u);
            let scale = 1.0 / (1.0 + t * t);
            let (sin_b, cos_b) = (2.0 * t * scale, (1.0 - t) * (1.0 + t) * scale);
            let h = DVec3::new(x * sin_b, y * sin_b, cos_b);
            let length2 = h.length_squared();
            let (towards_i, towards_o) = (i.z * cos_b + k_i * sin_b, o.z * cos_b + k_o * sin_b);
            let (d, length) = (self.ndf.d_of_sum(h, self.alpha_x, self.alpha_y), length2.sqrt());
            part * (1.0 - u) * scale * d * sin_b * towards_i * towards_o / (length2 * length2 * length)
                * weight(towards_i / length, towards_o / length)
        };
        4.0 * end * self.alpha_x * self.alpha_y * RULES[0].iter().map(at).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::direction_deg;
    use crate::theory::Ndf;

    #[test]
    fn smooth_matt_surfaces_are_lambert() {
        for ndf in [Ndf::Ggx, Ndf::Beckmann, Ndf::StudentT { gamma: 3.0 }] {
            for (theta_i, theta_o, phi) in [(0.0, 0.0, 0.0), (30.0, 60.0, 40.0), (70.0, 50.0, 170.0)] {
                let (wi, wo) = (direction_deg(theta_i, 10.0), direction_deg(theta_o, phi));
                let f = Microfacet::isotropic(ndf, 1e-5).diffuse(wi, wo, Masking::HeightCorrelated);
                // Second order in the slopes: alpha^2 ln(1/alpha) tan^2, below 1e-8; the rule's own 5e-6 beside.
                assert!((f * PI - 1.0).abs() < 1e-5, "{ndf:?} {theta_i} {theta_o}: {f}");
            }
        }
    }

    #[test]
    fn matt_arms_can_be_swapped() {
        let model = Microfacet { ndf: Ndf::Ggx, alpha_x: 0.3, alpha_y: 0.8, rotation: 0.4 };
        for (theta_i, theta_o, phi) in [(10.0, 85.0, 20.0), (60.0, 60.0, 180.0), (75.0, 30.0, 100.0)] {
            let (wi, wo) = (direction_deg(theta_i, 0.0), direction_deg(theta_o, phi));
            let (there, back) =
                (model.diffuse(wi, wo, Masking::Separable), model.diffuse(wo, wi, Masking::Separable));
            // The same nodes: a few hundred terms that round otherwise.
            assert!((there / back - 1.0).abs() < 1e-13, "{there} {back}");
        }
    }

    #[test]
    fn light_along_the_normal_of_flat_arms_is_the_mean_square_cosine() {
        // Both arms the normal: the integral of D cos^2, of GGX with alpha 1 (all normals alike, D = 1/pi) 2/3.
        let found = Microfacet::isotropic(Ndf::Ggx, 1.0).facet_overlap(DVec3::Z, DVec3::Z);
        assert!((found - 2.0 / 3.0).abs() < 1e-14, "{found}");
    }
}
