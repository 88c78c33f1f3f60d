//! Fresnel reflectance of a facet: Schlick's approximation, exact dielectric and conductor, s and p apart.
//!
//! Input: the angle between an arm and the facet's normal, as (cos, sin^2), each to full relative accuracy.
//! Output: reflectance in [0, 1]. Every form below avoids the difference of nearly equal numbers, so neither
//! grazing nor normal incidence, neither a faint interface nor a strong metal needs a special case.

pub mod conductor;
pub mod dielectric;

use glam::DVec3;

use conductor::f_conductor;
use dielectric::f_dielectric;

/// The angle between an arm and the facet's normal (theta_d), by its cosine and its squared sine.
///
/// Both are kept because each is inaccurate when made from the other at one end of the range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FacetAngle {
    /// Cosine, [0, 1].
    pub cos: f64,
    /// Squared sine, [0, 1].
    pub sin2: f64,
}

impl FacetAngle {
    /// The angle at the facet that mirrors `wi` into `wo`: cos = |wi + wo|/2, sin^2 = |wi - wo|^2/4.
    ///
    /// - `wi`, `wo`: unit vectors. Swapping them gives the same bits.
    /// - Numerics: no half vector is normalised; sin^2 keeps its relative accuracy down to 0.
    // Tested by `one_minus_cos_keeps_its_digits_at_normal_incidence`.
    pub fn of_pair(wi: DVec3, wo: DVec3) -> Self {
        FacetAngle { cos: 0.5 * (wi + wo).length(), sin2: 0.25 * (wi - wo).length_squared() }
    }

    /// 1 - cos = sin^2/(1 + cos), without cancellation.
    pub fn one_minus_cos(self) -> f64 {
        self.sin2 / (1.0 + self.cos)
    }

    /// (1 - c)^5: what multiplies 1 - F0 in Schlick's formula.
    pub fn schlick_weight(self) -> f64 {
        fifth_power(self.one_minus_cos())
    }
}

/// 1 - c for the facet that mirrors `wi` into `wo`, c the cosine at the facet: s2/(1 + c), s2 = |wi - wo|^2/4.
///
/// - `wi`, `wo`: unit vectors. Returns [0, 1]; symmetric to the bit.
/// - Numerics: relative error of a few ulp also where c is 1 to rounding.
// Tested by `one_minus_cos_keeps_its_digits_at_normal_incidence`.
pub fn one_minus_cos(wi: DVec3, wo: DVec3) -> f64 {
    FacetAngle::of_pair(wi, wo).one_minus_cos()
}

/// (1 - c)^5 of a pair of directions: what multiplies 1 - F0 in Schlick's formula.
pub fn schlick_weight(wi: DVec3, wo: DVec3) -> f64 {
    fifth_power(one_minus_cos(wi, wo))
}

fn fifth_power(x: f64) -> f64 {
    let x2 = x * x;
    x2 * x2 * x
}

/// Reflectance of the two polarisations: s (field across the plane of incidence) and p (in it).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polarised {
    /// Across the plane of incidence, [0, 1].
    pub s: f64,
    /// In the plane of incidence, [0, 1].
    pub p: f64,
}

impl Polarised {
    /// Reflectance of unpolarised light: (s + p)/2.
    pub fn mean(self) -> f64 {
        0.5 * (self.s + self.p)
    }
}

/// What a facet reflects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fresnel {
    /// F = 1.
    Perfect,
    /// Schlick's approximation.
    Schlick {
        /// Reflectance at normal incidence, [0, 1].
        f0: f64,
    },
    /// A transparent medium.
    Dielectric {
        /// Index relative to the outer medium, > 0.
        eta: f64,
    },
    /// An absorbing medium, index eta + i k.
    Conductor {
        /// Real part of the index relative to the outer medium, >= 0.
        eta: f64,
        /// Imaginary part, >= 0.
        k: f64,
    },
    /// A matt facet: the same share at every angle.
    Diffuse {
        /// The share, [0, 1].
        albedo: f64,
    },
}

impl Fresnel {
    /// Reflectance of unpolarised light, [0, 1].
    ///
    /// ```
    /// use gonio::optics::{FacetAngle, Fresnel};
    /// use gonio::sphere::direction_deg;
    ///
    /// // Glass at normal incidence: ((1.5 - 1)/(1.5 + 1))^2.
    /// let up = direction_deg(0.0, 0.0);
    /// let r = Fresnel::Dielectric { eta: 1.5 }.reflectance(FacetAngle::of_pair(up, up));
    /// assert!((r - 0.04).abs() < 1e-16);
    /// ```
    pub fn reflectance(&self, angle: FacetAngle) -> f64 {
        match *self {
            Fresnel::Perfect => 1.0,
            Fresnel::Schlick { f0 } => f_schlick(angle, f0),
            Fresnel::Dielectric { eta } => f_dielectric(angle, eta).mean(),
            Fresnel::Conductor { eta, k } => f_conductor(angle, eta, k).mean(),
            Fresnel::Diffuse { albedo } => albedo,
        }
    }

    /// Reflectance of both polarisations. F = 1 and Schlick's formula know no difference.
    pub fn polarised(&self, angle: FacetAngle) -> Polarised {
        match *self {
            Fresnel::Perfect | Fresnel::Schlick { .. } | Fresnel::Diffuse { .. } => {
                let same = self.reflectance(angle);
                Polarised { s: same, p: same }
            }
            Fresnel::Dielectric { eta } => f_dielectric(angle, eta),
            Fresnel::Conductor { eta, k } => f_conductor(angle, eta, k),
        }
    }

    /// Reflectance at normal incidence: ((eta-1)^2 + k^2)/((eta+1)^2 + k^2).
    // Tested by `f0_is_the_reflectance_at_normal_incidence`.
    pub fn f0(&self) -> f64 {
        self.reflectance(FacetAngle { cos: 1.0, sin2: 0.0 })
    }
}

/// Schlick's approximation: F = F0 + (1 - F0)(1 - c)^5.
///
/// - `f0`: reflectance at normal incidence, [0, 1]. Returns [f0, 1].
/// - Numerics: 1 - c from sin^2, the power by products; right to a few ulp also for f0 = 0 near normal incidence.
/// - Source: Schlick 1994.
// Tested by `every_reference_value_is_met` (tests/it/formula_values.rs).
pub fn f_schlick(angle: FacetAngle, f0: f64) -> f64 {
    f0 + (1.0 - f0) * fifth_power(angle.one_minus_cos())
}

#[cfg(test)]
mod tests {
    use super::conductor::a_conductor;
    use super::dielectric::t_dielectric;
    use super::*;
    use crate::sphere::{direction_deg, sin_cos_deg};

    fn at_deg(theta_deg: f64) -> FacetAngle {
        let (sin, cos) = sin_cos_deg(theta_deg);
        FacetAngle { cos, sin2: sin * sin }
    }

    #[test]
    fn one_minus_cos_keeps_its_digits_at_normal_incidence() {
        for theta_deg in [1e-6, 1e-3, 1.0, 45.0, 89.0] {
            let half: f64 = 0.5 * f64::to_radians(theta_deg);
            let expected = 2.0 * half.sin().powi(2);
            let found = one_minus_cos(direction_deg(theta_deg, 0.0), direction_deg(theta_deg, 180.0));
            // sin(theta) is squared and divided: 8 roundings of at most half an ulp.
            assert!((found - expected).abs() <= 8.0 * f64::EPSILON * expected, "{theta_deg}: {found}");
        }
    }

    #[test]
    fn f0_is_the_reflectance_at_normal_incidence() {
        // (n-1)^2/(n+1)^2 with n = 1.5 is 0.04; |n-1|^2/|n+1|^2 with n = 1 + 2i is 4/8. A few roundings.
        assert!((Fresnel::Dielectric { eta: 1.5 }.f0() - 0.04).abs() < 8.0 * f64::EPSILON * 0.04);
        assert!((Fresnel::Conductor { eta: 1.0, k: 2.0 }.f0() - 0.5).abs() < 8.0 * f64::EPSILON);
        assert_eq!(Fresnel::Schlick { f0: 0.3 }.f0(), 0.3);
    }

    #[test]
    fn brewsters_angle_reflects_no_p_light() {
        for eta in [1.1, 1.5, 4.0] {
            let theta_b = f64::atan(eta);
            let angle = FacetAngle { cos: theta_b.cos(), sin2: theta_b.sin().powi(2) };
            // r_p is 0 within the rounding of the angle: a few ulp, squared.
            assert!(f_dielectric(angle, eta).p < 1e-28);
        }
        assert_eq!(f_dielectric(at_deg(30.0), 1.0), Polarised { s: 0.0, p: 0.0 });
    }

    #[test]
    fn a_conductor_without_absorption_is_the_dielectric() {
        for theta_deg in [0.0, 20.0, 50.0, 80.0, 89.9] {
            let (c, d) = (f_conductor(at_deg(theta_deg), 1.7, 0.0), f_dielectric(at_deg(theta_deg), 1.7));
            // Two forms of one number, each within 2^-52 (16 + 4 cond) with cond < 60 away from Brewster's angle.
            assert!((c.s - d.s).abs() < 1e-13 * d.s && (c.p - d.p).abs() < 1e-13 * d.p, "{theta_deg}");
        }
    }

    #[test]
    fn reflected_and_lost_light_make_one() {
        for theta_deg in [0.0, 20.0, 50.0, 80.0, 89.9] {
            let angle = at_deg(theta_deg);
            let metal =
                Fresnel::Conductor { eta: 0.2, k: 3.4 }.reflectance(angle) + a_conductor(angle, 0.2, 3.4);
            let glass = Fresnel::Dielectric { eta: 1.5 }.reflectance(angle) + t_dielectric(angle, 1.5);
            // Sums of two numbers below 1, each right to 16 ulp.
            assert!((metal - 1.0).abs() < 32.0 * f64::EPSILON, "{metal}");
            assert!((glass - 1.0).abs() < 32.0 * f64::EPSILON, "{glass}");
        }
        assert_eq!(f_dielectric(at_deg(60.0), 1.0 / 1.5).mean(), 1.0);
        assert_eq!(t_dielectric(at_deg(60.0), 1.0 / 1.5), 0.0);
    }
}
