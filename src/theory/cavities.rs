//! The two classical models on V-shaped cavities: Cook-Torrance and Torrance-Sparrow, 1/sr, without cosine.
//!
//! Input: a pair of directions in the sample's frame and the width of the law of tilts. Output: D G/(4 cos cos) with
//! F = 1 and the cavities' own G. Papers: Torrance and Sparrow 1967; Cook and Torrance 1982 (whose factor 1/pi is
//! written 1/4 today, so that D is a density of normals).

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::ndf::beckmann_d_of_sum;

/// G/(4 cos_i cos_o) of the cavities: min(1/(4 cos_i cos_o), cos_h/(2 c max(cos_i, cos_o))), c = wi.h.
///
/// - `wi`, `wo`: unit vectors, not both in the horizon. Swapping them gives the same bits.
/// - Numerics: 2 c = |wi + wo| and cos_h = (wi + wo).z/|wi + wo|: no quotient by the cosine of a grazing arm alone.
/// - Source: Torrance and Sparrow 1967.
// Tested by `cavities_agree_with_their_g`.
pub fn cavity_visibility(wi: DVec3, wo: DVec3) -> f64 {
    let h = wi + wo;
    let open = h.z / (h.length_squared() * wi.z.max(wo.z));
    open.min(0.25 / (wi.z * wo.z))
}

/// Cook and Torrance: Beckmann's D of rms slope m (alpha = m) with the cavities' G, F = 1.
///
/// - `m` > 0. Domain as `cavity_visibility`.
// Tested by `cavities_agree_with_their_g`.
pub fn cook_torrance(wi: DVec3, wo: DVec3, m: f64) -> f64 {
    beckmann_d_of_sum(wi + wo, m, m) * cavity_visibility(wi, wo)
}

/// Torrance and Sparrow: tilts theta_h with D = b exp(-(theta_h/m)^2), F = 1; `b` from `gaussian_tilt_scale`.
///
/// - `m` > 0, rad. Domain as `cavity_visibility`.
// Tested by `tilts_are_normalised`.
pub fn torrance_sparrow(wi: DVec3, wo: DVec3, m: f64, b: f64) -> f64 {
    let h = wi + wo;
    let tilt = h.x.hypot(h.y).atan2(h.z) / m;
    b * (-tilt * tilt).exp() * cavity_visibility(wi, wo)
}

/// b with b * integral of exp(-(t/m)^2) cos t over the hemisphere = 1.
///
/// - `m` > 0. Numerics: trapezoid in t up to 9 m (or the horizon), Gaussian ends: relative error below 1e-6.
// Tested by `tilts_are_normalised`.
pub fn gaussian_tilt_scale(m: f64) -> f64 {
    let steps = 2000;
    let end = (9.0 * m).min(FRAC_PI_2);
    let step = end / f64::from(steps);
    let density = |t: f64| (-(t / m) * (t / m)).exp() * t.sin() * t.cos();
    let sum: f64 = (1..steps).map(|k| density(step * f64::from(k))).sum();
    1.0 / (2.0 * PI * step * sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::direction_deg;
    use crate::theory::v_cavity::torrance_sparrow_g;

    #[test]
    fn cavities_agree_with_their_g() {
        for (theta_i, theta_o, phi) in
            [(10.0, 20.0, 50.0), (70.0, 80.0, 180.0), (85.0, 5.0, 90.0), (60.0, 60.0, 0.0)]
        {
            let (wi, wo) = (direction_deg(theta_i, 0.0), direction_deg(theta_o, phi));
            let g = torrance_sparrow_g((wi + wo).normalize(), wi, wo);
            let (found, expected) = (cavity_visibility(wi, wo), g / (4.0 * wi.z * wo.z));
            // A dozen roundings on either side.
            assert!((found - expected).abs() < 32.0 * f64::EPSILON * expected, "{found} {expected}");
            assert_eq!(found.to_bits(), cavity_visibility(wo, wi).to_bits());
        }
        assert!(cavity_visibility(DVec3::X, direction_deg(30.0, 180.0)).is_finite());
    }

    #[test]
    fn tilts_are_normalised() {
        for m in [0.01, 0.2, 1.0, 5.0] {
            let b = gaussian_tilt_scale(m);
            // Midpoint in u = sin^2 t: pi b integral of exp(-(t/m)^2) du, an independent rule; error below 1e-5.
            let steps = 1_000_000;
            let sum: f64 = (0..steps)
                .map(|k| ((f64::from(k) + 0.5) / f64::from(steps)).sqrt().asin() / m)
                .map(|t| (-t * t).exp())
                .sum();
            let whole = PI * b * sum / f64::from(steps);
            assert!((whole - 1.0).abs() < 2e-5, "{m}: {whole}");
        }
    }
}
