//! Statistics over realisations: mean, standard error, Student t, chi-square, Sidak. Imports nothing of the crate.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use statrs::function::gamma::{gamma_ur, ln_gamma};

/// Mean and the standard error of the mean of independent values; the error is `None` for fewer than two.
///
/// se^2 = sum (x - mean)^2/(n (n - 1)), in two passes: nothing cancels.
// Tested by `mean_and_error_by_hand`.
pub fn mean_and_se(values: impl Iterator<Item = f64> + Clone) -> (f64, Option<f64>) {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let squares: f64 = values.map(|x| (x - mean) * (x - mean)).sum();
    (mean, (count > 1.0).then(|| (squares / (count * (count - 1.0))).sqrt()))
}

/// [`mean_and_se`] of values that there may be none of.
pub fn known_mean(values: impl Iterator<Item = f64> + Clone) -> (Option<f64>, Option<f64>) {
    if values.clone().next().is_none() {
        return (None, None);
    }
    let (mean, se) = mean_and_se(values);
    (Some(mean), se)
}

/// Bins below this share of their peak do not count in medians of relative errors.
pub const COUNTED_ABOVE: f64 = 0.01;

/// The upper median, which is one of the values; `None` without values. The values are sorted.
pub fn upper_median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Standard error of what n groups give together, from what all but one of them give: the jackknife's
/// sqrt((n - 1)/n sum (x - mean)^2), source Efron and Stein 1981. `None` for fewer than two.
// Tested by `leaving_one_out_gives_the_standard_error_of_a_mean`.
pub fn jackknife_se(without: &[f64]) -> Option<f64> {
    let (count, mean) = (without.len() as f64, mean(without));
    let squares: f64 = without.iter().map(|value| (value - mean) * (value - mean)).sum();
    (count > 1.0).then(|| ((count - 1.0) / count * squares).sqrt())
}

/// E\[s\]/sigma of a normal sample of `n` >= 2: the bias of the sample standard deviation.
///
/// c4(n) = sqrt(2/(n-1)) Gamma(n/2)/Gamma((n-1)/2).
// Tested by `c4_matches_published_values`.
pub fn c4(n: usize) -> f64 {
    let n = n as f64;
    (2.0 / (n - 1.0)).sqrt() * (ln_gamma(0.5 * n) - ln_gamma(0.5 * (n - 1.0))).exp()
}

/// Degrees of freedom from which on Student's limit is that of a series about the normal one: `statrs` inverts the law to
/// 1e-8 and better below, and loses its digits above (1.83 for 1.96 at 10^7).
const MANY: usize = 10_000;

/// The limit that |t| of `dof` degrees of freedom exceeds with probability `p` (two-sided), 0 < p < 1, dof >= 1.
///
/// Many: z + (z^3 + z)/(4 nu) + (5 z^5 + 16 z^3 + 3 z)/(96 nu^2), Abramowitz and Stegun 26.7.5; the next term is below
/// z^7/(128 nu^3), 1e-9 at z = 5.
// Tested by `student_limits_match_published_values` and `limits_of_many_degrees_of_freedom_are_those_of_tables`
// (tests/it/budget/methods.rs).
pub fn student_limit(p: f64, dof: usize) -> f64 {
    if dof >= MANY {
        let (nu, z) = (dof as f64, normal_limit(p));
        let z2 = z * z;
        let (first, second) = ((z2 + 1.0) * z / 4.0, ((5.0 * z2 + 16.0) * z2 + 3.0) * z / 96.0);
        return z + first / nu + second / (nu * nu);
    }
    let t = StudentsT::new(0.0, 1.0, dof as f64).expect("dof >= 1");
    // The lower tail keeps its digits where 1 - p/2 would lose them.
    -t.inverse_cdf(0.5 * p)
}

/// The limit that the absolute value of a normal number exceeds with probability `p` (two-sided), 0 < p < 1.
pub fn normal_limit(p: f64) -> f64 {
    -Normal::standard().inverse_cdf(0.5 * p)
}

/// The probability that |t| of `dof` degrees of freedom is larger (two-sided), dof >= 1.
pub fn student_p(t: f64, dof: usize) -> f64 {
    let law = StudentsT::new(0.0, 1.0, dof as f64).expect("dof >= 1");
    2.0 * law.cdf(-t.abs())
}

/// Level of each of `tests` independent tests that keeps the family's level: 1 - (1 - level)^(1/tests).
pub fn sidak(level: f64, tests: usize) -> f64 {
    -((-level).ln_1p() / tests as f64).exp_m1()
}

/// Mean of a slice, 0 if it is empty.
pub fn mean(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
}

/// Probability that chi-square of `dof` degrees of freedom exceeds `chi_square`: the upper tail Q(dof/2, x/2) itself.
pub fn chi_square_p(chi_square: f64, dof: usize) -> f64 {
    if chi_square <= 0.0 { 1.0 } else { gamma_ur(0.5 * dof as f64, 0.5 * chi_square) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_error_by_hand() {
        // Values 1, 2, 3, 6 about 1e9: mean 3, squares 4 + 1 + 0 + 9 = 14, se = sqrt(14/12).
        let (mean, se) = mean_and_se([1.0, 2.0, 3.0, 6.0].into_iter().map(|x| x + 1e9));
        assert_eq!(mean, 1e9 + 3.0);
        assert!((se.unwrap() - (14.0f64 / 12.0).sqrt()).abs() < 1e-15);
        assert_eq!(mean_and_se([5.0].into_iter()), (5.0, None));
    }

    /// The jackknife of a mean is its standard error.
    #[test]
    fn leaving_one_out_gives_the_standard_error_of_a_mean() {
        let values = [1.0, 4.0, 2.0, 9.0, 5.0];
        let without = |k: usize| (values.iter().sum::<f64>() - values[k]) / 4.0;
        let found = jackknife_se(&[0, 1, 2, 3, 4].map(without)).expect("five values");
        let (_, se) = mean_and_se(values.iter().copied());
        assert!((found - se.expect("five values")).abs() < 1e-14);
    }

    #[test]
    fn c4_matches_published_values() {
        // Tables of control-chart constants, six digits.
        for (n, value) in [(2, 0.797_885), (3, 0.886_227), (10, 0.972_659), (25, 0.989_640)] {
            assert!((c4(n) - value).abs() < 6e-7, "{n}: {}", c4(n));
        }
    }

    #[test]
    fn student_limits_match_published_values() {
        // Tables of Student's t, 97.5 %, three digits after the point.
        for (dof, value) in [(1, 12.706), (4, 2.776), (7, 2.365), (15, 2.131), (30, 2.042)] {
            assert!((student_limit(0.05, dof) - value).abs() < 6e-4, "{dof}: {}", student_limit(0.05, dof));
        }
    }

    #[test]
    fn sidak_keeps_digits_for_many_tests() {
        assert!((sidak(0.01, 5) - 0.002_008_05).abs() < 1e-8);
        // ln(1/0.99)/1e6 to first order.
        assert!((sidak(0.01, 1_000_000) - 1.005_033_585e-8).abs() < 1e-16);
    }
}
