//! Masking: Smith's G1, four ways to join the two arms into G2 and V = G2/(4 cos_i cos_o), and the masking
//! that grains have instead.
//!
//! Input: an arm as a `ArmSide`: its cosine, its *projected* Lambda (cos times Lambda, finite at the horizon) and
//! its canonical azimuth. Output: numbers without cosines, or V, which stays finite when one arm grazes.
//! Papers: Heitz 2014 (all of it); van Ginneken et al. 1998 (direction-correlated).

use glam::DVec3;

use super::grains;
use super::lambda::{beckmann_a_lambda, ggx_projected_lambda, projected_lambda};
use super::ndf::Ndf;
use super::student::student_a_lambda;

/// How shadowing and masking are joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Masking {
    /// Everything is seen: G2 = 1.
    None,
    /// G2 = G1(wi) G1(wo).
    Separable,
    /// G2 = 1/(1 + Li + Lo): both arms see from the same height.
    HeightCorrelated,
    /// G2 = 1/(1 + max + lambda min): also correlated by the azimuth between the arms.
    DirectionCorrelated,
    /// The exact one of grains: by the height of the facet.
    Grains,
    /// The same, of each arm for itself: G2 = G1(wi, h) G1(wo, h).
    GrainsProduct,
}

impl Masking {
    /// Smith's four, in the order of declaration.
    pub const ALL: [Masking; 4] =
        [Masking::None, Masking::Separable, Masking::HeightCorrelated, Masking::DirectionCorrelated];

    /// The name in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Masking::None => "none",
            Masking::Separable => "separable",
            Masking::HeightCorrelated => "height_correlated",
            Masking::DirectionCorrelated => "direction_correlated",
            Masking::Grains => "grains",
            Masking::GrainsProduct => "grains_product",
        }
    }
}

/// One arm as the masking sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmSide {
    /// Cosine of the polar angle, >= 0.
    pub cos: f64,
    /// cos * Lambda, >= 0 and finite also at the horizon.
    pub projected_lambda: f64,
    /// alpha_x w.x.
    x: f64,
    /// alpha_y w.y.
    y: f64,
    /// (alpha_x, alpha_y).
    alpha: [f64; 2],
    /// Of grains; 0 of other surfaces.
    coverage: f64,
}

impl ArmSide {
    /// The arm `w` (unit vector, sample frame, w.z >= 0) over facets of the law `ndf`.
    pub fn new(ndf: Ndf, w: DVec3, alpha_x: f64, alpha_y: f64) -> Self {
        debug_assert!(w.z >= 0.0 && alpha_x > 0.0 && alpha_y > 0.0);
        let (x, y) = (alpha_x * w.x, alpha_y * w.y);
        let s2 = x * x + y * y;
        let projected_lambda = match ndf {
            Ndf::Ggx | Ndf::Grains { .. } => ggx_projected_lambda(w.z, s2),
            Ndf::Beckmann => projected_lambda(w.z, s2, beckmann_a_lambda),
            Ndf::StudentT { .. } | Ndf::BlinnPhong => {
                let power = ndf.gamma(alpha_x * alpha_y) - 1.0;
                projected_lambda(w.z, s2, |a| student_a_lambda(a, power))
            }
        };
        let coverage = if let Ndf::Grains { coverage } = ndf { coverage } else { 0.0 };
        ArmSide { cos: w.z, projected_lambda, x, y, alpha: [alpha_x, alpha_y], coverage }
    }

    /// Smith's Lambda, [0, inf]; infinite at the horizon.
    ///
    /// GGX: s^2/(2 cos (cos + sqrt(cos^2 + s^2))) with s^2 = (ax wx)^2 + (ay wy)^2.
    /// Source: Heitz 2014, eq. 72 (isotropic).
    // Tested by `every_reference_value_is_met`.
    pub fn lambda(&self) -> f64 {
        self.projected_lambda / self.cos
    }

    /// G1 = 1/(1 + Lambda) = cos/(cos + cos Lambda), [0, 1]; 0 at the horizon.
    pub fn g1(&self) -> f64 {
        self.cos / (self.cos + self.projected_lambda)
    }

    /// Along the canonical direction, of any length.
    pub fn canonical(&self) -> DVec3 {
        DVec3::new(self.x, self.y, self.cos)
    }

    /// The cosine of the canonical normal between this arm and another.
    fn facet_cos(&self, other: &Self) -> f64 {
        let [ax, ay] = self.alpha;
        let (x, y) = ((self.x + other.x) / (ax * ax), (self.y + other.y) / (ay * ay));
        let z = self.cos + other.cos;
        z / (x * x + y * y + z * z).sqrt()
    }

    /// 1 - G1 without cancellation: cos Lambda/(cos + cos Lambda).
    pub fn one_minus_g1(&self) -> f64 {
        self.projected_lambda / (self.cos + self.projected_lambda)
    }
}

/// G1(wi) G1(wo), [0, 1]. Source: Heitz 2014, eq. 98.
// Tested by `every_reference_value_is_met`.
pub fn g2_separable(i: &ArmSide, o: &ArmSide) -> f64 {
    i.g1() * o.g1()
}

/// 1/(1 + Li + Lo), [0, 1]; 0 where one arm is at the horizon. Source: Heitz 2014, eq. 99.
// Tested by `every_reference_value_is_met`.
pub fn g2_correlated(i: &ArmSide, o: &ArmSide) -> f64 {
    let cosines = i.cos * o.cos;
    cosines / (cosines + (o.cos * i.projected_lambda + i.cos * o.projected_lambda))
}

/// 1/(1 + max(Li, Lo) + lambda min(Li, Lo)), [0, 1]; lambda as in `direction_decorrelation`.
///
/// Equals G1 of the lower arm where the azimuths coincide, and tends to the height-correlated form far from there.
/// Source: van Ginneken et al. 1998 as used in Heitz 2014.
// Tested by `coinciding_arms_mask_once`.
pub fn g2_direction_correlated(i: &ArmSide, o: &ArmSide) -> f64 {
    4.0 * i.cos * o.cos * visibility(Masking::DirectionCorrelated, i, o)
}

/// lambda = 4.41 phi/(4.41 phi + 1), phi in [0, pi] the azimuth between the canonical directions
/// (ax wi.x, ay wi.y) and (ax wo.x, ay wo.y), radians. 0 where an arm is the normal (there min(Li, Lo) = 0).
fn direction_decorrelation(i: &ArmSide, o: &ArmSide) -> f64 {
    let phi = (i.x * o.y - i.y * o.x).abs().atan2(i.x * o.x + i.y * o.y);
    let t = 4.41 * phi;
    t / (t + 1.0)
}

/// V = G2/(4 cos_i cos_o).
///
/// With M = cos Lambda of an arm (`projected_lambda`), A = cos_o M_i and B = cos_i M_o:
/// none 1/(4 cos_i cos_o); separable 1/(4 (cos_i + M_i)(cos_o + M_o)); height-correlated
/// 1/(4 (cos_i cos_o + (A + B))); direction-correlated 1/(4 (cos_i cos_o + (max(A, B) + lambda min(A, B)))); grains
/// by `theory::grains`, 0 where an arm grazes.
///
/// - Domain: cosines >= 0; not both 0, and for `Masking::None` neither, where V is infinite.
/// - Swapping the arms gives the same bits.
/// - Numerics: sums of positives; no quotient by a cosine of an arm alone, so the grazing limit needs no care.
// Tested by `every_reference_value_is_met`, `visibility_is_finite_when_one_arm_grazes`.
pub fn visibility(masking: Masking, i: &ArmSide, o: &ArmSide) -> f64 {
    let cosines = i.cos * o.cos;
    let (a, b) = (o.cos * i.projected_lambda, i.cos * o.projected_lambda);
    let denominator = match masking {
        Masking::None => cosines,
        Masking::Separable => (i.cos + i.projected_lambda) * (o.cos + o.projected_lambda),
        Masking::HeightCorrelated => cosines + (a + b),
        Masking::DirectionCorrelated => cosines + (a.max(b) + direction_decorrelation(i, o) * a.min(b)),
        Masking::Grains | Masking::GrainsProduct if cosines == 0.0 => return 0.0,
        Masking::Grains | Masking::GrainsProduct => {
            let g2 = if masking == Masking::Grains { grains::g2 } else { grains::g1_product };
            return 0.25 * g2(i.canonical(), o.canonical(), i.facet_cos(o), i.coverage) / cosines;
        }
    };
    0.25 / denominator
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::sphere::direction_deg;

    const LAWS: [Ndf; 4] = [Ndf::Ggx, Ndf::Beckmann, Ndf::StudentT { gamma: 3.5 }, Ndf::BlinnPhong];

    /// Nodes and weights of a double exponential rule: x(t), dx/dt for t = k/25.
    fn double_exponential(reach: i32, map: impl Fn(f64, f64) -> (f64, f64)) -> Vec<(f64, f64)> {
        let (step, half_pi) = (0.04, 0.5 * PI);
        let node = |k: i32| {
            let t = step * f64::from(k);
            let (x, slope) = map(half_pi * t.sinh(), half_pi * t.cosh());
            (x, step * slope)
        };
        (-reach..=reach).map(node).collect()
    }

    /// The integral of p22 max(0, cos - sin p) over the slopes, p along the arm up to its end at cot(theta), q across,
    /// both in units of alpha. p below 0 by exp-sinh, from 0 to the end by tanh-sinh in asinh(p), q by sinh-sinh.
    fn projected_area(ndf: Ndf, theta_deg: f64, alpha: f64) -> f64 {
        let w = direction_deg(theta_deg, 0.0);
        let half = 0.5 * (w.z / w.x / alpha).asinh();
        let mut along = double_exponential(110, |s, ds| (-s.exp(), s.exp() * ds));
        along.extend(double_exponential(80, |s, ds| {
            let x = half * (1.0 + s.tanh());
            (x.sinh(), x.cosh() * half * ds / s.cosh().powi(2))
        }));
        let across = double_exponential(90, |s, ds| (s.sinh(), s.cosh() * ds));
        let mut sum = 0.0;
        for &(p, dp) in &along {
            for &(q, dq) in &across {
                let slope = DVec3::new(-p * alpha, -q * alpha, 1.0);
                let hz = 1.0 / slope.length();
                let p22 = ndf.d(slope * hz, alpha, alpha) * hz.powi(4);
                sum += p22 * (w.z - w.x * p * alpha).max(0.0) * dp * dq;
            }
        }
        sum * alpha * alpha
    }

    #[test]
    fn facets_seen_from_an_arm_fill_its_view() {
        for ndf in LAWS {
            for alpha in [0.05, 0.3, 1.0] {
                for theta_deg in [10.0, 45.0, 75.0, 89.0, 89.9] {
                    let w = direction_deg(theta_deg, 0.0);
                    let seen =
                        ArmSide::new(ndf, w, alpha, alpha).g1() * projected_area(ndf, theta_deg, alpha);
                    assert!((seen / w.z - 1.0).abs() < 1e-9, "{ndf:?} {alpha} {theta_deg}: {}", seen / w.z);
                }
            }
        }
    }

    #[test]
    fn visibility_is_finite_when_one_arm_grazes() {
        for ndf in LAWS {
            let graze = ArmSide::new(ndf, DVec3::X, 0.1, 0.3);
            let high = ArmSide::new(ndf, direction_deg(30.0, 180.0), 0.1, 0.3);
            for masking in &Masking::ALL[1..] {
                let v = visibility(*masking, &graze, &high);
                assert!(v.is_finite() && v > 0.0, "{ndf:?} {masking:?}");
                assert_eq!(v, visibility(*masking, &high, &graze));
            }
            assert_eq!((graze.g1(), graze.one_minus_g1()), (0.0, 1.0));
            assert_eq!(graze.lambda(), f64::INFINITY);
            // Both Lambdas there are cos Lambda/cos: the limit is 1/(4 cos_o M_i) for both correlated forms.
            let limit = 0.25 / (high.cos * graze.projected_lambda);
            assert_eq!(visibility(Masking::HeightCorrelated, &graze, &high), limit);
            assert_eq!(visibility(Masking::DirectionCorrelated, &graze, &high), limit);
        }
    }

    #[test]
    fn coinciding_arms_mask_once() {
        for ndf in LAWS {
            for theta_deg in [1e-6, 20.0, 70.0, 89.99] {
                let side = ArmSide::new(ndf, direction_deg(theta_deg, 33.0), 0.5, 0.2);
                // Three products and a quotient on each side.
                let (both, one) = (g2_direction_correlated(&side, &side), side.g1());
                assert!((both - one).abs() <= 8.0 * f64::EPSILON * one, "{ndf:?} {theta_deg}: {both} {one}");
            }
        }
    }

    #[test]
    fn maskings_are_ordered() {
        // max + lambda min <= Li + Lo and (1 + Li)(1 + Lo) >= 1 + Li + Lo; each form rounds to 8 ulp.
        let room = 1.0 + 16.0 * f64::EPSILON;
        for ndf in LAWS {
            for (theta_i, theta_o, phi) in [(10.0, 80.0, 0.0), (60.0, 60.0, 90.0), (89.9, 30.0, 180.0)] {
                let i = ArmSide::new(ndf, direction_deg(theta_i, 0.0), 0.7, 0.3);
                let o = ArmSide::new(ndf, direction_deg(theta_o, phi), 0.7, 0.3);
                let (direction, height) = (g2_direction_correlated(&i, &o), g2_correlated(&i, &o));
                assert!(
                    g2_separable(&i, &o) <= height * room && height <= direction * room && direction <= room
                );
            }
        }
    }
}
