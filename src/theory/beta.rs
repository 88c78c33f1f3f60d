//! The Beta function of two Lambdas, which joins the masking of arms on opposite sides of a surface.
//!
//! Input: two numbers in [0, inf]. Output: B(1 + a, 1 + b), [0, 1].

use std::f64::consts::TAU;

/// From here on the logarithm of Gamma is Stirling's series.
const LARGE: f64 = 10.0;

/// B(1 + a, 1 + b) = integral over t from 0 to 1 of t^a (1 - t)^b.
///
/// - `a`, `b`: in [0, inf]. Returns [0, 1]; 0 where one is infinite. Swapping them gives the same bits.
/// - Numerics: with p = 1 + a <= q = 1 + b. Below 10 three Gammas, each right to 2e-14. Beyond, Stirling's series of the logarithms of
///   Gamma(q) and Gamma(p + q), whose large parts cancel on paper: q^(q - 1/2)/(p + q)^(p + q - 1/2) goes through
///   ln(1 - p/(p + q)). What is left rounds in proportion to the logarithm of the result: relative error below 1e-12
///   where the result is above 1e-300.
/// - Source: the relations of Didonato and Morris 1992 (ACM algorithm 708), our own arrangement.
// Tested by `the_beta_function_matches_mpmath` (tests/it/transmission_values.rs), `the_ends_of_beta_are_known`.
pub fn beta_of_lambdas(a: f64, b: f64) -> f64 {
    let (p, q) = (1.0 + a.min(b), 1.0 + a.max(b));
    if q == f64::INFINITY {
        return 0.0;
    }
    if p == 1.0 {
        return 1.0 / q;
    }
    if q < LARGE {
        return gamma(p) * gamma(q) / gamma(p + q);
    }
    // ln of q^(q - 1/2)/(p + q)^(q - 1/2), without its difference of large numbers.
    let rest = (q - 0.5) * (-p / (p + q)).ln_1p();
    if p < LARGE {
        let corrections = stirling(q) - stirling(p + q);
        return gamma(p) * (p + rest - p * (p + q).ln() + corrections).exp();
    }
    let corrections = stirling(p) + stirling(q) - stirling(p + q);
    (TAU / (p + q)).sqrt() * ((p - 0.5) * (p / (p + q)).ln() + rest + corrections).exp()
}

/// Gamma(x), x in [1, 20): Stirling's formula at x + m >= 10, over x (x + 1) ... (x + m - 1). A third of the time of a
/// Gamma for any number, and fits evaluate three for each direction and step.
fn gamma(x: f64) -> f64 {
    let (mut y, mut product) = (x, 1.0);
    while y < LARGE {
        product *= y;
        y += 1.0;
    }
    (TAU / y).sqrt() * (y * (y.ln() - 1.0) + stirling(y)).exp() / product
}

/// ln Gamma(x) - ((x - 1/2) ln x - x + ln(2 pi)/2) for x >= 10: seven terms of Stirling's series, the eighth is 3e-17.
fn stirling(x: f64) -> f64 {
    const TERMS: [f64; 7] = [
        1.0 / 12.0,
        -1.0 / 360.0,
        1.0 / 1260.0,
        -1.0 / 1680.0,
        1.0 / 1188.0,
        -691.0 / 360_360.0,
        1.0 / 156.0,
    ];
    let inverse2 = (1.0 / x) / x;
    TERMS.iter().rev().fold(0.0, |sum, term| sum * inverse2 + term) / x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_beta_are_known() {
        assert_eq!(beta_of_lambdas(0.0, 0.0), 1.0);
        // t^0 (1 - t)^b: 1/(1 + b), from b = 1e300 to where b is lost in the 1.
        for b in [1e-300, 1e-3, 1.0, 20.0, 1e8, 1e300] {
            assert_eq!(beta_of_lambdas(0.0, b), 1.0 / (1.0 + b));
        }
        for a in [0.0, 3.0, 50.0, f64::INFINITY] {
            assert_eq!(beta_of_lambdas(a, f64::INFINITY), 0.0);
        }
    }

    #[test]
    fn whole_lambdas_are_quotients_of_factorials() {
        // B(1 + m, 1 + n) = m! n!/(m + n + 1)! = product over k from 1 to m of k/(n + k), over n + m + 1.
        for m in [1.0f64, 2.0, 8.0, 9.0, 10.0, 30.0] {
            for n in [1.0f64, 5.0, 9.0, 11.0, 200.0, 1e6] {
                let factors = (1..=m as u32).map(|k| f64::from(k) / (n + f64::from(k)));
                let expected = factors.product::<f64>() / (n + m + 1.0);
                let found = beta_of_lambdas(m, n);
                // As documented; 60 roundings of the product are less.
                assert!((found - expected).abs() < 1e-12 * expected, "{m} {n}: {found} {expected}");
                assert_eq!(found.to_bits(), beta_of_lambdas(n, m).to_bits());
            }
        }
    }

    #[test]
    fn the_three_forms_meet() {
        // On either side of p = 10 and of q = 10 the value moves by its slope alone: |d ln B/dq| < 4 times 1e-13.
        for (a, b) in [(0.5, 9.0), (8.9, 9.0), (9.0, 9.0), (9.0, 300.0)] {
            let (below, above) = (beta_of_lambdas(a, b - 1e-13), beta_of_lambdas(a, b + 1e-13));
            let lower = beta_of_lambdas(a - 1e-13, b);
            assert!((below / above - 1.0).abs() < 2e-12 && (lower / above - 1.0).abs() < 4e-12, "{a} {b}");
        }
    }
}
