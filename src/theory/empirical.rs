//! Models that are fitted and not derived: Lambert, Oren-Nayar, Phong and Blinn-Phong, 1/sr, without cosine.
//!
//! Input: a pair of directions above the horizon and the shape parameter. Output: the value for an amplitude of 1.
//! Papers: Oren and Nayar 1994; Phong 1975 as normalised by Lafortune and Willems 1994; Blinn 1977.

use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;

/// Lambert's 1/pi: an albedo of 1.
pub const LAMBERT: f64 = FRAC_1_PI;

/// Oren and Nayar's qualitative model for an albedo of 1: (A + B max(0, cos dphi) sin a tan b)/pi.
///
/// A = 1 - s^2/(2 (s^2 + 0.33)), B = 0.45 s^2/(s^2 + 0.09); a the larger, b the smaller polar angle. With
/// t = wi.wo - cos_i cos_o = sin_i sin_o cos dphi the last factor is max(0, t)/max(cos_i, cos_o).
///
/// - `sigma`: rms tilt of the facets, rad; its sign does not matter. `wi`, `wo`: unit vectors, not both in the horizon.
/// - Numerics: no tan, no azimuth. Source: Oren and Nayar 1994, the simplified form.
// Tested by `oren_nayar_of_a_smooth_surface_is_lambert`, `empirical_models_have_their_printed_values`.
pub fn oren_nayar(wi: DVec3, wo: DVec3, sigma: f64) -> f64 {
    let s2 = sigma * sigma;
    let (a, b) = (1.0 - 0.5 * s2 / (s2 + 0.33), 0.45 * s2 / (s2 + 0.09));
    let across = wi.x * wo.x + wi.y * wo.y;
    LAMBERT * (a + b * across.max(0.0) / wi.z.max(wo.z))
}

/// Oren and Nayar's full model of light reflected once, for an albedo of 1:
/// (C1 + cos dphi C2 tan b + (1 - |cos dphi|) C3 tan((a + b)/2))/pi.
///
/// C1 = 1 - s^2/(2 (s^2 + 0.33)); C2 = 0.45 s^2/(s^2 + 0.09) sin a, less (2 b/pi)^3 under the bracket where cos dphi < 0;
/// C3 = 0.125 s^2/(s^2 + 0.09) (4 a b/pi^2)^2; a the larger, b the smaller polar angle.
///
/// - Domain as `oren_nayar`. Swapping the arms gives the same bits.
/// - Numerics: angles by atan2. Source: Oren and Nayar 1994, the full model.
// Tested by `oren_nayars_full_model_meets_its_reference` (tests/it/diffuse_values.rs).
pub fn oren_nayar_full(wi: DVec3, wo: DVec3, sigma: f64) -> f64 {
    let (s2, [a, b], cos) = (sigma * sigma, polar_angles(wi, wo), cos_between_azimuths(wi, wo));
    let away = if cos < 0.0 { (2.0 * b / PI).powi(3) } else { 0.0 };
    let c1 = 1.0 - 0.5 * s2 / (s2 + 0.33);
    let c2 = 0.45 * s2 / (s2 + 0.09) * (a.sin() - away);
    let c3 = 0.125 * s2 / (s2 + 0.09) * (4.0 * a * b / (PI * PI)).powi(2);
    LAMBERT * (c1 + cos * c2 * b.tan() + (1.0 - cos.abs()) * c3 * (0.5 * (a + b)).tan())
}

/// Oren and Nayar's light reflected twice, over the square of the albedo: 0.17 s^2/(s^2 + 0.13) (1 - cos dphi (2 b/pi)^2)/pi.
///
/// - Domain as `oren_nayar`. Source: Oren and Nayar 1994, the full model.
// Tested by `oren_nayars_full_model_meets_its_reference` (tests/it/diffuse_values.rs).
pub fn oren_nayar_twice(wi: DVec3, wo: DVec3, sigma: f64) -> f64 {
    let (s2, [_, b], cos) = (sigma * sigma, polar_angles(wi, wo), cos_between_azimuths(wi, wo));
    LAMBERT * 0.17 * s2 / (s2 + 0.13) * (1.0 - cos * (2.0 * b / PI).powi(2))
}

/// The larger and the smaller polar angle.
fn polar_angles(wi: DVec3, wo: DVec3) -> [f64; 2] {
    let [i, o] = [wi, wo].map(|w| w.x.hypot(w.y).atan2(w.z));
    [i.max(o), i.min(o)]
}

/// cos dphi; 1 where an arm is the normal and has no azimuth: there everything that it multiplies is 0.
fn cos_between_azimuths(wi: DVec3, wo: DVec3) -> f64 {
    let (across, along) = (wi.x * wo.y - wi.y * wo.x, wi.x * wo.x + wi.y * wo.y);
    across.atan2(along).cos()
}

/// Phong's lobe about the mirror direction: (n + 2)/(2 pi) max(0, r.wo)^n.
///
/// - `exponent` n > -2. The albedo at normal incidence is 1; it is smaller elsewhere.
/// - Source: Lafortune and Willems 1994.
// Tested by `phong_reflects_all_at_normal_incidence`.
pub fn phong(wi: DVec3, wo: DVec3, exponent: f64) -> f64 {
    let towards = wi.z * wo.z - wi.x * wo.x - wi.y * wo.y;
    (exponent + 2.0) / (2.0 * PI) * towards.max(0.0).powf(exponent)
}

/// Blinn's lobe about the half vector: (n + 8)/(8 pi) (h.n)^n.
///
/// - `exponent` n > 0. Source: Blinn 1977 (the lobe); the factor is the usual one of real-time rendering.
// Tested by `empirical_models_have_their_printed_values`.
pub fn blinn_phong(wi: DVec3, wo: DVec3, exponent: f64) -> f64 {
    let h = wi + wo;
    (exponent + 8.0) / (8.0 * PI) * (h.z / h.length()).max(0.0).powf(exponent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::{direction, direction_deg};

    #[test]
    fn oren_nayar_of_a_smooth_surface_is_lambert() {
        assert_eq!(oren_nayar(direction_deg(40.0, 0.0), direction_deg(70.0, 20.0), 0.0), LAMBERT);
    }

    #[test]
    fn empirical_models_have_their_printed_values() {
        let (wi, wo) = (direction_deg(60.0, 0.0), direction_deg(30.0, 60.0));
        // sigma 0.3: A = 1 - 0.045/0.42, B = 0.0405/0.18; sin 60 tan 30 = 1/2, cos 60 = 1/2.
        let expected = (1.0 - 0.045 / 0.42 + 0.0405 / 0.18 * 0.25) / PI;
        // A dozen roundings of numbers near 1.
        assert!((oren_nayar(wi, wo, 0.3) - expected).abs() < 1e-15);
        // Far azimuths: the second term is 0.
        let far = oren_nayar(wi, direction_deg(30.0, 180.0), 0.3);
        assert!((far - (1.0 - 0.045 / 0.42) / PI).abs() < 1e-15);
        // h at 45 degrees from the normal: (1/sqrt 2)^4 = 1/4.
        let blinn = blinn_phong(DVec3::X, DVec3::Z, 4.0);
        assert!((blinn - 12.0 / (8.0 * PI) / 4.0).abs() < 1e-15);
    }

    #[test]
    fn phong_reflects_all_at_normal_incidence() {
        // Midpoint rule in theta: 2 pi sum f cos sin dtheta, error below (dtheta)^2 n^2.
        for exponent in [1.0, 10.0, 40.0] {
            let (steps, mut sum) = (20_000, 0.0);
            for k in 0..steps {
                let theta = (f64::from(k) + 0.5) * 0.5 * PI / f64::from(steps);
                sum += phong(DVec3::Z, direction(theta, 0.3), exponent) * theta.cos() * theta.sin();
            }
            let albedo = 2.0 * PI * sum * 0.5 * PI / f64::from(steps);
            assert!((albedo - 1.0).abs() < 1e-5, "{exponent}: {albedo}");
        }
    }
}
