//! A metal's facet: what it reflects, in s and in p, and what it absorbs.

use super::{FacetAngle, Polarised};

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
pub(in crate::optics) fn conductor_product(angle: FacetAngle, eta: f64, k: f64) -> [f64; 2] {
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
