//! Unit vectors and angles: directions from polar angles and back, without `acos` and without loss at the pole
//! or at the horizon. Angles in radians unless a name ends in `_deg`.

use glam::DVec3;
use std::f64::consts::TAU;

/// Sine and cosine of an angle in degrees; exact at the multiples of 90, and symmetric about them.
///
/// - `deg`: finite. Reduced by whole quarter turns before any rounding: sin_cos_deg(360 + x) = sin_cos_deg(x).
/// - Numerics: above 45 degrees the complement is taken, so that cos(89.99) keeps every digit of 90 - 89.99.
// Tested by `right_angles_are_exact`.
pub fn sin_cos_deg(deg: f64) -> (f64, f64) {
    let turn = deg.rem_euclid(360.0);
    let quadrant = (turn / 90.0).floor();
    let rest = turn - 90.0 * quadrant;
    let (s, c) = if rest <= 45.0 {
        rest.to_radians().sin_cos()
    } else {
        let (c, s) = (90.0 - rest).to_radians().sin_cos();
        (s, c)
    };
    match quadrant as i32 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        3 => (-c, s),
        _ => (0.0, 1.0), // rem_euclid rounds tiny negatives up to a full turn
    }
}

/// The unit vector at polar angle `theta_deg` from +z and azimuth `phi_deg` from +x.
///
/// ```
/// let along_y = gonio::sphere::direction_deg(90.0, 90.0);
/// assert_eq!((along_y.x, along_y.y, along_y.z), (0.0, 1.0, 0.0));
/// ```
pub fn direction_deg(theta_deg: f64, phi_deg: f64) -> DVec3 {
    let (sin_theta, cos_theta) = sin_cos_deg(theta_deg);
    let (sin_phi, cos_phi) = sin_cos_deg(phi_deg);
    DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

/// The unit vector at polar angle `theta` from +z and azimuth `phi` from +x, radians.
pub fn direction(theta: f64, phi: f64) -> DVec3 {
    let (sin_theta, cos_theta) = theta.sin_cos();
    let (sin_phi, cos_phi) = phi.sin_cos();
    DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

/// Polar angle of `w` from +z in [0, pi]; `w` need not be a unit vector. Stable at the pole, unlike acos.
pub fn theta(w: DVec3) -> f64 {
    w.x.hypot(w.y).atan2(w.z)
}

/// Azimuth of `w` in [0, 2 pi); 0 at the pole.
pub fn phi(w: DVec3) -> f64 {
    // The pole has x and y of either sign of 0, which atan2 would tell apart.
    let phi = (w.y + 0.0).atan2(w.x + 0.0);
    let turned = if phi < 0.0 { phi + TAU } else { phi };
    if turned < TAU { turned + 0.0 } else { 0.0 }
}

/// `w` turned about +z, counter-clockwise seen from +z, by the angle with this sine and cosine.
pub fn turned(w: DVec3, (sin, cos): (f64, f64)) -> DVec3 {
    DVec3::new(cos * w.x - sin * w.y, sin * w.x + cos * w.y, w.z)
}

/// Azimuth in degrees reduced to [0, 360), never -0; exact for multiples of a power of two.
// Tested by `azimuths_that_are_the_same_reduce_to_the_same_bits`.
pub fn reduced_deg(phi_deg: f64) -> f64 {
    let phi = phi_deg.rem_euclid(360.0);
    // A tiny negative angle rounds up to 360 itself.
    if phi < 360.0 { phi + 0.0 } else { 0.0 }
}

/// Two unit vectors that complete the unit vector `axis` to a right-handed frame (tangent, bitangent, axis).
///
/// Source: Duff et al. 2017, "Building an orthonormal basis, revisited"; glam's own method of that paper.
pub fn frame(axis: DVec3) -> (DVec3, DVec3) {
    axis.any_orthonormal_pair()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_angles_are_exact() {
        assert_eq!(direction_deg(0.0, 0.0), DVec3::Z);
        assert_eq!(direction_deg(90.0, 90.0), DVec3::Y);
        assert_eq!(direction_deg(90.0, 180.0), -DVec3::X);
        assert_eq!(direction_deg(30.0, 360.0), direction_deg(30.0, 0.0));
        assert_eq!(direction_deg(30.0, -90.0), direction_deg(30.0, 270.0));
        assert_eq!(sin_cos_deg(-1e-30), (0.0, 1.0));
    }

    #[test]
    fn angles_round_trip_at_the_pole_and_at_the_horizon() {
        for theta_deg in [0.0, 1e-9, 1e-6, 0.01, 30.0, 89.0, 89.99, 89.999_999_999] {
            let w = direction_deg(theta_deg, 210.0);
            // A relative error of 4 ulp on the angle: sin, cos, hypot and atan2 each round once.
            let expected = f64::to_radians(theta_deg);
            assert!((theta(w) - expected).abs() <= 4.0 * f64::EPSILON * expected, "{theta_deg}");
            if theta_deg > 0.0 {
                assert!((phi(w).to_degrees() - 210.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn azimuth_is_never_a_full_turn() {
        assert_eq!(phi(DVec3::new(1.0, -0.0, 0.0)), 0.0);
        assert_eq!(phi(DVec3::new(1.0, -1e-300, 0.0)), 0.0);
        for (x, y) in [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0), (-0.0, -0.0)] {
            assert_eq!(phi(DVec3::new(x, y, 1.0)), 0.0);
        }
    }

    #[test]
    fn azimuths_that_are_the_same_reduce_to_the_same_bits() {
        for phi_deg in [0.0, -0.0, 360.0, -360.0, 720.0, -1e-20] {
            assert_eq!(reduced_deg(phi_deg).to_bits(), 0f64.to_bits(), "{phi_deg}");
        }
        assert_eq!(reduced_deg(-90.0), 270.0);
        assert_eq!(reduced_deg(359.999), 359.999);
    }
}
