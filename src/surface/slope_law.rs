//! The slope laws that a surface is made to have, in canonical form (alpha = 1), as laws of slopes.
//!
//! `theory::ndf` states the same laws as densities of normals, without sharing code: agreement is evidence.

/// A law of facet slopes, isotropic in canonical slopes (p, q).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SlopeLaw {
    /// P22 = 1/(pi (1 + p^2 + q^2)^2): infinite variance, median length 1.
    Ggx,
    /// P22 = exp(-p^2 - q^2)/pi: variance 1/2 per axis.
    Beckmann,
}

impl SlopeLaw {
    /// Probability that the slope's length is below `length` >= 0.
    ///
    /// GGX: r^2/(1 + r^2). Beckmann: 1 - exp(-r^2). Held by: `length_law_and_quantile_are_inverse`.
    pub fn length_cdf(self, length: f64) -> f64 {
        let r2 = length * length;
        match self {
            SlopeLaw::Ggx => r2 / (1.0 + r2),
            SlopeLaw::Beckmann => -(-r2).exp_m1(),
        }
    }

    /// Length below which the share `u` in [0, 1) of the slopes lies.
    ///
    /// GGX: sqrt(u/(1 - u)). Beckmann: sqrt(-ln(1 - u)).
    pub fn length_quantile(self, u: f64) -> f64 {
        match self {
            SlopeLaw::Ggx => (u / (1.0 - u)).sqrt(),
            SlopeLaw::Beckmann => (-(-u).ln_1p()).sqrt(),
        }
    }

    /// The square of `length_quantile`, in the precision of a patch's heights.
    ///
    /// Held by: `length_law_and_quantile_are_inverse`.
    #[inline]
    pub fn squared_quantile(self, u: f32) -> f32 {
        match self {
            SlopeLaw::Ggx => u / (1.0 - u),
            SlopeLaw::Beckmann => -(-u).ln_1p(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn length_law_and_quantile_are_inverse() {
        for law in [SlopeLaw::Ggx, SlopeLaw::Beckmann] {
            for u in [0.0, 1e-12, 0.01, 0.5, 0.9, 0.999_999] {
                // 1 - u amplifies the rounding of the quantile by at most 1/(1 - u) = 1e6.
                let back = law.length_cdf(law.length_quantile(u));
                let squared = f64::from(law.squared_quantile(u as f32));
                // One division or logarithm of an f32 u; 1 - u is exact, but as far off as u, relative to 1 - u.
                let relative = f64::from(f32::EPSILON) * (1.0 + u / (1.0 - u));
                assert!(
                    (squared.sqrt() - law.length_quantile(u)).abs() <= relative * squared.sqrt(),
                    "{law:?} {u}"
                );
                assert!((back - u).abs() <= 4.0 * f64::EPSILON * (1e-12f64).max(1.0), "{law:?} {u} {back}");
            }
        }
        // Closed forms: the GGX median is 1, the Beckmann median sqrt(ln 2).
        assert_eq!(SlopeLaw::Ggx.length_quantile(0.5), 1.0);
        assert!((SlopeLaw::Beckmann.length_quantile(0.5) - 2f64.ln().sqrt()).abs() < 1e-15);
    }
}
