//! Directions of the light's cone.

use glam::DVec3;

use crate::sphere;

/// A direction of the light's cone: uniform in *projected* solid angle over the cone about `axis`.
///
/// In polar coordinates (psi, eta) about the axis the density is (cos psi cos t + sin psi sin t cos eta) sin psi,
/// t the axis's polar angle: sin^2 psi is uniform on [0, sin^2 a], and eta has density 1 + k cos eta with
/// k = tan psi tan t <= 1 for a cone above the horizon. `u`, `v` in [0, 1).
// Tested by `the_light_cone_is_uniform_in_projected_solid_angle`.
pub fn direction_in_cone(axis: DVec3, half_angle: f64, u: f64, v: f64) -> DVec3 {
    if half_angle == 0.0 {
        return axis;
    }
    let sin_psi = half_angle.sin() * u.sqrt();
    let cos_psi = (1.0 - sin_psi * sin_psi).sqrt();
    let horizontal = axis.x.hypot(axis.y);
    let k = sin_psi / cos_psi * horizontal / axis.z;
    let eta = azimuth_quantile(k, v);
    // The tangent that points up: towards larger cos theta, which eta counts from.
    let (up, side) = if horizontal > 0.0 {
        let up = DVec3::new(-axis.x * axis.z, -axis.y * axis.z, horizontal * horizontal) / horizontal;
        (up, axis.cross(up))
    } else {
        sphere::frame(axis)
    };
    cos_psi * axis + sin_psi * (eta.cos() * up + eta.sin() * side)
}

/// Solves (eta + k sin eta)/(2 pi) = v for eta in [0, 2 pi), 0 <= k <= 1, by bisection: 53 halvings are exact.
fn azimuth_quantile(k: f64, v: f64) -> f64 {
    let wanted = std::f64::consts::TAU * v;
    let (mut low, mut high) = (0.0, std::f64::consts::TAU);
    for _ in 0..53 {
        let middle = 0.5 * (low + high);
        if middle + k * middle.sin() < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_light_cone_is_uniform_in_projected_solid_angle() {
        let (axis, half_angle) = (sphere::direction_deg(60.0, 25.0), 20f64.to_radians());
        // Uniform in projected solid angle = uniform over the cap's projection onto the stage: its centroid is that
        // of a tilted disc of radius sin a at height cos a, which projects onto cos a (axis.x, axis.y).
        let n = 200;
        let mut centroid = DVec3::ZERO;
        let mut square = 0.0;
        for i in 0..n * n {
            let (u, v) = ((0.5 + f64::from(i % n)) / f64::from(n), (0.5 + f64::from(i / n)) / f64::from(n));
            let w = direction_in_cone(axis, half_angle, u, v);
            assert!((w.length() - 1.0).abs() < 1e-14 && w.dot(axis) >= half_angle.cos() - 1e-14);
            centroid += w / f64::from(n * n);
            square += w.dot(DVec3::new(-axis.y, axis.x, 0.0).normalize()).powi(2) / f64::from(n * n);
        }
        // The projection is not a disc: the cap is the union of rings of radius sin psi at cos psi, ring by ring
        // uniform in sin^2 psi: mean of cos psi is 2 (1 - cos^3 a)/(3 sin^2 a), plus the shift by k/2 of each ring.
        let (s, c) = half_angle.sin_cos();
        let mean_cos = 2.0 * (1.0 - c.powi(3)) / (3.0 * s * s);
        let horizontal = 60f64.to_radians().sin();
        // Ring's mean along `up` is k/2 sin psi = sin^2 psi/(2 cos psi) tan t; `up` has horizontal part -cos t.
        let mean_ring: f64 = (0..2000)
            .map(|j| (f64::from(j) + 0.5) / 2000.0 * s * s)
            .map(|s2| 0.5 * s2 / (1.0 - s2).sqrt() * 3f64.sqrt())
            .sum::<f64>()
            / 2000.0;
        let expected = mean_cos * horizontal - mean_ring * 0.5;
        let found = centroid.x.hypot(centroid.y);
        // The midpoint rule over 200 x 200 points of a smooth function: error of order 1/200^2.
        assert!((found - expected).abs() < 5e-5, "{found} {expected}");
        // Across the plane of the axis the mean square is sin^2 a/4, as for a disc.
        assert!((square - s * s / 4.0).abs() < 1e-4, "{square} {}", s * s / 4.0);
    }
}
