//! The law of propagation of uncertainty: JCGM 100:2008 (GUM).

use serde::Serialize;

use crate::stats;

/// Probability outside of the intervals of a budget.
pub const OUTSIDE: f64 = 0.05;

/// One input of a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// dy/dx.
    pub sensitivity: f64,
    /// u(x).
    pub uncertainty: f64,
    /// Degrees of freedom of u(x); `None`: it is known.
    pub dof: Option<f64>,
}

/// The uncertainty of a value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Combined {
    /// u_c.
    pub standard_uncertainty: f64,
    /// Effective degrees of freedom; null: infinitely many.
    pub dof: Option<f64>,
    /// k at 95 %.
    pub coverage_factor: f64,
    /// U = k u_c.
    pub expanded: f64,
}

/// u_c^2 = sum c_i c_j r_ij u_i u_j and, by Welch and Satterthwaite, nu = u_c^4/sum (c_i u_i)^4/nu_i (JCGM 100, 5.2.2, G.4).
///
/// - `factor`: L of the correlation matrix L L^T of the first terms; the others are independent.
/// - u_c^2 is a sum of squares, |L^T (c u)|^2: correlations of +-1 cancel without a negative rest.
// Tested by `the_gum_example_h1` (tests/it/budget/methods.rs).
pub fn combine(terms: &[Term], factor: &[Vec<f64>]) -> Combined {
    let parts: Vec<f64> = terms.iter().map(|term| term.sensitivity * term.uncertainty).collect();
    let (correlated, independent) = parts.split_at(factor.len().min(parts.len()));
    let along =
        |column: usize| correlated.iter().zip(factor).map(|(part, row)| part * row[column]).sum::<f64>();
    let squares = (0..factor.len()).map(along).chain(independent.iter().copied()).map(|part| part * part);
    let variance: f64 = squares.sum();
    let shares = terms.iter().zip(&parts).filter_map(|(term, part)| Some(part.powi(4) / term.dof?));
    let unknown: f64 = shares.sum();
    let dof = (unknown > 0.0).then(|| variance * variance / unknown);
    let (standard_uncertainty, coverage_factor) = (variance.sqrt(), coverage_factor(OUTSIDE, dof));
    Combined { standard_uncertainty, dof, coverage_factor, expanded: coverage_factor * standard_uncertainty }
}

/// The limit that |t| exceeds with probability `outside`; degrees of freedom are cut to a whole number (JCGM 100, G.4.1),
/// at least 1.
// Tested by `limits_of_many_degrees_of_freedom_are_those_of_tables` (tests/it/budget/methods.rs).
pub fn coverage_factor(outside: f64, dof: Option<f64>) -> f64 {
    match dof {
        None => stats::normal_limit(outside),
        Some(dof) => stats::student_limit(outside, (dof as usize).max(1)),
    }
}

/// Half a unit of the last of `digits` significant digits of `u` >= 0, one or two, none of 0: the tolerance of JCGM 101, 8.1.
// Tested by `the_tolerance_is_half_a_unit_of_the_last_digit` (tests/it/budget/methods.rs).
pub fn tolerance(u: f64, digits: usize) -> f64 {
    if u == 0.0 {
        return 0.0;
    }
    // Through text, which rounds as a reader does: 0.0996 has the digits 10 and the power of 0.1.
    let behind = digits.saturating_sub(1);
    let text = format!("{u:.behind$e}");
    let power: i32 = text.split_once('e').and_then(|(_, power)| power.parse().ok()).unwrap_or(0);
    0.5 * 10f64.powi(power - behind as i32)
}
