//! Propagation of errors: from the covariance of what is fitted, logarithms and a stretch, to the errors of what is reported.

use nalgebra::DMatrix;

use super::{FitData, Fitted};

/// Step of the differences by which errors of logarithms become errors of what is reported.
const STEP: f64 = 1e-6;
/// Level at which two axes of roughness are distinguished.
const LEVEL: f64 = 0.01;

/// The parameters with the stretch of an anisotropic shape freed of its noise: the expectation of b^2 + c^2 is that of
/// the truth and the variances of b and c, so two roughnesses of a round law would always come out apart.
pub(super) fn apart(data: &FitData, fit: &Fitted, covariance: Option<&DMatrix<f64>>) -> Vec<f64> {
    let mut params = fit.params.clone();
    if let (true, Some(covariance)) = (fit.law.is_anisotropic(), covariance) {
        let r2 = params[1] * params[1] + params[2] * params[2];
        let rest = (r2 - covariance[(1, 1)] - covariance[(2, 2)]).max(0.0);
        let told = if is_told_apart(data, fit, covariance) { rest } else { 0.0 };
        let factor = if r2 > 0.0 { (told / r2).sqrt() } else { 0.0 };
        params[1..3].iter_mut().for_each(|stretch| *stretch *= factor);
    }
    params
}

/// Hotelling's test of b = c = 0: T^2 = (b, c) V^-1 (b, c)', and (1 + T^2/(R - 1))^(-(R - 2)/2) is its p.
fn is_told_apart(data: &FitData, fit: &Fitted, covariance: &DMatrix<f64>) -> bool {
    let (b, c) = (fit.params[1], fit.params[2]);
    let (xx, xy, yy) = (covariance[(1, 1)], covariance[(1, 2)], covariance[(2, 2)]);
    let t2 = (yy * b * b - 2.0 * xy * b * c + xx * c * c) / (xx * yy - xy * xy);
    let count = data.parts.len() as f64;
    let p = if count >= 2.0 {
        (-0.5 * (count - 2.0) * (t2 / (count - 1.0)).ln_1p()).exp()
    } else {
        (-0.5 * t2).exp()
    };
    // No scatter at all: any difference is one.
    !t2.is_finite() || p < LEVEL
}

pub(super) fn decoded(data: &FitData, fitted: &Fitted, params: &[f64]) -> Vec<f64> {
    let (shape, amplitudes) = params.split_at(fitted.shapes);
    [fitted.law.decode(shape, data.rotation), amplitudes.to_vec()].concat()
}

/// sqrt of the diagonal of D C D', D the derivatives of what is reported by what is fitted. Two roughnesses that are one
/// have the error of a roughness along any axis, (a + b) or (a + c) on average, and no rotation.
pub(super) fn propagated(
    data: &FitData,
    fitted: &Fitted,
    params: &[f64],
    covariance: &DMatrix<f64>,
) -> Vec<Option<f64>> {
    let count = params.len();
    let rows = decoded(data, fitted, params).len();
    let mut derivative = DMatrix::zeros(rows, count);
    for column in 0..count {
        let moved = |step: f64| {
            let mut params = params.to_vec();
            params[column] += step;
            decoded(data, fitted, &params)
        };
        for (row, (up, down)) in moved(STEP).into_iter().zip(moved(-STEP)).enumerate() {
            derivative[(row, column)] = (up - down) / (2.0 * STEP);
        }
    }
    let spread = &derivative * covariance * derivative.transpose();
    let mut errors: Vec<Option<f64>> =
        (0..rows).map(|k| Some(spread[(k, k)].sqrt()).filter(|se| se.is_finite() && *se > 0.0)).collect();
    if fitted.law.is_anisotropic() && params[1] == 0.0 && params[2] == 0.0 {
        let square = covariance[(0, 0)] + 0.5 * (covariance[(1, 1)] + covariance[(2, 2)]);
        let error = Some(params[0].exp() * square.sqrt()).filter(|se| *se > 0.0);
        errors[..3].copy_from_slice(&[error, error, None]);
    }
    errors
}
