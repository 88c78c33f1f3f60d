//! The mean, the plane or the polynomial of a map, by least squares of its heights.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::MapGrid;

/// Rows whose sums are one.
const TOGETHER: usize = 64;

/// Takes the mean off and returns it.
///
/// The sum is compensated, so that its error does not grow with the number of heights.
pub fn take_off_mean(heights: &mut [f64]) -> f64 {
    let (mut sum, mut rest) = (0.0_f64, 0.0_f64);
    for &height in heights.iter() {
        let next = sum + height;
        rest += if sum.abs() >= height.abs() { (sum - next) + height } else { (height - next) + sum };
        sum = next;
    }
    let mean = (sum + rest) / heights.len() as f64;
    heights.iter_mut().for_each(|height| *height -= mean);
    mean
}

/// Takes the least-squares plane off heights of mean zero; returns its slopes per column and per row.
///
/// Coordinates count from the centre, where the normal equations of a full grid are diagonal:
/// slope = sum u h / sum u^2 along each axis.
pub fn take_off_plane(heights: &mut [f64], columns: usize) -> [f64; 2] {
    let rows = heights.len() / columns;
    let centred = |i: usize, n: usize| i as f64 - 0.5 * (n - 1) as f64;
    let squares = |n: usize| (0..n).map(|i| centred(i, n).powi(2)).sum::<f64>();
    let (mut along_x, mut along_y) = (0.0, 0.0);
    for (y, row) in heights.chunks(columns).enumerate() {
        along_x += row.iter().enumerate().map(|(x, h)| centred(x, columns) * h).sum::<f64>();
        along_y += centred(y, rows) * row.iter().sum::<f64>();
    }
    let slope_x = along_x / (squares(columns) * rows as f64);
    let slope_y = along_y / (squares(rows) * columns as f64);
    for (y, row) in heights.chunks_mut(columns).enumerate() {
        for (x, height) in row.iter_mut().enumerate() {
            *height -= slope_x * centred(x, columns) + slope_y * centred(y, rows);
        }
    }
    [slope_x, slope_y]
}

/// Takes the least-squares polynomial of total degree `degree` off, and with it the mean. Samples that `filled` names do not
/// count in the fit. Returns the root mean square of what was taken off, about its mean.
///
/// The basis is P_i(u) P_j(v), i + j <= degree, Legendre's polynomials of coordinates from -1 to 1: nearly orthogonal on the
/// grid, so that the normal equations lose no digits.
pub fn take_off_polynomial(
    heights: &mut [f64],
    grid: &MapGrid,
    filled: &[bool],
    degree: u32,
) -> Result<f64, String> {
    let (columns, rows, degree) = (grid.columns, grid.rows(heights), degree as usize);
    let along_x: Vec<Vec<f64>> = (0..columns).map(|x| legendre(place(x, columns), degree)).collect();
    let along_y: Vec<Vec<f64>> = (0..rows).map(|y| legendre(place(y, rows), degree)).collect();
    let pairs: Vec<(usize, usize)> =
        (0..=degree).flat_map(|i| (0..=degree - i).map(move |j| (i, j))).collect();
    let terms = pairs.len();
    let basis = |x: usize, y: usize, into: &mut [f64]| {
        into.iter_mut().zip(&pairs).for_each(|(term, (i, j))| *term = along_x[x][*i] * along_y[y][*j]);
    };
    // Some rows together, and these in their order: the same sums from any number of threads.
    let heights_ref = &*heights;
    let some_rows = |first: usize| {
        let (mut squares, mut right) = (DMatrix::zeros(terms, terms), DVector::zeros(terms));
        let mut values = vec![0.0; terms];
        let samples = first * columns..rows.min(first + TOGETHER) * columns;
        for at in samples.filter(|at| !is_filled(filled, *at)) {
            basis(at % columns, at / columns, &mut values);
            for a in 0..terms {
                right[a] += values[a] * heights_ref[at];
                (a..terms).for_each(|b| squares[(b, a)] += values[a] * values[b]);
            }
        }
        (squares, right)
    };
    let sums: Vec<(DMatrix<f64>, DVector<f64>)> =
        (0..rows).step_by(TOGETHER).collect::<Vec<_>>().into_par_iter().map(some_rows).collect();
    let (mut squares, mut right) = (DMatrix::zeros(terms, terms), DVector::zeros(terms));
    for (of_row, right_of_row) in &sums {
        squares += of_row;
        right += right_of_row;
    }
    let too_few =
        || format!("too few heights for a polynomial of degree {degree}: lower surface.file.degree");
    let coefficients = squares.cholesky().ok_or_else(too_few)?.solve(&right);
    if coefficients.iter().any(|value| !value.is_finite()) {
        return Err(too_few());
    }
    let (mut sum, mut square) = (0.0, 0.0);
    let mut values = vec![0.0; terms];
    for (at, height) in heights.iter_mut().enumerate() {
        basis(at % columns, at / columns, &mut values);
        let form: f64 = values.iter().zip(coefficients.iter()).map(|(value, factor)| value * factor).sum();
        (sum, square) = (sum + form, square + form * form);
        *height -= form;
    }
    let count = (columns * rows) as f64;
    Ok((square / count - (sum / count).powi(2)).max(0.0).sqrt())
}

/// Whether a sample was filled; an empty list names none.
pub fn is_filled(filled: &[bool], at: usize) -> bool {
    filled.get(at).is_some_and(|filled| *filled)
}

/// From -1 to 1.
fn place(index: usize, count: usize) -> f64 {
    2.0 * index as f64 / (count - 1).max(1) as f64 - 1.0
}

/// P_0(u) to P_n(u): (k + 1) P_(k+1) = (2 k + 1) u P_k - k P_(k-1).
fn legendre(u: f64, degree: usize) -> Vec<f64> {
    let mut all = vec![1.0, u];
    for k in 1..degree.max(1) {
        all.push(((2 * k + 1) as f64 * u * all[k] - k as f64 * all[k - 1]) / (k + 1) as f64);
    }
    all.truncate(degree + 1);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: MapGrid = MapGrid { columns: 60, pitch: [1.0, 1.0], periodic: false };

    fn heights(height: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        (0..60 * 45).map(|k| height((k % 60) as f64, (k / 60) as f64)).collect()
    }

    #[test]
    fn a_polynomial_of_its_degree_is_wholly_taken_off() {
        for degree in 2..=10 {
            let power = degree as i32;
            let form = |x: f64, y: f64| {
                (x / 30.0 - 1.0).powi(power) - 2.0 * (x / 60.0) * (y / 45.0).powi(power - 1) + 0.3 * y - 4.0
            };
            let mut found = heights(form);
            take_off_polynomial(&mut found, &GRID, &[], degree).expect("enough heights");
            // Heights reach 14; 66 terms of condition below 100 at most.
            let most = found.iter().fold(0.0f64, |most, height| most.max(height.abs()));
            assert!(most < 14.0 * 100.0 * 66.0 * f64::EPSILON, "{degree}: {most}");
        }
    }

    #[test]
    fn what_was_filled_does_not_pull_at_the_form() {
        let form = |x: f64, y: f64| 0.01 * x * x - 0.02 * x * y + 5.0;
        let mut found = heights(form);
        let filled: Vec<bool> = (0..found.len()).map(|k| k % 60 < 20 && k / 60 < 20).collect();
        found.iter_mut().zip(&filled).filter(|(_, filled)| **filled).for_each(|(height, _)| *height += 100.0);
        let off = take_off_polynomial(&mut found, &GRID, &filled, 2).expect("enough heights");
        assert!(off > 1.0);
        for (height, filled) in found.iter().zip(&filled) {
            let wanted = if *filled { 100.0 } else { 0.0 };
            assert!((height - wanted).abs() < 1e-9, "{height}");
        }
        assert!(take_off_polynomial(&mut found, &GRID, &vec![true; 60 * 45], 2).is_err());
    }

    /// Legendre's polynomials at u = 0.3: 1, 0.3, (3 u^2 - 1)/2, (5 u^3 - 3 u)/2.
    #[test]
    fn the_basis_is_legendres() {
        let found = legendre(0.3, 3);
        for (found, wanted) in found.iter().zip([1.0, 0.3, -0.365, -0.3825]) {
            assert!((found - wanted).abs() < 1e-15, "{found} {wanted}");
        }
    }
}
