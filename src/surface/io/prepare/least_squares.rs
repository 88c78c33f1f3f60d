//! Linear least squares over the measured samples of a map: sums of products row by row, so that they are the same on any
//! number of threads.

use rayon::prelude::*;

use super::MapGrid;
use super::detrend::is_filled;

/// The heights on coordinates from -1 to 1 along the longer side, and in the same unit.
pub(super) struct Points<'a> {
    heights: &'a [f64],
    filled: &'a [bool],
    columns: usize,
    rows: usize,
    /// Half the longer side.
    pub(super) scale: f64,
    step: [f64; 2],
}

impl<'a> Points<'a> {
    pub(super) fn of(heights: &'a [f64], grid: &MapGrid, filled: &'a [bool]) -> Self {
        let (columns, rows) = (grid.columns, grid.rows(heights));
        let size = [(columns - 1) as f64 * grid.pitch[0], (rows - 1) as f64 * grid.pitch[1]];
        let scale = 0.5 * size[0].max(size[1]);
        Points { heights, filled, columns, rows, scale, step: grid.pitch.map(|pitch| pitch / scale) }
    }

    pub(super) fn place(&self, column: usize, row: usize) -> [f64; 2] {
        let centred = |at: usize, count: usize| at as f64 - 0.5 * (count - 1) as f64;
        [centred(column, self.columns) * self.step[0], centred(row, self.rows) * self.step[1]]
    }

    /// x, y and height of the measured samples of a row.
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = [f64; 3]> + '_ {
        let first = row * self.columns;
        (0..self.columns).filter(move |x| !is_filled(self.filled, first + x)).map(move |column| {
            let [x, y] = self.place(column, row);
            [x, y, self.heights[first + column] / self.scale]
        })
    }

    /// What `of_row` makes of each row, one after the other.
    pub(super) fn rows<T: Send>(&self, of_row: impl Fn(usize) -> Option<T> + Sync + Send) -> Option<Vec<T>> {
        (0..self.rows).into_par_iter().map(of_row).collect()
    }

    pub(super) fn norm(&self) -> f64 {
        self.heights.iter().map(|height| (height / self.scale).powi(2)).sum::<f64>().sqrt()
    }

    /// The least-squares coefficients of 1, x, y, x^2, x y, y^2.
    pub(super) fn paraboloid(&self) -> Option<Vec<f64>> {
        let terms = |[x, y, z]: [f64; 3]| Some((vec![1.0, x, y, x * x, x * y, y * y], z));
        let (squares, right) = self.normal_equations(6, terms)?;
        solve(squares, right, 0.0)
    }

    /// Sums over the measured samples of the products of `terms` terms with each other, and with what they are to add up to;
    /// `of_sample` gives both at a sample.
    pub(super) fn normal_equations(
        &self,
        terms: usize,
        of_sample: impl Fn([f64; 3]) -> Option<(Vec<f64>, f64)> + Sync + Send,
    ) -> Option<(Vec<Vec<f64>>, Vec<f64>)> {
        let of_row = |row: usize| {
            let (mut squares, mut right) = (vec![vec![0.0; terms]; terms], vec![0.0; terms]);
            for sample in self.row(row) {
                let (values, wanted) = of_sample(sample)?;
                for a in 0..terms {
                    right[a] += values[a] * wanted;
                    (0..terms).for_each(|b| squares[a][b] += values[a] * values[b]);
                }
            }
            Some((squares, right))
        };
        let (mut squares, mut right) = (vec![vec![0.0; terms]; terms], vec![0.0; terms]);
        for (of_row, right_of_row) in self.rows(of_row)? {
            for a in 0..terms {
                right[a] += right_of_row[a];
                (0..terms).for_each(|b| squares[a][b] += of_row[a][b]);
            }
        }
        Some((squares, right))
    }
}

/// Solves (M + damping diag M) x = r; `None` of a matrix that is not positive definite.
pub(super) fn solve(mut squares: Vec<Vec<f64>>, right: Vec<f64>, damping: f64) -> Option<Vec<f64>> {
    let terms = right.len();
    (0..terms).for_each(|k| squares[k][k] *= 1.0 + damping);
    let matrix = nalgebra::DMatrix::from_fn(terms, terms, |a, b| squares[a][b]);
    let solved = matrix.cholesky()?.solve(&nalgebra::DVector::from_vec(right));
    solved.iter().all(|value| value.is_finite()).then(|| solved.iter().copied().collect())
}

pub(super) fn quadratic(squares: &[Vec<f64>], change: &[f64]) -> f64 {
    let row = |row: &Vec<f64>| row.iter().zip(change).map(|(a, b)| a * b).sum::<f64>();
    squares.iter().zip(change).map(|(squares, change)| change * row(squares)).sum()
}
