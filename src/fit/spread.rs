//! How far a fit would come out elsewhere: the jackknife over realisations, and the bins' own scatter.
//!
//! Leaving out realisation k changes the gradient of the divergence, which is linear in the values, by -g_k/(R - 1),
//! g_k the gradient for that realisation alone at the fit of all. One step of Newton with the whole matrix of second
//! derivatives H (weights follow the model, so they move with it) lands at the fit without k: H^-1 g_k/(R - 1) off, to
//! first order in the distance, a few hundredths of the error itself.
// Tested by `the_jackknife_is_what_leaving_out_and_fitting_again_gives` (tests/it/fit.rs).

use nalgebra::DMatrix;

use super::data::FitData;
use super::solve::{LocalShape, Problem, State};

/// Step of the differences of gradients.
const STEP: f64 = 1e-4;

/// Second moments of the parameters.
pub(super) struct ParameterSpread {
    /// Of the jackknife; `None` without realisations or where second derivatives are singular.
    pub jackknife: Option<DMatrix<f64>>,
    /// What the parameters' freedom costs, in units of the divergence: tr(K H^-1), K the covariance of the gradient.
    pub optimism: Option<f64>,
    /// For a variance of floor + model over size, exactly: to be scaled.
    pub fisher: Option<DMatrix<f64>>,
}

/// The spread of a fit.
pub(super) fn spread(data: &FitData, problem: &Problem, state: &State) -> ParameterSpread {
    let slopes = problem.derivatives(state);
    let here = problem.local(state, &slopes, &data.value);
    let free = problem.free(&state.params, &here);
    let count = state.params.len();
    let fisher = inverse(&here.fisher, &free).map(|inverse| widened(&inverse, &free, count));
    if data.parts.len() < 2 || free.is_empty() {
        let optimism = (data.parts.len() > 1).then_some(0.0);
        return ParameterSpread { jackknife: None, optimism, fisher };
    }
    let hessian = hessian(data, problem, state, &here, &free);
    let Some(inverse) = inverse(&hessian, &free).or_else(|| inverse(&here.fisher, &free)) else {
        return ParameterSpread { jackknife: None, optimism: None, fisher };
    };
    let score = scatter(data, &free, |part| problem.local(state, &slopes, part));
    ParameterSpread {
        optimism: Some((&score * &inverse).trace()),
        jackknife: Some(widened(&(&inverse * score * &inverse), &free, count)),
        fisher,
    }
}

/// Covariance of the mean gradient: sum (g_k - g)(g_k - g)'/(R (R - 1)).
fn scatter(data: &FitData, free: &[usize], local: impl Fn(&[Vec<f64>]) -> LocalShape) -> DMatrix<f64> {
    let count = data.parts.len() as f64;
    let one = |part: &Vec<Vec<f64>>| {
        let gradient = local(part).gradient;
        free.iter().map(|&k| gradient[k]).collect::<Vec<f64>>()
    };
    let all: Vec<Vec<f64>> = data.parts.iter().map(one).collect();
    let mean: Vec<f64> =
        (0..free.len()).map(|k| all.iter().map(|gradient| gradient[k]).sum::<f64>() / count).collect();
    DMatrix::from_fn(free.len(), free.len(), |i, j| {
        let products = all.iter().map(|gradient| (gradient[i] - mean[i]) * (gradient[j] - mean[j]));
        products.sum::<f64>() / (count * (count - 1.0))
    })
}

/// Second derivatives by differences of gradients, as symmetric as they are. Amplitudes move without a new basis.
fn hessian(
    data: &FitData,
    problem: &Problem,
    state: &State,
    here: &LocalShape,
    free: &[usize],
) -> DMatrix<f64> {
    let mut hessian = here.fisher.clone();
    let slopes = problem.derivatives(state);
    for &k in free {
        let size = if k < problem.shapes { 1.0 } else { state.params[k].abs() };
        let (mut params, step) = (state.params.clone(), STEP * size);
        params[k] += step;
        let there = if k < problem.shapes {
            let moved = problem.at(params);
            problem.local(&moved, &problem.derivatives(&moved), &data.value)
        } else {
            problem.local(&State { params, ..state.clone() }, &slopes, &data.value)
        };
        hessian.set_column(k, &((there.gradient - &here.gradient) / step));
    }
    0.5 * (&hessian + hessian.transpose())
}

/// The inverse of the free part; `None` where it is not positive.
fn inverse(matrix: &DMatrix<f64>, free: &[usize]) -> Option<DMatrix<f64>> {
    let part = DMatrix::from_fn(free.len(), free.len(), |i, j| matrix[(free[i], free[j])]);
    let inverse = part.cholesky()?.inverse();
    inverse.iter().all(|entry| entry.is_finite()).then_some(inverse)
}

/// The free part in its place, 0 for the others.
fn widened(part: &DMatrix<f64>, free: &[usize], count: usize) -> DMatrix<f64> {
    let mut whole = DMatrix::zeros(count, count);
    for (i, &row) in free.iter().enumerate() {
        for (j, &column) in free.iter().enumerate() {
            whole[(row, column)] = part[(i, j)];
        }
    }
    whole
}
