//! What a facet does to light that meets it: it mirrors it, splits it between both sides, scatters it
//! evenly, or does so below an interface.
//!
//! Input: the direction back to where the light comes from, the facet's normal on that side, uniform numbers where chance
//! decides. Output: where the light goes. Both directions point away from the facet.

use std::f64::consts::TAU;

use glam::DVec3;

use super::fresnel::FacetAngle;
use super::fresnel::dielectric::f_dielectric;

/// What a facet does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FacetKind {
    /// Everything goes into the mirror direction; what is absorbed is a weight of the path.
    Mirror,
    /// Fresnel's equations split the light between the mirror direction and the refracted one.
    Dielectric {
        /// Index of the far side of the surface over the near one, > 0.
        eta: f64,
    },
    /// Lambert's law: in proportion to the cosine, whatever comes.
    Diffuse,
    /// A clear interface over a matt base: what it does not mirror comes back from the base (`optics::layered`).
    Layered {
        /// Index of the inside over the outside, (1, 4].
        eta: f64,
    },
}

/// The mirror direction: 2 (w.N) N/(N.N) - w. `normal` may have any length.
pub fn mirrored(back: DVec3, normal: DVec3) -> DVec3 {
    (2.0 * back.dot(normal) / normal.length_squared()) * normal - back
}

/// Light at a clear facet: the share that is reflected, and where the rest goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Split {
    /// F, [0, 1]; 1 in total reflection.
    pub reflectance: f64,
    /// Unit vector on the far side; `None` in total reflection.
    pub refracted: Option<DVec3>,
}

/// Splits light at a clear facet. With c = w.n, m = eta^2 - 1 and g = sqrt(m + c^2) the refracted direction is
/// -(w + m/(c + g) n)/eta.
///
/// - `back`: unit vector, on the side of `normal`, which may have any length; `eta`: index beyond over index here, > 0.
/// - Numerics: no difference of cosines; at eta = 1 light goes straight on, to the bit.
/// - Source: Snell's law, rationalised as in `f_dielectric`.
// Tested by `refraction_is_snells_law`.
pub fn split(back: DVec3, normal: DVec3, eta: f64) -> Split {
    let n = normal / normal.length();
    // At an edge rounding may meet a facet from behind: such light grazes it.
    let c = back.dot(n).clamp(0.0, 1.0);
    let m = (eta - 1.0) * (eta + 1.0);
    let g2 = m + c * c;
    if g2 <= 0.0 {
        return Split { reflectance: 1.0, refracted: None };
    }
    let angle = FacetAngle { cos: c, sin2: (1.0 - c) * (1.0 + c) };
    let refracted = -(back + (m / (c + g2.sqrt())) * n) / eta;
    Split { reflectance: f_dielectric(angle, eta).mean(), refracted: Some(refracted) }
}

/// A direction by Lambert's law about `normal`, of any length; `u`, `v` uniform in [0, 1).
// Tested by `even_facets_follow_lamberts_law`.
pub fn lambert_direction(normal: DVec3, u: f64, v: f64) -> DVec3 {
    let n = normal.normalize();
    let (across, along) = n.any_orthonormal_pair();
    let (sin, cos) = (TAU * v).sin_cos();
    u.sqrt() * (cos * across + sin * along) + (1.0 - u).sqrt() * n
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, StreamId, stream, uniform};
    use crate::sphere::direction_deg;

    #[test]
    fn refraction_is_snells_law() {
        for eta in [1.0001, 1.33, 1.5, 2.4, 1.0 / 1.5] {
            for theta in [0.0, 1e-6, 20.0, 41.0, 60.0, 89.99] {
                // A facet that leans, given by a normal of another length.
                let normal = direction_deg(25.0, 40.0);
                let (across, along) = normal.any_orthonormal_pair();
                let (sin, cos) = f64::to_radians(theta).sin_cos();
                let back = sin * (0.6 * across + 0.8 * along) + cos * normal;
                let found = split(back, 3.0 * normal, eta);
                let sin_t = sin / eta;
                assert_eq!(found.refracted.is_none(), sin_t >= 1.0, "{eta} {theta}");
                let Some(t) = found.refracted else { continue };
                let expected = -sin_t * (0.6 * across + 0.8 * along) - (1.0 - sin_t * sin_t).sqrt() * normal;
                // A dozen roundings; near the critical angle the root magnifies by 1/cos, at most 20 here.
                assert!(t.distance(expected) < 200.0 * f64::EPSILON, "{eta} {theta}: {t} {expected}");
                assert!((t.length() - 1.0).abs() < 16.0 * f64::EPSILON);
                // What goes in comes out the same way.
                let out = split(t, -normal, 1.0 / eta);
                // The cosine inside loses what eta - 1 leaves of it: at 1.0001 four digits.
                assert!(out.refracted.expect("a way").distance(back) < 1e-11, "{eta} {theta}");
                // 1/eta is rounded, and eta - 1 leaves four digits less of it; grazing light squares that.
                assert!((out.reflectance - found.reflectance).abs() < 1e-8, "{eta} {theta}");
            }
        }
    }

    #[test]
    fn light_goes_straight_on_through_no_interface() {
        let back = direction_deg(50.0, 10.0);
        assert_eq!(
            split(back, direction_deg(10.0, 0.0), 1.0),
            Split { reflectance: 0.0, refracted: Some(-back) }
        );
    }

    /// Means of cos and cos^2 about the normal under Lambert's law: 2/3 and 1/2, their variances 1/18 and 1/12.
    #[test]
    fn even_facets_follow_lamberts_law() {
        let id = StreamId { seed: 3, purpose: Purpose::Test, realisation: 0, incidence: 0, block: 0 };
        let (mut rng, n, normal) = (stream(id), 100_000, direction_deg(70.0, 200.0));
        let (mut cos, mut square, mut sum) = (0.0, 0.0, DVec3::ZERO);
        for _ in 0..n {
            let w = lambert_direction(2.0 * normal, uniform(&mut rng), uniform(&mut rng));
            assert!((w.length() - 1.0).abs() < 1e-15);
            let c = w.dot(normal);
            (cos, square, sum) = (cos + c, square + c * c, sum + w);
        }
        let n = f64::from(n);
        // 4.5 standard errors: 7e-6 by chance.
        assert!((cos / n - 2.0 / 3.0).abs() < 4.5 * (1.0 / 18.0 / n).sqrt());
        assert!((square / n - 0.5).abs() < 4.5 * (1.0 / 12.0 / n).sqrt());
        // Across the normal the mean of each component is 0, its variance 1/4.
        assert!(
            (sum / n - 2.0 / 3.0 * normal).length() < 4.5 * (0.5 / n).sqrt() + 4.5 * (1.0 / 18.0 / n).sqrt()
        );
    }
}
