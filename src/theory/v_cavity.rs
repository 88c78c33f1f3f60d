//! The symmetric V-groove with level ridges: the one rough surface whose single bounce is known exactly.
//!
//! Input: the slope of its sides, the turn of the sample and the direction to the light. Output: two directions and
//! the fraction of the incident flux in each. Paper: Torrance and Sparrow 1967 (the groove), which is exact here at
//! every azimuth because light that leaves one side can be blocked by the opposite side alone.

use glam::DVec3;

use crate::sphere;

/// Torrance and Sparrow's G = min(1, 2 (n.m)(n.v)/(v.m), 2 (n.m)(n.l)/(l.m)): the part of a groove's side that both
/// arms see.
///
/// - `m`: the side's unit normal, m.z > 0. `wi`, `wo`: unit vectors above the horizon that see its front
///   (w.m > 0). An arm in the horizon gives 0.
/// - Returns [0, 1]. Symmetric in the arms to the bit.
/// - Source: Torrance and Sparrow 1967; Cook and Torrance 1982.
// Tested by `groove_flux_agrees_with_brute_force`.
pub fn torrance_sparrow_g(m: DVec3, wi: DVec3, wo: DVec3) -> f64 {
    let open = |w: DVec3| 2.0 * m.z * w.z / w.dot(m);
    open(wi).min(open(wo)).min(1.0)
}

/// What one side of the groove sends out at order 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrooveLobe {
    /// The mirror direction, unit vector of the stage's frame; it may lie below the horizon.
    pub wo: DVec3,
    /// Fraction of the incident flux, [0, 1]; 0 where the side faces away from the light or `wo` is not above the horizon.
    pub flux: f64,
}

/// The two lobes of a symmetric V-groove: first the side whose normal is (-slope, 0, 1), then (slope, 0, 1), both
/// normalised and turned with the sample; the ridges run along the sample's y.
///
/// flux = (wi.m) G/(2 cos_beta cos_i), beta the side's tilt, G of `torrance_sparrow_g`; wo = 2 (wi.m) m - wi.
///
/// - `slope`: > 0. `rotation`: rad, counter-clockwise seen from +z. `wi`: unit vector, wi.z > 0.
/// - Invariant: the two fluxes add up to at most 1; the rest meets the opposite side.
/// - Source: Torrance and Sparrow 1967.
// Tested by `groove_flux_agrees_with_brute_force`, `a_shallow_groove_reflects_all`.
pub fn v_groove_lobes(slope: f64, rotation: f64, wi: DVec3) -> [GrooveLobe; 2] {
    debug_assert!(slope > 0.0 && wi.z > 0.0);
    let turn = rotation.sin_cos();
    [-slope, slope].map(|x| {
        let m = sphere::turned(DVec3::new(x, 0.0, 1.0).normalize(), turn);
        let towards = wi.dot(m);
        let wo = 2.0 * towards * m - wi;
        if towards <= 0.0 || wo.z <= 0.0 {
            return GrooveLobe { wo, flux: 0.0 };
        }
        GrooveLobe { wo, flux: towards * torrance_sparrow_g(m, wi, wo) / (2.0 * m.z * wi.z) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::direction_deg;

    /// One period is x in [-1, 1] with heights slope |x|. Samples lie evenly in x on each side; an arm is free when it
    /// passes the ridge ahead of it at or above the ridge's height.
    fn brute_force(slope: f64, wi: DVec3, starts: u32) -> [f64; 2] {
        let free = |x: f64, w: DVec3| {
            let ahead = 1.0 - x * w.x.signum();
            slope * x.abs() * w.x.abs() + w.z * ahead >= slope * w.x.abs()
        };
        // The side x > 0 rises along +x: its normal is (-slope, 0, 1).
        [1.0, -1.0].map(|side| {
            let m = DVec3::new(-side * slope, 0.0, 1.0).normalize();
            let wo = 2.0 * wi.dot(m) * m - wi;
            if wi.dot(m) <= 0.0 || wo.z <= 0.0 {
                return 0.0;
            }
            let seen = (0..starts)
                .map(|k| side * (f64::from(k) + 0.5) / f64::from(starts))
                .filter(|&x| free(x, wi) && free(x, wo))
                .count();
            wi.dot(m) / (2.0 * m.z * wi.z) * seen as f64 / f64::from(starts)
        })
    }

    #[test]
    fn groove_flux_agrees_with_brute_force() {
        let starts = 100_000;
        for slope in [0.05, 0.3, 1.0, 3.0] {
            for theta_deg in [0.0, 20.0, 50.0, 80.0, 89.0] {
                for phi_deg in [0.0, 30.0, 89.0, 130.0, 180.0, 270.0] {
                    let wi = direction_deg(theta_deg, phi_deg);
                    let (exact, counted) = (v_groove_lobes(slope, 0.0, wi), brute_force(slope, wi, starts));
                    for (lobe, counted) in exact.iter().zip(counted) {
                        // The part that both arms see is one interval of samples: at most one in doubt at each end,
                        // with the weight (wi.m)/(2 cos_beta cos_i) <= (1 + slope tan theta)/2.
                        let weight = 0.5 * (1.0 + slope * theta_deg.to_radians().tan());
                        let tolerance = 2.0 * weight / f64::from(starts);
                        assert!((lobe.flux - counted).abs() <= tolerance, "{slope} {wi}: {lobe:?} {counted}");
                    }
                    assert!(exact[0].flux + exact[1].flux <= 1.0 + 4.0 * f64::EPSILON);
                }
            }
        }
    }

    #[test]
    fn a_shallow_groove_reflects_all() {
        // At normal incidence both mirror directions clear the ridges up to a tilt of 30 degrees; beyond, 2 cos(2 beta).
        for (beta_deg, expected) in [(5.0f64, 1.0), (29.9, 1.0), (40.0, 2.0 * f64::cos(80f64.to_radians()))] {
            let lobes = v_groove_lobes(beta_deg.to_radians().tan(), 0.3, DVec3::Z);
            let sum = lobes[0].flux + lobes[1].flux;
            // About ten roundings of numbers near 1, and cos(2 beta) keeps 1/0.17 of its digits.
            assert!((sum - expected).abs() < 64.0 * f64::EPSILON, "{beta_deg}: {sum}");
            assert!((sphere::theta(lobes[0].wo).to_degrees() - 2.0 * beta_deg).abs() < 1e-12);
        }
    }

    #[test]
    fn turning_the_groove_turns_its_lobes() {
        let wi = direction_deg(35.0, 20.0);
        let still = v_groove_lobes(0.4, 0.0, wi);
        let turned = v_groove_lobes(0.4, 0.7, sphere::turned(wi, 0.7f64.sin_cos()));
        for (a, b) in still.iter().zip(turned) {
            assert!(sphere::turned(a.wo, 0.7f64.sin_cos()).distance(b.wo) < 16.0 * f64::EPSILON);
            assert!((a.flux - b.flux).abs() < 16.0 * f64::EPSILON);
        }
    }
}
