//! Schlick paths of several bounces for every F0 at once.
//!
//! A path of k bounces with w_j = (1 - c_j)^5 reflects prod_j (F0 + (1 - F0) w_j), which is
//! sum_m e_m F0^(k-m) (1-F0)^m with e_m the elementary symmetric polynomials of the w_j: its *parts*. All are positive, so
//! nothing cancels, and sums of parts over paths are the parts of the sum.

use super::fresnel::FacetAngle;

/// The parts e_0 ... e_k of a path by the angles at its k facets, into `parts`.
///
/// - e_0 = 1; e_m is the sum over all choices of m facets of the product of their (1-c)^5. Each in [0, C(k, m)].
/// - Numerics: sums of positive products, a relative error of a few ulp for each facet.
// Tested by `parts_are_the_product_for_any_f0`.
pub fn of_path(angles: &[FacetAngle], parts: &mut Vec<f64>) {
    parts.clear();
    parts.push(1.0);
    for angle in angles {
        let w = angle.schlick_weight();
        parts.push(0.0);
        for m in (1..parts.len()).rev() {
            parts[m] += w * parts[m - 1];
        }
    }
}

/// The same polynomial in terms of degree `degree`, added to `sums[0..=degree]`: times (F0 + (1 - F0))^(degree - k).
///
/// - Domain: `parts` has at most degree + 1 entries. Binomials are exact up to degree 50.
// Tested by `parts_are_the_product_for_any_f0`.
pub fn add_raised(parts: &[f64], degree: usize, sums: &mut [f64]) {
    let more = degree + 1 - parts.len();
    let mut binomial = 1.0;
    for j in 0..=more {
        for (m, part) in parts.iter().enumerate() {
            sums[m + j] += binomial * part;
        }
        binomial *= (more - j) as f64 / (j + 1) as f64;
    }
}

/// What `parts` of degree n are for one F0: sum_m parts_m F0^(n-m) (1-F0)^m.
///
/// - `f0`: [0, 1]. 0 without parts.
/// - Numerics: positive terms only.
// Tested by `parts_are_the_product_for_any_f0`.
pub fn at_f0(parts: impl IntoIterator<Item = f64, IntoIter: ExactSizeIterator>, f0: f64) -> f64 {
    let parts = parts.into_iter();
    let degree = parts.len().saturating_sub(1) as i32;
    (0..).zip(parts).map(|(m, part)| part * f0.powi(degree - m) * (1.0 - f0).powi(m)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::fresnel::f_schlick;
    use crate::sphere::sin_cos_deg;

    #[test]
    fn parts_are_the_product_for_any_f0() {
        let angles: Vec<FacetAngle> = [0.0, 35.0, 60.0, 75.0, 88.0]
            .iter()
            .map(|&theta| {
                let (sin, cos) = sin_cos_deg(theta);
                FacetAngle { cos, sin2: sin * sin }
            })
            .collect();
        for k in 1..=angles.len() {
            let mut parts = Vec::new();
            of_path(&angles[..k], &mut parts);
            let mut raised = vec![0.0; 9];
            add_raised(&parts, 8, &mut raised);
            for f0 in [0.0, 0.04, 0.5, 0.978, 1.0] {
                let product: f64 = angles[..k].iter().map(|&angle| f_schlick(angle, f0)).product();
                // Each of at most 9 positive terms, of at most 16 factors, is right to 16 ulp; so is the product.
                let near = |found: f64| (found - product).abs() <= 32.0 * f64::EPSILON * product.max(1e-300);
                assert!(near(at_f0(parts.iter().copied(), f0)), "{k} {f0}");
                assert!(near(at_f0(raised.iter().copied(), f0)), "{k} {f0} raised");
            }
        }
        assert_eq!(at_f0(std::iter::empty(), 0.5), 0.0);
    }
}
