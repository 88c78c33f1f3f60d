//! Normal distributions D(h), 1/sr: GGX and Beckmann, anisotropic, of a unit h and of H = wi + wo as it is.
//!
//! Input: a direction in the sample's own frame and the slope scales. Output: D, whose integral with the cosine
//! over the hemisphere is 1. Paper: Walter et al. 2007; Heitz 2014 for the anisotropic forms.

use std::f64::consts::PI;

use glam::DVec3;

/// The law of the facets' normals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ndf {
    /// Trowbridge-Reitz: slopes with infinite variance, median slope alpha.
    Ggx,
    /// Gaussian slopes, alpha/sqrt 2 rms per axis.
    Beckmann,
    /// Student's t of slopes: tails of power 2 gamma; GGX is gamma = 2.
    StudentT {
        /// >= 2.
        gamma: f64,
    },
    /// (n + 2)/(2 pi) cos^n with n = 2/alpha^2 - 2; stretched where alpha_x and alpha_y differ.
    BlinnPhong,
    /// Half-ellipsoids on a plane: the integral of D cos is their coverage, the plane has the rest.
    Grains {
        /// In (0, 1).
        coverage: f64,
    },
}

impl Ndf {
    /// The name in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Ndf::Ggx => "ggx",
            Ndf::Beckmann => "beckmann",
            Ndf::StudentT { .. } => "student_t",
            Ndf::BlinnPhong => "blinn_phong",
            Ndf::Grains { .. } => "grains",
        }
    }

    /// D of a unit normal.
    pub fn d(self, h: DVec3, alpha_x: f64, alpha_y: f64) -> f64 {
        match self {
            Ndf::Ggx => ggx_d(h, alpha_x, alpha_y),
            Ndf::Beckmann => beckmann_d(h, alpha_x, alpha_y),
            Ndf::StudentT { .. } | Ndf::BlinnPhong | Ndf::Grains { .. } => self.d_of_sum(h, alpha_x, alpha_y),
        }
    }

    /// D of the direction of `h_sum` = wi + wo, which need not be a unit vector.
    pub fn d_of_sum(self, h_sum: DVec3, alpha_x: f64, alpha_y: f64) -> f64 {
        match self {
            Ndf::Ggx => ggx_d_of_sum(h_sum, alpha_x, alpha_y),
            Ndf::Beckmann => beckmann_d_of_sum(h_sum, alpha_x, alpha_y),
            Ndf::StudentT { .. } | Ndf::BlinnPhong => {
                student_d_of_sum(h_sum, alpha_x, alpha_y, self.gamma(alpha_x * alpha_y))
            }
            Ndf::Grains { coverage } => grains_d_of_sum(h_sum, alpha_x, alpha_y, coverage),
        }
    }

    /// Half the power of the tails of a Student law, `alpha2` = alpha_x alpha_y; infinite for Beckmann.
    ///
    /// Blinn and Phong: cos^n (n + 2)/(2 pi) is Student's law with gamma = n/2 + 2 = 1 + 1/alpha^2.
    // Tested by `blinn_and_phongs_normals_are_a_power_of_the_cosine`.
    pub fn gamma(self, alpha2: f64) -> f64 {
        match self {
            Ndf::Ggx | Ndf::Grains { .. } => 2.0,
            Ndf::Beckmann => f64::INFINITY,
            Ndf::StudentT { gamma } => gamma,
            Ndf::BlinnPhong => 1.0 + 1.0 / alpha2,
        }
    }
}

/// GGX (Trowbridge-Reitz) normal distribution D(h), anisotropic.
///
/// D(h) = 1 / (pi ax ay ((hx/ax)^2 + (hy/ay)^2 + hz^2)^2)
///
/// - `h`: unit vector, sample frame. Below the horizon (h.z < 0) the value is 0.
/// - `alpha_x`, `alpha_y`: slope scales, > 0 (checked in debug builds; ranges are the campaign check's duty).
/// - Returns 1/sr, >= 0, finite. The integral of D(h) h.z over the hemisphere is 1.
/// - Numerics: a sum of squares, no division by the cosine, no tan.
/// - Source: Walter et al. 2007, eq. 33 (isotropic); Heitz 2014, section on anisotropic distributions.
///
/// ```
/// // At the pole D = 1/(pi ax ay).
/// let d = gonio::theory::ndf::ggx_d(glam::DVec3::Z, 0.1, 0.4);
/// assert!((d * std::f64::consts::PI * 0.1 * 0.4 - 1.0).abs() < 1e-15);
/// ```
// Tested by `all_laws_are_normalised`, `every_reference_value_is_met` (tests/it/formula_values.rs).
pub fn ggx_d(h: DVec3, alpha_x: f64, alpha_y: f64) -> f64 {
    debug_assert!(alpha_x > 0.0 && alpha_y > 0.0);
    if h.z < 0.0 {
        return 0.0;
    }
    let (x, y) = (h.x / alpha_x, h.y / alpha_y);
    let e = x * x + y * y + h.z * h.z;
    1.0 / (PI * alpha_x * alpha_y * e * e)
}

/// GGX D of the half vector, from H = wi + wo: q = H.H/((Hx/ax)^2 + (Hy/ay)^2 + Hz^2), D = q^2/(pi ax ay).
///
/// - `h_sum`: any length but 0, sample frame. Domain, unit and source as `ggx_d`.
/// - Numerics: no square root and no normalisation, so two arms close to opposite grazing directions keep D.
// Tested by `a_half_vector_and_its_sum_have_one_density`, `every_reference_value_is_met`.
pub fn ggx_d_of_sum(h_sum: DVec3, alpha_x: f64, alpha_y: f64) -> f64 {
    debug_assert!(alpha_x > 0.0 && alpha_y > 0.0);
    if h_sum.z < 0.0 {
        return 0.0;
    }
    let (x, y) = (h_sum.x / alpha_x, h_sum.y / alpha_y);
    let q = h_sum.length_squared() / (x * x + y * y + h_sum.z * h_sum.z);
    q * q / (PI * alpha_x * alpha_y)
}

/// Beckmann normal distribution D(h), anisotropic: D = exp(-s^2) / (pi ax ay hz^4) with s^2 = ((hx/ax)^2 +
/// (hy/ay)^2)/hz^2.
///
/// - Domain, unit and invariant as `ggx_d`; at the horizon itself the value is 0, the limit.
/// - Numerics: relative error about s^2 ulp, the conditioning of the exponential. Underflows to 0 above s^2 = 745.
/// - Source: Walter et al. 2007; Heitz 2014, section on anisotropic distributions.
// Tested by `all_laws_are_normalised`, `beckmann_peaks_at_one_over_pi_alpha_squared`.
pub fn beckmann_d(h: DVec3, alpha_x: f64, alpha_y: f64) -> f64 {
    beckmann_d_of_sum(h, alpha_x, alpha_y)
}

/// Beckmann D of the half vector, from H = wi + wo: exp(-s^2) (H.H/Hz^2)^2 / (pi ax ay).
///
/// - `h_sum`: any length but 0, sample frame. Everything else as `beckmann_d`.
// Tested by `a_half_vector_and_its_sum_have_one_density`.
pub fn beckmann_d_of_sum(h_sum: DVec3, alpha_x: f64, alpha_y: f64) -> f64 {
    debug_assert!(alpha_x > 0.0 && alpha_y > 0.0);
    if h_sum.z <= 0.0 {
        return 0.0;
    }
    let (p, q) = (h_sum.x / alpha_x / h_sum.z, h_sum.y / alpha_y / h_sum.z);
    let density = (-(p * p + q * q)).exp();
    if density == 0.0 {
        return 0.0; // Underflow; towards the horizon 1/hz^4 would make 0 times infinity of it.
    }
    let inverse_hz2 = h_sum.length_squared() / (h_sum.z * h_sum.z);
    density * inverse_hz2 * inverse_hz2 / (PI * alpha_x * alpha_y)
}

/// Student's t normal distribution from H = wi + wo: with q = (Hx/ax)^2 + (Hy/ay)^2 and g = gamma - 1,
/// D = (H.H/(Hz^2 + q/g))^2 (1 + q/(g Hz^2))^-(gamma - 2)/(pi ax ay).
///
/// The density of slopes is (1 + s^2/g)^-gamma/(pi ax ay), s^2 = q/Hz^2.
///
/// - `h_sum`: any length but 0, sample frame; below the horizon the value is 0. `gamma` >= 2.
/// - Numerics: gamma = 2 is GGX's own form; the power goes through ln(1 + x), so large gammas keep their digits.
/// - Source: Ribardiere et al. 2017, "STD: Student's t-distribution of slopes for microfacet based BSDFs".
// Tested by `all_laws_are_normalised`, `a_half_vector_and_its_sum_have_one_density`,
// `students_law_with_gamma_two_is_ggx`.
pub fn student_d_of_sum(h_sum: DVec3, alpha_x: f64, alpha_y: f64, gamma: f64) -> f64 {
    debug_assert!(alpha_x > 0.0 && alpha_y > 0.0 && gamma >= 2.0);
    if h_sum.z < 0.0 {
        return 0.0;
    }
    let (x, y) = (h_sum.x / alpha_x, h_sum.y / alpha_y);
    let (z2, scaled) = (h_sum.z * h_sum.z, (x * x + y * y) / (gamma - 1.0));
    let q = h_sum.length_squared() / (z2 + scaled);
    let excess = gamma - 2.0;
    let tail = if excess == 0.0 { 1.0 } else { (-excess * (scaled / z2).ln_1p()).exp() };
    q * q * tail / (PI * alpha_x * alpha_y)
}

/// D(h) from H = wi + wo: GGX times Lambda (1 - coverage)^(1 - z^2), Lambda = -ln(1 - coverage), z the canonical cosine.
///
/// - `h_sum`: any length but 0, sample frame; below the horizon the value is 0. `coverage` in (0, 1).
/// - Returns 1/sr. The integral of D cos over the hemisphere is the coverage: the bare plane has the rest.
/// - Numerics: 1 - z^2 as a quotient of sums of squares.
// Tested by `the_law_of_grains_meets_its_reference` (tests/it/formula_values.rs), `normals_add_up_to_the_coverage`.
pub fn grains_d_of_sum(h_sum: DVec3, alpha_x: f64, alpha_y: f64, coverage: f64) -> f64 {
    let (x, y) = (h_sum.x / alpha_x, h_sum.y / alpha_y);
    let (across2, up2) = (x * x + y * y, h_sum.z * h_sum.z);
    let depth = -(-coverage).ln_1p();
    ggx_d_of_sum(h_sum, alpha_x, alpha_y) * depth * (-depth * across2 / (across2 + up2)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::direction_deg;

    const LAWS: [Ndf; 4] =
        [Ndf::Ggx, Ndf::Beckmann, Ndf::StudentT { gamma: 2.5 }, Ndf::StudentT { gamma: 60.0 }];

    /// Integral over all slopes of D(h) hz^4 dp dq, which is the integral of D(h) hz over the hemisphere. Canonical
    /// polar slopes r = exp(t), trapezoid in t and in the azimuth: both converge exponentially.
    fn normalisation(ndf: Ndf, alpha_x: f64, alpha_y: f64) -> f64 {
        let (step, directions) = (0.05, 16);
        let mut sum = 0.0;
        for k in -400..=400 {
            let r = (step * f64::from(k)).exp();
            for j in 0..directions {
                let (sin, cos) = (f64::from(j) * 2.0 * PI / f64::from(directions)).sin_cos();
                let slope = DVec3::new(r * cos * alpha_x, r * sin * alpha_y, 1.0);
                let hz = 1.0 / slope.length();
                sum += ndf.d(slope * hz, alpha_x, alpha_y) * hz.powi(4) * r * r;
            }
        }
        sum * step * (2.0 * PI / f64::from(directions)) * alpha_x * alpha_y
    }

    #[test]
    fn all_laws_are_normalised() {
        for ndf in LAWS {
            for alpha in [1e-4, 1e-3, 0.01, 0.1, 0.5, 1.0, 2.0] {
                for ratio in [1.0, 0.1, 1e-4] {
                    // The tails cut at r = exp(20) and exp(-20) hold 4e-18; the trapezoid's own error is below 1e-13.
                    let found = normalisation(ndf, alpha, alpha * ratio);
                    assert!((found - 1.0).abs() < 1e-10, "{ndf:?} {alpha} {ratio}: {found}");
                }
            }
        }
    }

    #[test]
    fn a_half_vector_and_its_sum_have_one_density() {
        for ndf in LAWS {
            let sum = direction_deg(60.0, 20.0) + direction_deg(35.0, 170.0);
            let (whole, unit) = (ndf.d_of_sum(sum, 0.3, 0.7), ndf.d(sum.normalize(), 0.3, 0.7));
            // The normalisation moves h by 2 ulp, D by at most 4 (1 + s^2) times as many; s^2 < 10 here.
            assert!((whole - unit).abs() < 100.0 * f64::EPSILON * unit, "{whole} {unit}");
        }
    }

    #[test]
    fn students_law_with_gamma_two_is_ggx() {
        for h in [direction_deg(0.0, 0.0), direction_deg(40.0, 20.0), direction_deg(89.9, 130.0)] {
            let (student, ggx) =
                (Ndf::StudentT { gamma: 2.0 }.d_of_sum(h, 0.3, 0.1), ggx_d_of_sum(h, 0.3, 0.1));
            assert_eq!(student, ggx);
        }
    }

    #[test]
    fn blinn_and_phongs_normals_are_a_power_of_the_cosine() {
        for exponent in [0.0, 6.0, 48.0, 198.0] {
            let alpha = (2.0f64 / (exponent + 2.0)).sqrt();
            for theta_deg in [0.0, 5.0, 30.0, 60.0, 80.0] {
                let h = direction_deg(theta_deg, 70.0);
                let expected = (exponent + 2.0) / (2.0 * PI) * h.z.powf(exponent);
                let found = Ndf::BlinnPhong.d(h, alpha, alpha);
                // alpha and the cosine each round; the power magnifies that by n + 2, and by ln(cos) <= 2.
                let tolerance = 8.0 * (exponent + 2.0) * f64::EPSILON;
                assert!((found / expected - 1.0).abs() < tolerance, "{exponent} {theta_deg}: {found}");
            }
        }
    }

    #[test]
    fn beckmann_peaks_at_one_over_pi_alpha_squared() {
        // Five roundings.
        let expected = 1.0 / (PI * 0.04);
        assert!((beckmann_d(DVec3::Z, 0.2, 0.2) - expected).abs() < 5.0 * f64::EPSILON * expected);
    }

    #[test]
    fn no_normal_gives_anything_but_a_number() {
        for ndf in LAWS {
            for z in [0.0, 5e-324, 1e-200, 1e-100, 1e-10, 1.0, -1e-300, -1.0] {
                for alpha in [1e-4, 10.0] {
                    let d = ndf.d_of_sum(DVec3::new(1.0, 0.0, z), alpha, alpha);
                    assert!(d.is_finite() && d >= 0.0, "{ndf:?} {z} {alpha}: {d}");
                }
            }
        }
    }

    #[test]
    fn normals_add_up_to_the_coverage() {
        for coverage in [1e-3, 0.5, 0.9, 0.999] {
            // Over z^2 = t, D cos dw becomes Lambda exp(-Lambda (1 - t)) dt: exactly the coverage.
            let n = 100_000;
            let value = |k: i32| {
                let t: f64 = (f64::from(k) + 0.5) / f64::from(n);
                let h = DVec3::new(0.3 * (1.0 - t).sqrt(), 0.0, t.sqrt());
                // D_GGX h_z dw = dt of the canonical disc: divided out by GGX itself.
                grains_d_of_sum(h, 0.3, 0.7, coverage) / ggx_d_of_sum(h, 0.3, 0.7)
            };
            let found = (0..n).map(value).sum::<f64>() / f64::from(n);
            // The midpoint rule: Lambda^2/(24 n^2).
            assert!((found - coverage).abs() < 1e-8, "{coverage}: {found}");
        }
    }
}
