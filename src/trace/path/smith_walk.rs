//! The random walk on a statistical Smith surface: heights and normals independent by construction, so that order 1
//! is D G2/(4 cos cos) exactly, and the instrument itself can be held to the formula.
//!
//! Input: the light's direction and a stream. Output: the same `PathEnd` as a path on heights. Heights enter only as
//! u = C1(h), the part of the surface below h: uniform on [0, 1] whatever the height law. Own Lambda and own normals:
//! nothing of `theory`. Paper: Heitz, Hanika, d'Eon, Dachsbacher 2016, "Multiple-scattering microfacet BSDFs with the
//! Smith model".

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};
use rand_pcg::Pcg64Dxsm;

use super::scatter::{Onward, PathEnd, Scatter, SplitEnd, split_rays, upside_down_if};
use crate::campaign::SmithNdf;
use crate::rng::uniform;
use crate::trace::sampling::half_sphere::visible_normal;

/// A statistical surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmithWalk {
    /// Law of the slopes.
    pub law: SmithNdf,
    /// World slope per canonical slope.
    pub alpha: DVec2,
    /// Whether the height is drawn anew after every bounce: masking independent of shadowing (the separable form).
    pub independent_heights: bool,
}

impl SmithWalk {
    /// Follows a path of light from `wi` (sample's frame, wi.z > 0) through at most `bounces` orders.
    // Tested by `order_one_is_the_formula_with_both_height_rules` (tests/it/validate/smith_surface.rs).
    pub fn trace(&self, wi: DVec3, bounces: u32, rng: &mut Pcg64Dxsm, facets: &mut impl Scatter) -> PathEnd {
        let (mut back, mut below) = (wi, false);
        // From above everything, down: a collision is certain.
        let mut u = self.next_height(1.0, -wi, rng).unwrap_or(1.0);
        for order in 1..=bounces {
            let Onward { to, through } = facets.scatter(back, self.visible_normal(back, rng), below);
            if self.independent_heights {
                u = uniform(rng);
            }
            if through {
                // Seen from the other side, what was above a height is below it.
                (u, below) = (1.0 - u, !below);
            }
            let wo = upside_down_if(through, to);
            if order == bounces && wo.z <= 0.0 {
                return PathEnd::Truncated { down: true };
            }
            match self.next_height(u, wo, rng) {
                None => return PathEnd::Out { wo: upside_down_if(below, wo), order },
                Some(next) => u = next,
            }
            back = -wo;
        }
        PathEnd::Truncated { down: false }
    }

    /// Both parts of the light of a path at its first facet, a clear one: order 1 without chance.
    pub fn trace_split(&self, wi: DVec3, eta: f64, rng: &mut Pcg64Dxsm) -> SplitEnd {
        let mut u = self.next_height(1.0, -wi, rng).unwrap_or(1.0);
        let (reflectance, rays) = split_rays(wi, self.visible_normal(wi, rng), eta);
        if self.independent_heights {
            u = uniform(rng);
        }
        // Both parts leave from the same height, each by a chance of its own.
        let mut end = |w: Option<DVec3>, below: bool| match w {
            None => PathEnd::Truncated { down: true },
            Some(w) => match self.next_height(if below { 1.0 - u } else { u }, w, rng) {
                None => PathEnd::Out { wo: upside_down_if(below, w), order: 1 },
                Some(_) => PathEnd::Truncated { down: false },
            },
        };
        let [up, down] = rays;
        SplitEnd { reflectance, reflected: end(up, false), refracted: end(down, true) }
    }

    /// The height at which a ray along `w` from height `u` collides next, `None` if it escapes.
    ///
    /// Between heights u and u' a ray survives with probability (u/u')^Lambda(w); Lambda < 0 for rays that go down.
    fn next_height(&self, u: f64, w: DVec3, rng: &mut Pcg64Dxsm) -> Option<f64> {
        let survival = 1.0 - uniform(rng);
        let lambda = self.lambda(w);
        if lambda >= 0.0 && survival <= u.powf(lambda) {
            return None;
        }
        Some(u * survival.powf(-1.0 / lambda))
    }

    /// Lambda(w) for any direction: Lambda(w) + Lambda(-w) = -1.
    ///
    /// GGX: s/(2 z (z + r)), s = x^2 + y^2, r = sqrt(z^2 + s); Beckmann: exp(-a^2)/(2 a sqrt pi) - erfc(a)/2,
    /// a = z/sqrt(s); (x, y, z) = (ax wx, ay wy, |wz|).
    fn lambda(&self, w: DVec3) -> f64 {
        let (s, z) = ((self.alpha * w.truncate()).length_squared(), w.z.abs());
        let up = match self.law {
            _ if s == 0.0 => 0.0,
            SmithNdf::Ggx => s / (2.0 * z * (z + (z * z + s).sqrt())),
            SmithNdf::Beckmann => {
                let a = z / s.sqrt();
                (-a * a).exp() / (2.0 * a * PI.sqrt()) - 0.5 * libm::erfc(a)
            }
        };
        if w.z >= 0.0 { up } else { -1.0 - up }
    }

    /// The normal, of any length, of a facet drawn in proportion to its projected area towards `back`.
    fn visible_normal(&self, back: DVec3, rng: &mut Pcg64Dxsm) -> DVec3 {
        let canonical = (self.alpha * back.truncate()).extend(back.z).normalize();
        let normal = match self.law {
            SmithNdf::Ggx => visible_normal(canonical, [uniform(rng), uniform(rng)]),
            SmithNdf::Beckmann => beckmann_normal(canonical, rng),
        };
        (self.alpha * normal.truncate()).extend(normal.z)
    }
}

/// A canonical Beckmann normal visible from `s`, as (-p, -q, 1). Along s the slope has density
/// exp(-p^2) (s.z - h p) for p < s.z/h (h the horizontal length of s), across it is normal.
fn beckmann_normal(s: DVec3, rng: &mut Pcg64Dxsm) -> DVec3 {
    let horizontal = s.truncate().length();
    let along = if horizontal > 0.0 { s.truncate() / horizontal } else { DVec2::X };
    let p = beckmann_slope_along(s.z, horizontal, uniform(rng));
    // 1 - u lies in (0, 1]: the logarithm is finite.
    let q = (-(1.0 - uniform(rng)).ln()).sqrt() * (TAU * uniform(rng)).cos();
    (-(p * along + q * along.perp())).extend(1.0)
}

/// Inverts the law of the slope along the view: Newton's steps, kept inside a shrinking bracket.
fn beckmann_slope_along(z: f64, h: f64, u: f64) -> f64 {
    // Slopes beyond 7 have density below 1e-21.
    let steepest = if h > 0.0 { (z / h).min(7.0) } else { 7.0 };
    let below = |p: f64| 0.5 * z * libm::erfc(-p) + 0.5 * h * (-p * p).exp() / PI.sqrt();
    let density = |p: f64| (-p * p).exp() / PI.sqrt() * (z - h * p);
    let (mut low, mut high) = (steepest.min(0.0) - 7.0, steepest);
    let wanted = u * below(high);
    let mut p = high.min(0.0) - 0.5;
    // 60 halvings alone would exhaust the digits.
    for _ in 0..60 {
        let excess = below(p) - wanted;
        if excess < 0.0 {
            low = p;
        } else {
            high = p;
        }
        let newton = p - excess / density(p);
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - p).abs() <= 1e-14 {
            return next;
        }
        p = next;
    }
    p
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Purpose, StreamId, stream};
    use crate::sphere::direction_deg;
    use crate::surface::SlopeLaw;

    const WALK: SmithWalk =
        SmithWalk { law: SmithNdf::Ggx, alpha: DVec2::new(0.4, 0.4), independent_heights: false };

    #[test]
    fn lambda_of_opposite_rays_adds_up_to_minus_one() {
        for law in [SmithNdf::Ggx, SmithNdf::Beckmann] {
            let walk = SmithWalk { law, ..WALK };
            for theta in [1.0, 30.0, 60.0, 85.0] {
                let w = direction_deg(theta, 20.0);
                let (up, down) = (walk.lambda(w), walk.lambda(-w));
                // -1 - up rounds once, at the size of 1 + up.
                assert!((up + down + 1.0).abs() <= f64::EPSILON * (1.0 + up), "{law:?} {theta} {up} {down}");
            }
        }
    }

    /// The mean of s.m over visible normals is the integral of D (s.m)^2 over that of D (s.m), by slopes.
    #[test]
    fn visible_normals_are_drawn_in_proportion_to_their_turned_area() {
        for law in [SmithNdf::Ggx, SmithNdf::Beckmann] {
            for theta in [20.0, 70.0, 100.0] {
                let s = direction_deg(theta, 50.0);
                let mut rng = stream(StreamId {
                    seed: 5,
                    purpose: Purpose::Test,
                    realisation: theta as u64,
                    incidence: 0,
                    block: 0,
                });
                let draw = |rng: &mut Pcg64Dxsm| match law {
                    SmithNdf::Ggx => visible_normal(s, [uniform(rng), uniform(rng)]).normalize(),
                    SmithNdf::Beckmann => beckmann_normal(s, rng).normalize(),
                };
                let n = 400_000;
                let (mut sum, mut squares) = (0.0, 0.0);
                for _ in 0..n {
                    let x = draw(&mut rng).dot(s);
                    assert!(x > -1e-12, "{law:?} {theta} {x}");
                    sum += x;
                    squares += x * x;
                }
                let (mean, expected) = (sum / f64::from(n), turned_area_mean(law, s));
                let se = ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt();
                // 4.5 standard errors: 7e-6 by chance; plus the midpoint rule's own error.
                assert!((mean - expected).abs() < 4.5 * se + 2e-4, "{law:?} {theta}: {mean} {expected} {se}");
            }
        }
    }

    /// Midpoint rule over lengths by rank and over azimuths.
    fn turned_area_mean(law: SmithNdf, s: DVec3) -> f64 {
        let law = if law == SmithNdf::Ggx { SlopeLaw::Ggx } else { SlopeLaw::Beckmann };
        let (n, m) = (4000, 720);
        let (mut top, mut bottom) = (0.0, 0.0);
        for i in 0..n {
            let length = law.length_quantile((f64::from(i) + 0.5) / f64::from(n));
            for j in 0..m {
                let (sin, cos) = (TAU * (f64::from(j) + 0.5) / f64::from(m)).sin_cos();
                let normal = DVec3::new(-length * cos, -length * sin, 1.0);
                let turned = s.dot(normal).max(0.0);
                top += turned * turned / normal.length();
                bottom += turned;
            }
        }
        top / bottom
    }
}
