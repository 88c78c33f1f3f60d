//! Derivatives by finite differences on common random numbers, realisation by realisation.

use crate::stats;

/// How a BRDF changes with one variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivative {
    /// First derivative of every realisation: its mean is the derivative, their spread its error.
    pub by_realisation: Vec<f64>,
    /// Estimated error of the derivative by the step that was taken.
    pub truncation: f64,
    /// Second derivative.
    pub second: f64,
    /// The step.
    pub step: f64,
}

/// Values of every realisation at -2, -1, 0, 1 and 2 steps.
pub type FivePoints<'a> = [&'a [f64]; 5];

impl Derivative {
    /// Richardson's (4 D(h) - D(2h))/3 of central differences D, and the same of second differences.
    ///
    /// Truncation: with e = |R - D(h)|/|R| = h^2 f'''/(6 f') what is left is 4 h^4 f'''''/(120 f') of the derivative,
    /// 1.2 e^2 where derivatives grow as those of a sine do; never said to be below that nor above R - D(h) itself.
    // Tested by `derivatives_of_known_functions` (tests/it/budget/methods.rs).
    pub fn of(step: f64, [minus_two, minus, middle, plus, plus_two]: FivePoints) -> Self {
        let narrow = |k: usize| (plus[k] - minus[k]) / (2.0 * step);
        let wide = |k: usize| (plus_two[k] - minus_two[k]) / (4.0 * step);
        let by_realisation: Vec<f64> = (0..middle.len()).map(|k| (4.0 * narrow(k) - wide(k)) / 3.0).collect();
        let mean = |of: &dyn Fn(usize) -> f64| stats::mean(&(0..middle.len()).map(of).collect::<Vec<f64>>());
        let (found, moved) = (stats::mean(&by_realisation), mean(&narrow));
        let change = (found - moved).abs();
        let truncation = change * (1.2 * change / found.abs().max(f64::MIN_POSITIVE)).min(1.0);
        let narrow = |k: usize| (plus[k] - 2.0 * middle[k] + minus[k]) / (step * step);
        let wide = |k: usize| (plus_two[k] - 2.0 * middle[k] + minus_two[k]) / (4.0 * step * step);
        let second = mean(&|k| (4.0 * narrow(k) - wide(k)) / 3.0);
        Derivative { by_realisation, truncation, second, step }
    }

    /// The derivative.
    pub fn value(&self) -> f64 {
        stats::mean(&self.by_realisation)
    }

    /// Its standard error over realisations; 0 for fewer than two.
    pub fn noise(&self) -> f64 {
        stats::mean_and_se(self.by_realisation.iter().copied()).1.unwrap_or(0.0)
    }
}

/// The mixed second derivative from values at (0, 0), at one step along both (`[plus, minus]`), and along each.
///
/// f_xy = (f(h, h) + f(-h, -h) - f(h, 0) - f(-h, 0) - f(0, h) - f(0, -h) + 2 f(0, 0))/(2 h^2), error of order h^2.
pub fn mixed(step: f64, middle: &[f64], both: [&[f64]; 2], first: [&[f64]; 2], second: [&[f64]; 2]) -> f64 {
    let at = |k: usize| {
        let alone: f64 = [first, second].iter().flatten().map(|values| values[k]).sum();
        (both[0][k] + both[1][k] - alone + 2.0 * middle[k]) / (2.0 * step * step)
    };
    stats::mean(&(0..middle.len()).map(at).collect::<Vec<f64>>())
}
