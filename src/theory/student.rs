//! Smith's Lambda of Student's t of slopes (Ribardiere et al. 2017), of which Blinn and Phong's normals are members.
//!
//! Input: a = 1/(alpha tan theta) and power = gamma - 1. Output: a Lambda(a), the mean height by which slopes exceed
//! a: with P the law of the slopes along one axis, the integral of (p - a) P(p) from a on. P is Student's t with
//! 2 power degrees of freedom: P(p) = (1 + p^2/power)^-(power + 1/2)/(sqrt(power) B(power, 1/2)).

use statrs::function::beta::{beta_reg, ln_beta};

/// a Lambda(a), finite at a = 0.
///
/// With g the power and x = g/(g + a^2), S = sqrt(g) x^(g - 1/2)/B(g, 1/2): up to a^2 = g it is S/(2g - 1) - a I_x(g,
/// 1/2)/2. Beyond, where the two terms are nearly equal, the hypergeometric series of I_x leaves S/(2g) (1/(2g - 1) +
/// 1/2 sum_k c_(k-1) x^k/(g + k)), c_0 = 1, c_k = c_(k-1) (g + k - 1/2)/(g + k): positive terms only.
///
/// - Domain: a >= 0, 1 <= power <= 1e4.
/// - Numerics: relative error below 3e-14 (1 + p (1 + ln p)) (1 + 2 min(a^2, p)), p the power, against 143 values of 120
///   digits: the logarithms of Gamma, and a difference that loses a factor 2 a^2 at most.
/// - Cost: about 1 us.
/// - Source: the moments of Student's t; GGX at power = 1: (sqrt(1 + a^2) - a)/2.
// Tested by `students_lambda_matches_a_hundred_digits`, `students_lambda_with_power_one_is_that_of_ggx`.
pub fn student_a_lambda(a: f64, power: f64) -> f64 {
    let a2 = a * a;
    let log_x = -(a2 / power).ln_1p();
    let scale = power.sqrt() * ((power - 0.5) * log_x - ln_beta(power, 0.5)).exp();
    let x = power / (power + a2);
    if a2 < power {
        return scale / (2.0 * power - 1.0) - 0.5 * a * beta_reg(power, 0.5, x);
    }
    let (mut sum, mut coefficient, mut k) = (0.0, x, 1.0);
    loop {
        let term = coefficient / (power + k);
        sum += term;
        // x <= 1/2: what is left is less than the last term.
        if term <= 0.25 * f64::EPSILON * sum || term == 0.0 {
            break;
        }
        coefficient *= x * (power + k - 0.5) / (power + k);
        k += 1.0;
    }
    0.5 * scale / power * (1.0 / (2.0 * power - 1.0) + 0.5 * sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn students_lambda_matches_a_hundred_digits() {
        // mpmath at 120 digits: (power, a, Lambda(a)).
        let table = include_str!("../../tests/data/student_lambda.csv");
        let mut rows = 0;
        for line in table.lines().skip(1) {
            let mut fields = line.split(',').map(|field| field.parse::<f64>().expect("a number"));
            let (power, a, expected) =
                (fields.next().expect("power"), fields.next().expect("a"), fields.next().expect("lambda"));
            let found = student_a_lambda(a, power) / a;
            // Three logarithms of Gamma, about power (1 + ln power) large: the statrs crate's series has them to 1e-14 of
            // that. The difference of two terms magnifies it by 2 a^2.
            let logarithms = 3e-14 * (1.0 + power * (1.0 + power.ln()));
            let tolerance = logarithms * (1.0 + 2.0 * (a * a).min(power));
            assert!((found / expected - 1.0).abs() <= tolerance, "{power} {a}: {found} {expected}");
            rows += 1;
        }
        assert_eq!(rows, 143);
    }

    #[test]
    fn students_lambda_with_power_one_is_that_of_ggx() {
        for a in [0.0f64, 1e-8, 0.3, 0.999, 1.0, 7.0, 1e3, 1e6] {
            let expected = 0.5 / ((1.0 + a * a).sqrt() + a);
            // As above with power 1: 67 ulp times 3.
            let found = student_a_lambda(a, 1.0);
            assert!((found - expected).abs() <= 201.0 * f64::EPSILON * expected, "{a}: {found} {expected}");
        }
    }
}
