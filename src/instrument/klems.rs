//! The Klems full basis: 145 patches of the hemisphere in nine rings.
//!
//! Patch j of a ring of n is centred on azimuth 360 j/n. A patch of the light names the direction in which light
//! travels on, so its stop stands opposite. Source: Radiance's bsdf_m.c, after Klems and Warner 1995.

use crate::sphere;

/// Polar angles of a ring in degrees, and how many patches it has.
pub type Ring = (f64, f64, usize);

/// The rings of the full basis.
pub const FULL: [Ring; 9] = [
    (0.0, 5.0, 1),
    (5.0, 15.0, 8),
    (15.0, 25.0, 16),
    (25.0, 35.0, 20),
    (35.0, 45.0, 24),
    (45.0, 55.0, 24),
    (55.0, 65.0, 24),
    (65.0, 75.0, 16),
    (75.0, 90.0, 12),
];

/// The patches of a basis, ring by ring: [theta_lo, theta_hi, phi_lo, phi_hi] in degrees.
pub fn patches(rings: &[Ring]) -> Vec<[f64; 4]> {
    let ring = |&(low, high, n): &Ring| {
        let step = 360.0 / n as f64;
        (0..n).map(move |j| [low, high, step * (j as f64 - 0.5), step * (j as f64 + 0.5)])
    };
    rings.iter().flat_map(ring).collect()
}

/// (theta_i, phi_i) in degrees of the stops in the middle of the light's patches; of a whole ring's at its upper edge.
pub fn middles(light: &[[f64; 4]]) -> Vec<[f64; 2]> {
    let middle = |&[t1, t2, p1, p2]: &[f64; 4]| {
        let theta = if p2 - p1 == 360.0 { t1 } else { 0.5 * (t1 + t2) };
        [theta, sphere::reduced_deg(0.5 * (p1 + p2) + 180.0)]
    };
    light.iter().map(middle).collect()
}
