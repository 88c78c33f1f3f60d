//! The slope laws that a surface is made to have, in canonical form (alpha = 1), as laws of slopes.
//!
//! `theory::ndf` states the same laws as densities of normals, without sharing code: agreement is evidence.

/// A law of facet slopes, isotropic in canonical slopes (p, q).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SlopeLaw {
    /// P22 = 1/(pi (1 + p^2 + q^2)^2): infinite variance, median length 1.
    Ggx,
    /// P22 = exp(-p^2 - q^2)/pi: variance 1/2 per axis.
    Beckmann,
    /// P22 = (1 + (p^2 + q^2)/power)^-(power + 1)/pi: tails between GGX's (power = 1) and Beckmann's (infinite).
    StudentT {
        /// gamma - 1, >= 1: the share of slopes beyond a large length r falls as r^(-2 power).
        power: f64,
    },
    /// The slopes of half-spheres on a plane, the highest in front, and the plane's own 0.
    Grains {
        /// Share of the plane that is covered, in (0, 1).
        coverage: f64,
    },
}

impl SlopeLaw {
    /// Student's law of slopes with the `gamma` of Ribardiere et al. 2017, whose power of the tails is 2 gamma.
    pub fn student_t(gamma: f64) -> Self {
        SlopeLaw::StudentT { power: gamma - 1.0 }
    }

    /// Blinn and Phong's normals, D = (n + 2)/(2 pi) cos^n, as slopes in units of alpha = sqrt(2/(n + 2)).
    ///
    /// D cos^4 = (n + 2)/(2 pi) (1 + r^2)^(-n/2 - 2): Student's law with power n/2 + 1.
    pub fn blinn_phong(exponent: f64) -> Self {
        SlopeLaw::StudentT { power: 0.5 * exponent + 1.0 }
    }

    /// Probability that the slope's length is below `length` >= 0.
    ///
    /// GGX: r^2/(1 + r^2). Beckmann: 1 - exp(-r^2). Student: 1 - (1 + r^2/power)^-power. Grains, with L =
    /// -ln(1 - coverage): 1 + exp(-L) - exp(-L r^2/(1 + r^2)), from 1 - coverage at r = 0 on.
    // Tested by `length_law_and_quantile_are_inverse`.
    pub fn length_cdf(self, length: f64) -> f64 {
        let r2 = length * length;
        match self {
            SlopeLaw::Ggx => r2 / (1.0 + r2),
            SlopeLaw::Beckmann => -(-r2).exp_m1(),
            SlopeLaw::StudentT { power } => -(-power * (r2 / power).ln_1p()).exp_m1(),
            SlopeLaw::Grains { coverage } => {
                (1.0 - coverage) - ((-coverage).ln_1p() * r2 / (1.0 + r2)).exp_m1()
            }
        }
    }

    /// Length below which the share `u` in [0, 1) of the slopes lies.
    ///
    /// GGX: sqrt(u/(1 - u)). Beckmann: sqrt(-ln(1 - u)). Student: sqrt(power ((1 - u)^(-1/power) - 1)). Grains:
    /// sqrt(w/(1 - w)) with w = ln(1 - (u - (1 - coverage)))/ln(1 - coverage), 0 below the plane's share.
    pub fn length_quantile(self, u: f64) -> f64 {
        match self {
            SlopeLaw::Ggx => (u / (1.0 - u)).sqrt(),
            SlopeLaw::Beckmann => (-(-u).ln_1p()).sqrt(),
            SlopeLaw::StudentT { power } => (power * (-(-u).ln_1p() / power).exp_m1()).sqrt(),
            SlopeLaw::Grains { coverage } => {
                let w = (-(u - (1.0 - coverage)).max(0.0)).ln_1p() / (-coverage).ln_1p();
                (w / (1.0 - w)).sqrt()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn length_law_and_quantile_are_inverse() {
        let students = [SlopeLaw::student_t(2.0), SlopeLaw::student_t(3.5), SlopeLaw::blinn_phong(198.0)];
        let grains = SlopeLaw::Grains { coverage: 0.99 };
        for law in [SlopeLaw::Ggx, SlopeLaw::Beckmann, grains].into_iter().chain(students) {
            // Of grains, 1 % of the slopes are 0.
            let atom = if law == grains { 0.01 } else { 0.0 };
            for u in [0.0, 1e-12, 0.01, 0.5, 0.9, 0.999_999].map(|u: f64| u.max(atom)) {
                // 1 - u amplifies the rounding of the quantile by at most 1/(1 - u) = 1e6.
                let back = law.length_cdf(law.length_quantile(u));
                assert!((back - u).abs() <= 4.0 * f64::EPSILON * (1e-12f64).max(1.0), "{law:?} {u} {back}");
            }
        }
        // Closed forms: the GGX median is 1, the Beckmann median sqrt(ln 2).
        assert_eq!(SlopeLaw::Ggx.length_quantile(0.5), 1.0);
        assert!((SlopeLaw::Beckmann.length_quantile(0.5) - 2f64.ln().sqrt()).abs() < 1e-15);
    }

    #[test]
    fn students_law_goes_from_ggx_to_beckmann() {
        for u in [0.01, 0.5, 0.9, 0.999] {
            let length = |law: SlopeLaw| law.length_quantile(u);
            // gamma = 2: the same formula in another spelling, a logarithm and an exponential apart.
            let (student, ggx) = (length(SlopeLaw::student_t(2.0)), length(SlopeLaw::Ggx));
            assert!((student - ggx).abs() < 8.0 * f64::EPSILON * ggx, "{u}: {student} {ggx}");
            // power -> infinity: r^2 = L + L^2/(2 power) + ..., L = -ln(1 - u) <= 7.
            let (student, beckmann) = (length(SlopeLaw::blinn_phong(2e6 - 2.0)), length(SlopeLaw::Beckmann));
            assert!((student / beckmann - 1.0).abs() < 7.0 / 4.0 * 1e-6, "{u}: {student} {beckmann}");
        }
    }
}
