//! Least squares of one model: residuals, Jacobian, the crate's Levenberg-Marquardt, and the errors that follow.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};
use rayon::prelude::*;

use super::data::Data;
use super::law::{Amplitudes, Law};
use super::nodes::StopNodes;

/// Step of the central differences in the (logarithmic) shape: the bases are smooth, so their error is 1e-8 squared
/// by third derivatives and 1e-12 by rounding.
const STEP: f64 = 1e-4;
/// Largest jump of a logarithm from its start: beyond, the lobe is a point or the whole hemisphere.
const REACH: f64 = 12.0;

/// Relative change of the sum of squares and of the parameters at which a fit ends.
pub const EXACT: f64 = 1e-10;
/// The same for a fit that starts near its end, of which only the distance counts.
pub const NEAR: f64 = 1e-6;

/// One model against one set of values.
#[derive(Clone)]
pub struct Problem<'a> {
    data: &'a Data,
    nodes: &'a [StopNodes],
    law: Law,
    target: &'a [Vec<f64>],
    params: DVector<f64>,
    start: DVector<f64>,
    /// Both bases of every entry at `params`.
    basis: Vec<[f64; 2]>,
}

/// Where the iteration ended.
pub struct Solution {
    /// Shape first, then the amplitudes of each colour.
    pub params: Vec<f64>,
    /// Sum of the squared residuals.
    pub chi_square: f64,
    /// Whether one of the criteria of convergence was met.
    pub converged: bool,
}

impl<'a> Problem<'a> {
    /// The problem of fitting `law` to `target` ([colour][entry]) from `params`.
    pub fn new(
        data: &'a Data,
        nodes: &'a [StopNodes],
        law: Law,
        target: &'a [Vec<f64>],
        params: Vec<f64>,
    ) -> Self {
        let params = DVector::from_vec(params);
        let mut problem =
            Problem { data, nodes, law, target, start: params.clone(), params, basis: Vec::new() };
        problem.basis = problem.basis_at(problem.shape());
        problem
    }

    /// Minimises the sum of squares until its relative change, or the parameters', is below `tolerance`.
    pub fn solve(self, tolerance: f64) -> (Self, Solution) {
        if self.params.is_empty() {
            let residuals = self.residuals_of(&self.basis);
            let chi_square = residuals.norm_squared();
            return (self, Solution { params: vec![], chi_square, converged: true });
        }
        let method = LevenbergMarquardt::new().with_ftol(tolerance).with_xtol(tolerance).with_gtol(0.0);
        let (problem, report) = method.minimize(self);
        let solution = Solution {
            params: problem.params.as_slice().to_vec(),
            chi_square: 2.0 * report.objective_function,
            converged: report.termination.was_successful(),
        };
        (problem, solution)
    }

    /// The inverse of J'J at the parameters; `None` where it is singular.
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        let jacobian = self.jacobian_at();
        let normal = jacobian.transpose() * &jacobian;
        normal.try_inverse().filter(|inverse| inverse.iter().all(|entry| entry.is_finite()))
    }

    /// The model's means at the parameters, [colour][entry].
    pub fn model(&self) -> Vec<Vec<f64>> {
        let colour = |colour| self.basis.iter().map(|basis| self.value(colour, *basis)).collect();
        (0..self.target.len()).map(colour).collect()
    }

    fn shape(&self) -> &[f64] {
        &self.params.as_slice()[..self.params.len() - self.per_colour() * self.target.len()]
    }

    fn per_colour(&self) -> usize {
        amplitudes_per_colour(self.law.amplitudes(self.data.perfect_mirror))
    }

    fn amplitude(&self, colour: usize, k: usize) -> f64 {
        self.params[self.shape().len() + colour * self.per_colour() + k]
    }

    fn basis_at(&self, shape: &[f64]) -> Vec<[f64; 2]> {
        self.nodes.par_iter().map(|nodes| self.law.means(shape, nodes)).collect::<Vec<_>>().concat()
    }

    fn value(&self, colour: usize, [a, b]: [f64; 2]) -> f64 {
        match self.law.amplitudes(self.data.perfect_mirror) {
            Amplitudes::Fixed => a,
            Amplitudes::Schlick => self.amplitude(colour, 0) * (a - b) + b,
            Amplitudes::One => self.amplitude(colour, 0) * a,
            Amplitudes::Two => self.amplitude(colour, 0) * a + self.amplitude(colour, 1) * b,
        }
    }

    /// What amplitude `k` is multiplied with.
    fn slope(&self, k: usize, [a, b]: [f64; 2]) -> f64 {
        match self.law.amplitudes(self.data.perfect_mirror) {
            Amplitudes::Schlick => a - b,
            _ if k == 0 => a,
            _ => b,
        }
    }

    fn residuals_of(&self, basis: &[[f64; 2]]) -> DVector<f64> {
        let entries = basis.len();
        DVector::from_fn(entries * self.target.len(), |row, _| {
            let (colour, entry) = (row / entries, row % entries);
            (self.value(colour, basis[entry]) - self.target[colour][entry]) / self.data.sigma[colour][entry]
        })
    }

    fn jacobian_at(&self) -> DMatrix<f64> {
        let (entries, shapes, per_colour) = (self.basis.len(), self.shape().len(), self.per_colour());
        let mut jacobian = DMatrix::zeros(entries * self.target.len(), self.params.len());
        for column in 0..shapes {
            let moved = |step: f64| {
                let mut shape = self.shape().to_vec();
                shape[column] += step;
                self.residuals_of(&self.basis_at(&shape))
            };
            jacobian.set_column(column, &((moved(STEP) - moved(-STEP)) / (2.0 * STEP)));
        }
        for colour in 0..self.target.len() {
            for k in 0..per_colour {
                let mut column = jacobian.column_mut(shapes + colour * per_colour + k);
                for (entry, basis) in self.basis.iter().enumerate() {
                    column[colour * entries + entry] = self.slope(k, *basis) / self.data.sigma[colour][entry];
                }
            }
        }
        jacobian
    }
}

/// Amplitudes that each colour adds to the parameters.
pub fn amplitudes_per_colour(amplitudes: Amplitudes) -> usize {
    match amplitudes {
        Amplitudes::Fixed => 0,
        Amplitudes::Schlick | Amplitudes::One => 1,
        Amplitudes::Two => 2,
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, params: &DVector<f64>) {
        self.params.copy_from(params);
        self.basis = self.basis_at(self.shape());
    }

    fn params(&self) -> DVector<f64> {
        self.params.clone()
    }

    /// `None`, which ends the iteration, where a shape has run away.
    fn residuals(&self) -> Option<DVector<f64>> {
        let shapes = self.shape().len();
        let near = (0..shapes).all(|k| (self.params[k] - self.start[k]).abs() < REACH);
        near.then(|| self.residuals_of(&self.basis)).filter(|r| r.iter().all(|value| value.is_finite()))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        Some(self.jacobian_at())
    }
}
