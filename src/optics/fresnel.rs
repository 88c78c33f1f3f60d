//! Fresnel reflectance of a facet: Schlick's approximation, exact dielectric and conductor, s and p apart.
//!
//! Input: the angle between an arm and the facet's normal, as (cos, sin^2), each to full relative accuracy.
//! Output: reflectance in [0, 1]. Every form below avoids the difference of nearly equal numbers, so neither
//! grazing nor normal incidence, neither a faint interface nor a strong metal needs a special case.

use glam::DVec3;

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

/// Reflectance of a dielectric: with m = eta^2 - 1 and g = sqrt(m + c^2),
/// r_s = m/(c + g)^2, r_p = m((eta^2 + 1)c^2 - 1)/(eta^2 c + g)^2 (up to sign), R = r^2.
///
/// - `eta`: index relative to the outer medium, > 0; below 1 there is total reflection, which gives exactly 1.
/// - Numerics: m = (eta - 1)(eta + 1); no difference of cosines, so R is 0 to rounding at eta = 1 and at
///   Brewster's angle.
/// - Source: Fresnel's equations, rationalised.
// Tested by `every_reference_value_is_met`, `brewsters_angle_reflects_no_p_light`.
pub fn f_dielectric(angle: FacetAngle, eta: f64) -> Polarised {
    let amplitudes = dielectric_amplitudes(angle, eta);
    amplitudes.map_or(Polarised { s: 1.0, p: 1.0 }, |[s, p]| Polarised { s: s * s, p: p * p })
}

/// The amplitudes r_s and r_p of a dielectric, as `f_dielectric` has them, with p = k x s; `None` in total reflection.
pub(super) fn dielectric_amplitudes(angle: FacetAngle, eta: f64) -> Option<[f64; 2]> {
    DielectricTerms::new(angle, eta).map(|d| {
        let r_s = -d.m / (d.across * d.across);
        let r_p = d.m * ((d.eta2 + 1.0) * d.c * d.c - 1.0) / (d.along * d.along);
        [r_s, r_p]
    })
}

/// What a dielectric transmits, unpolarised: 1 - F = (T_s + T_p)/2 with T_s = 4 c g/(c + g)^2 and
/// T_p = 4 eta^2 c g/(eta^2 c + g)^2.
///
/// - Same domain as `f_dielectric`; 0 in total reflection.
/// - Numerics: a product, so it keeps its digits at grazing incidence where 1 - F has none.
// Tested by `every_reference_value_is_met`.
pub fn t_dielectric(angle: FacetAngle, eta: f64) -> f64 {
    DielectricTerms::new(angle, eta).map_or(0.0, |d| {
        let four_cg = 4.0 * d.c * d.g;
        0.5 * (four_cg / (d.across * d.across) + d.eta2 * four_cg / (d.along * d.along))
    })
}

struct DielectricTerms {
    c: f64,
    g: f64,
    m: f64,
    eta2: f64,
    /// c + g.
    across: f64,
    /// eta^2 c + g.
    along: f64,
}

impl DielectricTerms {
    /// `None` in total reflection.
    fn new(angle: FacetAngle, eta: f64) -> Option<Self> {
        debug_assert!(eta > 0.0);
        let c = angle.cos;
        let m = (eta - 1.0) * (eta + 1.0);
        let g2 = m + c * c;
        if g2 <= 0.0 {
            return None;
        }
        let (g, eta2) = (g2.sqrt(), eta * eta);
        Some(DielectricTerms { c, g, m, eta2, across: c + g, along: eta2 * c + g })
    }
}

/// Reflectance of a conductor of index n = eta + i k: with a + i b = sqrt(n^2 - s2), Q + i u = n^2 - 1,
/// R_s = |n^2 - 1|^2/|c + a + i b|^4,
/// R_p = |n^2 - 1|^2 |(n^2 - 1) c^2 + c^2 - s2|^2/|n^2 c + a + i b|^4.
///
/// - `eta`, `k`: relative to the outer medium, >= 0 and not both 0. k = 0 with eta > 1 is the dielectric.
/// - Numerics: the larger of a, b from the root, the smaller as u/2 over it; differences as products. Relative
///   error within 2^-52 (16 + 4 cond) for k/eta up to 1e7.
/// - Source: Fresnel's equations, rationalised.
// Tested by `every_reference_value_is_met`, `a_conductor_without_absorption_is_the_dielectric`.
pub fn f_conductor(angle: FacetAngle, eta: f64, k: f64) -> Polarised {
    let t = ConductorTerms::new(angle, eta, k);
    let (c2, s2) = (t.c * t.c, angle.sin2);
    let q = (eta - 1.0) * (eta + 1.0) - k * k;
    let n2_minus_1 = q * q + t.u * t.u;
    let (x, y) = (q * c2 + (c2 - s2), t.u * c2);
    Polarised { s: n2_minus_1 / (t.across * t.across), p: n2_minus_1 * (x * x + y * y) / (t.along * t.along) }
}

/// r_s conj(r_p) of a conductor, [re, im], for a field E exp(-i w t) and p = k x s:
/// -|n^2 - 1|^2 conj(y w^2 conj(v)^2)/(|w|^4 |v|^4) with y = n^2 c^2 - s2, w = c + a + i b, v = n^2 c + a + i b.
///
/// - Same domain and notation as `f_conductor`; |r_s conj(r_p)|^2 = R_s R_p.
// Tested by `facets_turn_polarised_light_as_reference_values_say` (tests/it/facets/mueller.rs).
pub(super) fn conductor_product(angle: FacetAngle, eta: f64, k: f64) -> [f64; 2] {
    let t = ConductorTerms::new(angle, eta, k);
    let times = |[x, y]: [f64; 2], [p, q]: [f64; 2]| [x * p - y * q, x * q + y * p];
    let square = |z: [f64; 2]| times(z, z);
    let q = (eta - 1.0) * (eta + 1.0) - k * k;
    let y = [q * t.c * t.c + (t.c * t.c - angle.sin2), t.u * t.c * t.c];
    let (w, v) = ([t.c + t.a, t.b], [t.n2_re * t.c + t.a, t.u * t.c + t.b]);
    let [re, im] = times(y, times(square(w), square([v[0], -v[1]])));
    let scale = (q * q + t.u * t.u) / (t.across * t.across * t.along * t.along);
    [-scale * re, scale * im]
}

/// What a conductor absorbs, unpolarised: 1 - F = (A_s + A_p)/2 with A_s = 4 a c/((c + a)^2 + b^2) and
/// A_p = 4 c (Re(n^2) a + u b)/|n^2 c + a + i b|^2.
///
/// - Same domain and notation as `f_conductor`.
/// - Numerics: keeps its digits for metals that reflect all but 1e-9, where 1 - F has none.
// Tested by `every_reference_value_is_met`.
pub fn a_conductor(angle: FacetAngle, eta: f64, k: f64) -> f64 {
    let t = ConductorTerms::new(angle, eta, k);
    let a_s = 4.0 * t.a * t.c / t.across;
    let a_p = 4.0 * t.c * (t.n2_re * t.a + t.u * t.b) / t.along;
    0.5 * (a_s + a_p)
}

struct ConductorTerms {
    c: f64,
    a: f64,
    b: f64,
    u: f64,
    n2_re: f64,
    /// |c + a + i b|^2.
    across: f64,
    /// |n^2 c + a + i b|^2.
    along: f64,
}

impl ConductorTerms {
    fn new(angle: FacetAngle, eta: f64, k: f64) -> Self {
        debug_assert!(eta >= 0.0 && k >= 0.0 && eta + k > 0.0);
        let (c, s2) = (angle.cos, angle.sin2);
        let n2_re = (eta - k) * (eta + k);
        let (t, u) = (n2_re - s2, 2.0 * eta * k);
        let m = t.hypot(u);
        let (a, b) = if t >= 0.0 {
            let a = (0.5 * (m + t)).sqrt();
            (a, if a > 0.0 { 0.5 * u / a } else { 0.0 })
        } else {
            let b = (0.5 * (m - t)).sqrt();
            (0.5 * u / b, b)
        };
        let (p, q) = (n2_re * c + a, u * c + b);
        ConductorTerms { c, a, b, u, n2_re, across: (c + a) * (c + a) + b * b, along: p * p + q * q }
    }
}

#[cfg(test)]
mod tests {
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
