//! Smith's Lambda of GGX and of Beckmann, as the projected one, cos Lambda, or as a Lambda(a), both finite at the horizon.
//!
//! Input: the cosine of an arm and s^2 = (alpha_x w.x)^2 + (alpha_y w.y)^2, or a = 1/(alpha tan theta) = cos/s.

use std::f64::consts::PI;
use std::sync::LazyLock;

/// cos Lambda of GGX: s2/(2 (cos + sqrt(cos^2 + s2))), s2 = (ax wx)^2 + (ay wy)^2.
pub(super) fn ggx_projected_lambda(cos: f64, s2: f64) -> f64 {
    if s2 == 0.0 {
        return 0.0;
    }
    s2 / (2.0 * (cos + (cos * cos + s2).sqrt()))
}

/// cos Lambda = sqrt(s2) (a Lambda(a)) with a = cos/sqrt(s2).
pub(super) fn projected_lambda(cos: f64, s2: f64, a_lambda: impl Fn(f64) -> f64) -> f64 {
    if s2 == 0.0 {
        return 0.0;
    }
    let s = s2.sqrt();
    s * a_lambda(cos / s)
}

/// Beckmann's Lambda(a) = (erf(a) - 1)/2 + exp(-a^2)/(2 a sqrt(pi)), a = 1/(alpha tan theta) > 0.
///
/// - Returns [0, inf); underflows to 0 above a = 27.
/// - Numerics: relative error 6e-16 at most against 170 values of 40 digits and more, a from 1e-4 to 26.
/// - Cost: about 12 ns below a = 1, 70 ns from there to `WIDER`, 35 ns and less beyond.
/// - Source: Heitz 2014, section on Beckmann; Walter et al. 2007.
// Tested by `beckmann_lambda_matches_forty_digits`.
pub fn beckmann_lambda(a: f64) -> f64 {
    beckmann_a_lambda(a) / a
}

/// From here on the step of the rule may be twice as wide, from twice this on three times.
const WIDER: f64 = 2.25;

/// Terms of a rule of quadrature, by fours.
type Rule = Vec<[(f64, f64); 4]>;

/// Rules of step 1/7, 2/7 and 3/7 up to t = 6.57, where t^2 exp(-t^2) is 8e-18: (t^2, t^2 exp(-t^2) step/pi), by fours, the last
/// ones filled up with terms of no weight.
static TRAPEZOIDS: LazyLock<[Rule; 3]> = LazyLock::new(|| {
    let term = |k: usize, every: usize| {
        let t = k as f64 / 7.0;
        let t2 = t * t;
        (t2, if k > 46 { 0.0 } else { t2 * (-t2).exp() * every as f64 / (7.0 * PI) })
    };
    [1, 2, 3].map(|every| {
        let fours = (0..46usize.div_ceil(4 * every)).map(|four| 4 * four + 1);
        fours.map(|first| std::array::from_fn(|lane| term((first + lane) * every, every))).collect()
    })
});

/// a Lambda(a) of Beckmann, finite at a = 0 where it is 1/(2 sqrt(pi)).
///
/// Below 1 it is (exp(-a^2)/sqrt(pi) - a erfc(a))/2, whose terms differ by at least a factor 1.3. From 1 on the
/// identity sqrt(pi) erfc(a) exp(a^2) = (2/sqrt(pi)) int_0^inf a exp(-t^2)/(a^2 + t^2) dt turns it into
/// (exp(-a^2)/pi) int_0^inf exp(-t^2) t^2/(a^2 + t^2) dt: positive terms only. The pole at t = i a puts the trapezoid
/// rule of step 1/7 off by pi a exp(a^2 - 14 pi a), 3e-18 of the integral at a = 1 and less beyond; that of 2/7 by
/// pi a exp(a^2 - 7 pi a), 4e-18 at `WIDER`, that of 3/7 by 8e-18 at twice `WIDER`. exp(-(pi/step)^2), the Gaussian's part, is
/// 5e-24 at most.
pub(super) fn beckmann_a_lambda(a: f64) -> f64 {
    if a < 1.0 {
        return 0.5 * ((-a * a).exp() / PI.sqrt() - a * libm::erfc(a));
    }
    let a2 = a * a;
    if a2 > 746.0 {
        return 0.0; // exp(-a^2) underflows
    }
    let mut sums = [0.0; 4];
    for terms in &TRAPEZOIDS[((a / WIDER) as usize).min(2)] {
        // Four sums at a time wait for no division of the others.
        for (sum, (t2, weight)) in sums.iter_mut().zip(terms) {
            *sum += weight / (a2 + t2);
        }
    }
    let sum: f64 = sums.iter().sum();
    // exp(-a^2) with the rounding of the square put back: at a = 26 it would cost 7e-14.
    let rest = a.mul_add(a, -a2);
    (-a2).exp() * (1.0 - rest) * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beckmann_lambda_matches_forty_digits() {
        // mpmath at 40 digits and more, (a, Lambda(a)); `a` as printed is the f64 itself.
        let table = include_str!("../../tests/data/beckmann_lambda.csv");
        let mut rows = 0;
        for line in table.lines().skip(1) {
            let (a, expected) = line.split_once(',').expect("two columns");
            let (a, expected): (f64, f64) = (a.parse().expect("a"), expected.parse().expect("lambda"));
            let found = beckmann_lambda(a);
            // Below a = 1 the two terms leave a seventh, each right to an ulp. Above: 46 positive terms, and exp.
            assert!((found - expected).abs() <= 7.0 * f64::EPSILON * expected, "{a}: {found} {expected}");
            rows += 1;
        }
        assert_eq!(rows, 170);
        assert_eq!((beckmann_lambda(30.0), beckmann_lambda(1e4)), (0.0, 0.0));
    }
}
