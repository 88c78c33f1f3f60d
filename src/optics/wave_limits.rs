//! Where geometric optics holds: a rough surface's heights and curvatures over the wavelength.
//!
//! Two conditions, each with its figure. The heights must spread the phase of what is reflected, or part of it stays in step
//! (a coherent mirror lobe, which rays know nothing of): 4 pi sigma cos(theta)/lambda, sigma the rms height. And light must
//! see a facet as a plane that has no end: 4 pi r cos(theta) much larger than lambda, r the radius of curvature.
//! Sources: Rayleigh's criterion as in Beckmann and Spizzichino 1963, sections 2.1 and 5.3 (limit pi/2; pi/8 by
//! Fraunhofer's, for optical work), and section 3.1 there for the tangent plane (Kirchhoff).

use std::f64::consts::PI;

/// Phase, rad, below which a surface is smooth by Rayleigh's criterion.
pub const RAYLEIGH: f64 = PI / 2.0;
/// Phase, rad, below which it is smooth by Fraunhofer's: hardly anything but the mirror direction is seen.
pub const FRAUNHOFER: f64 = PI / 8.0;
/// What "much larger" is read as: ten times. With the mean radius of curvature it is r > 0.8 lambda at normal incidence, near
/// r > lambda of Ulaby, Moore and Fung 1982, section 12-4.
pub const KIRCHHOFF: f64 = 10.0;

/// Rayleigh's parameter 4 pi sigma cos(theta)/lambda, rad: the rms difference of phase between what is reflected by heights
/// sigma apart. Lengths in one unit.
// Tested by `figures_are_their_closed_forms` (tests/it/validate/wave_limits.rs).
pub fn rayleigh(rms_height: f64, cos_theta: f64, wavelength: f64) -> f64 {
    phase(rms_height, cos_theta, cos_theta, wavelength)
}

/// The same for a pair of directions: 2 pi sigma (cos(theta_i) + cos(theta_r))/lambda, rad.
pub fn phase(rms_height: f64, cos_i: f64, cos_r: f64, wavelength: f64) -> f64 {
    2.0 * PI * rms_height * (cos_i + cos_r) / wavelength
}

/// 4 pi r cos(theta)/lambda, which must be large.
pub fn kirchhoff(radius_of_curvature: f64, cos_theta: f64, wavelength: f64) -> f64 {
    4.0 * PI * radius_of_curvature * cos_theta / wavelength
}

/// Part of the reflected light that stays in step, exp(-g^2) of Gaussian heights with Rayleigh's parameter g.
pub fn coherent_part(rayleigh: f64) -> f64 {
    (-rayleigh * rayleigh).exp()
}
