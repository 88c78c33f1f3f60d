//! The surface of grains: half-ellipsoids on a plane, their centres a Poisson process, the highest one in front. Every
//! factor of its BRDF is known in closed form, masking included.
//!
//! In the canonical frame the grains are half-spheres of radius 1 with lambda = -ln(1 - coverage)/pi centres in a unit of
//! area. A point of height z on one of them is hidden from a direction where a centre lies in a region R of the plane:
//! the part of an ellipse ahead of the point, without the disc of those centres whose grains would bury the point.
//! So G1 = exp(-lambda |R|), and G2 = exp(-lambda |Ri u Ro|).
//! Paper: Lucas, Ribardiere, Pacanowski, Barla 2023, "A micrograin BSDF model for the rendering of porous layers".

use std::f64::consts::PI;

use glam::DVec3;
use smallvec::SmallVec;

/// How many centres a disc of radius 1 holds in the mean: lambda pi = -ln(1 - coverage).
fn centres_of_a_disc(coverage: f64) -> f64 {
    -(-coverage).ln_1p()
}

/// The share of the light from a canonical direction of cosine `cos` that the bare plane sends on, straight into the
/// mirror direction: (1 - coverage)^(1/cos). Lit and seen: no centre in two half-ellipses.
// Tested by `the_bare_plane_is_in_the_mirror_bin` (tests/it/measure/grains.rs).
pub fn bare_mirror_flux(canonical: DVec3, coverage: f64) -> f64 {
    (-centres_of_a_disc(coverage) * canonical.length() / canonical.z).exp()
}

/// G2 of facets whose canonical normal has the cosine `z`, exact, for two canonical directions of any length above the
/// horizon: exp(-lambda (|Ri| + |Ro| - |Ri n Ro|)).
///
/// - Returns a share of the facets that are not buried, [0, 1]. Swapping the arms gives the same bits.
/// - Numerics: areas are closed forms (ellipse sectors), absolute error about 1e-15/cos.
// Tested by `the_law_of_grains_meets_its_reference`.
pub fn g2(i: DVec3, o: DVec3, z: f64, coverage: f64) -> f64 {
    let (i, o) = if (i.z, i.x, i.y) < (o.z, o.x, o.y) { (o, i) } else { (i, o) };
    let hidden = HiddenBy::new(i, z).area() + HiddenBy::new(o, z).area() - area_in_common(i, o, z);
    (-centres_of_a_disc(coverage) / PI * hidden).exp()
}

/// G1(wi) G1(wo) of the same facets: what forgets that one grain hides a facet from both arms.
// Tested by `the_law_of_grains_meets_its_reference`.
pub fn g1_product(i: DVec3, o: DVec3, z: f64, coverage: f64) -> f64 {
    let hidden = HiddenBy::new(i, z).area() + HiddenBy::new(o, z).area();
    (-centres_of_a_disc(coverage) / PI * hidden).exp()
}

/// The centres that hide a point of height `z` from a direction, seen from the point's foot with the direction along x:
/// those with x >= z cos/sin in the ellipse y^2 + (x cos + z sin)^2 = 1, but outside the disc of radius
/// sqrt(1 - z^2).
#[derive(Debug, Clone, Copy)]
struct HiddenBy {
    sin: f64,
    cos: f64,
    z: f64,
    /// Square of the disc's radius.
    disc2: f64,
    /// Azimuth up to which the ellipse lies outside the disc; 0: nowhere.
    half_angle: f64,
}

impl HiddenBy {
    fn new(direction: DVec3, z: f64) -> Self {
        let length = direction.length();
        let (sin, cos) = (direction.truncate().length() / length, direction.z / length);
        let disc2 = (1.0 - z) * (1.0 + z);
        let half_angle = if z < sin { (z * cos / (sin * disc2.sqrt())).min(1.0).acos() } else { 0.0 };
        HiddenBy { sin, cos, z, disc2, half_angle }
    }

    fn area(&self) -> f64 {
        if self.half_angle == 0.0 { 0.0 } else { self.sector(-self.half_angle, self.half_angle) }
    }

    /// How far the ellipse reaches at an azimuth: the root r of r^2 - (1 - z^2) = (r sin cos(azimuth) - z cos)^2.
    fn reach(&self, azimuth: f64) -> f64 {
        let along = self.sin * azimuth.cos();
        let (half, rest) = (along * self.cos * self.z, 1.0 - (self.sin * self.z).powi(2));
        rest / (half + (half * half + (1.0 - along) * (1.0 + along) * rest).sqrt())
    }

    /// The area between two azimuths of what lies beyond the disc. On the unit circle (x cos + z sin, y) the ellipse's
    /// sector about the foot is an arc's less two triangles.
    fn sector(&self, from: f64, to: f64) -> f64 {
        let on_circle = |azimuth: f64| {
            let (reach, (sin, cos)) = (self.reach(azimuth), azimuth.sin_cos());
            let y = reach * sin;
            (y.atan2(reach * cos * self.cos + self.z * self.sin), y)
        };
        let ((arc_from, y_from), (arc_to, y_to)) = (on_circle(from), on_circle(to));
        let ellipse = (arc_to - arc_from - self.z * self.sin * (y_to - y_from)) / self.cos;
        0.5 * (ellipse - self.disc2 * (to - from))
    }
}

/// The area of the centres that hide a facet from both directions.
fn area_in_common(i: DVec3, o: DVec3, z: f64) -> f64 {
    let (hide_i, hide_o) = (HiddenBy::new(i, z), HiddenBy::new(o, z));
    // The turn from one to the other; the picture may be mirrored.
    let turn = (i.x * o.y - i.y * o.x).abs().atan2(i.x * o.x + i.y * o.y);
    let from = (-hide_i.half_angle).max(turn - hide_o.half_angle);
    let to = hide_i.half_angle.min(turn + hide_o.half_angle);
    if from >= to || hide_i.half_angle == 0.0 || hide_o.half_angle == 0.0 {
        return 0.0;
    }
    let inside = crossings(&hide_i, &hide_o, turn).into_iter().filter(|&mark| from < mark && mark < to);
    let mut marks: SmallVec<[f64; 4]> = [from, to].into_iter().chain(inside).collect();
    marks.sort_by(f64::total_cmp);
    let piece = |ends: &[f64]| {
        let middle = 0.5 * (ends[0] + ends[1]);
        if hide_i.reach(middle) <= hide_o.reach(middle - turn) {
            hide_i.sector(ends[0], ends[1])
        } else {
            hide_o.sector(ends[0] - turn, ends[1] - turn)
        }
    };
    marks.windows(2).map(piece).sum()
}

/// Azimuths at which both ellipses may reach equally far: where they cross, r sin cos(azimuth) - z cos is the same of
/// both, which is a straight line; it meets one of them at most twice.
fn crossings(i: &HiddenBy, o: &HiddenBy, turn: f64) -> SmallVec<[f64; 2]> {
    let (sin, cos) = turn.sin_cos();
    let (gx, gy) = (i.sin - o.sin * cos, -o.sin * sin);
    let length = gx.hypot(gy);
    if length == 0.0 {
        return SmallVec::new();
    }
    let (nx, ny) = (gx / length, gy / length);
    let distance = i.z * (i.cos - o.cos) / length;
    // A point of the line is distance n + t (-ny, nx); on the ellipse t^2 (1 - b^2) - 2 a b t + c = 0.
    let (a, b) = (i.sin * distance * nx - i.cos * i.z, -i.sin * ny);
    let (square, half) = ((1.0 - b) * (1.0 + b), a * b);
    let rest = distance * distance - i.disc2 - a * a;
    let root = half * half - square * rest;
    if !(root >= 0.0 && square > 0.0) {
        return SmallVec::new();
    }
    let azimuth = |t: f64| (distance * ny + t * nx).atan2(distance * nx - t * ny);
    [-1.0, 1.0].map(|sign: f64| azimuth((half + sign * root.sqrt()) / square)).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::direction_deg;

    /// The area by the midpoint rule over azimuths: the definition, without ellipse sectors.
    fn union_by_azimuths(i: DVec3, o: DVec3, z: f64) -> f64 {
        let n = 200_000;
        let disc2 = 1.0 - z * z;
        let reach = |w: DVec3, psi: f64| {
            let (s, c) = (w.truncate().length(), w.z);
            let along = (psi - w.y.atan2(w.x)).cos();
            let a = 1.0 - (s * along).powi(2);
            let b = along * s * c * z;
            let r = (-b + (b * b + a * (1.0 - (z * s).powi(2))).sqrt()) / a;
            if r * along * s >= z * c { (r * r).max(disc2) } else { disc2 }
        };
        let at = |k: i32| {
            let psi = 2.0 * PI * (f64::from(k) + 0.5) / f64::from(n);
            reach(i, psi).max(reach(o, psi)) - disc2
        };
        PI * (0..n).map(at).sum::<f64>() / f64::from(n)
    }

    #[test]
    fn areas_in_common_are_those_of_the_definition() {
        for (ti, to) in [(60.0, 60.0), (30.0, 75.0), (80.0, 50.0), (45.0, 46.0)] {
            for turn in [0.0, 1e-3, 20.0, 90.0, 170.0, 180.0, 250.0] {
                for z in [0.0, 0.2, 0.45, 0.7] {
                    let (i, o) = (direction_deg(ti, 35.0), direction_deg(to, 35.0 + turn));
                    let hidden = -g2(i, o, z, 0.5).ln() * PI / 2f64.ln();
                    // Kinks between 200,000 nodes: an interval's worth of a jump in slope, some 1e-8.
                    assert!(
                        (hidden - union_by_azimuths(i, o, z)).abs() < 1e-7,
                        "{ti} {to} {turn} {z}: {hidden}"
                    );
                    assert_eq!(g2(i, o, z, 0.5).to_bits(), g2(o, i, z, 0.5).to_bits());
                }
            }
        }
    }

    #[test]
    fn one_direction_hides_once() {
        // Back-scatter: the two regions are one, so G2 = G1.
        for theta in [20.0, 60.0, 85.0, 89.99] {
            let w = direction_deg(theta, 10.0);
            for z in [0.0, 0.1, 0.3] {
                let (both, product) = (g2(w, w, z, 1e-4).ln(), g1_product(w, w, z, 1e-4).ln());
                // Areas are off by 1e-15/cos; the logarithm of what is near 1 by 1e-16.
                assert!((2.0 * both - product).abs() <= 1e-15 + 1e-18 / w.z, "{theta} {z}: {both} {product}");
            }
        }
    }

    /// What grains and plane show of themselves to a direction is what they cover there: the cosine.
    #[test]
    fn visible_projected_area_is_the_cosine() {
        for (theta, coverage) in [(0.0, 0.5), (30.0, 0.2), (60.0, 0.9), (80.0, 0.5)] {
            let w = direction_deg(theta, 0.0);
            let (n, m) = (2000, 400);
            let mut sum = 0.0;
            for k in 0..n {
                // z^2 evenly: the horizontal projection of a half-sphere is a disc.
                let z = ((f64::from(k) + 0.5) / f64::from(n)).sqrt();
                let g1 = g2(w, w, z, coverage);
                let buried = (-centres_of_a_disc(coverage) * (1.0 - z * z)).exp();
                for j in 0..m {
                    let turn = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(m);
                    let normal = DVec3::new((1.0 - z * z).sqrt() * turn.cos(), 0.0, z);
                    sum += normal.dot(w).max(0.0) / z * g1 * buried;
                }
            }
            let grains = sum * centres_of_a_disc(coverage) / f64::from(n * m);
            let half = 0.5 * (1.0 + 1.0 / w.z);
            let plane = w.z * (-centres_of_a_disc(coverage) * half).exp();
            // The midpoint rule where facets turn away: 2e-4.
            assert!((grains + plane - w.z).abs() < 5e-4, "{theta} {coverage}: {grains} + {plane}");
        }
    }
}
