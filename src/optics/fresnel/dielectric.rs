//! A transparent facet: what it reflects, in s and in p, and what it transmits.

use super::{FacetAngle, Polarised};

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
pub(in crate::optics) fn dielectric_amplitudes(angle: FacetAngle, eta: f64) -> Option<[f64; 2]> {
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
