//! The map from the unit square to directions of an RGL file: a bilinear density for each angle of the light, and its
//! inverse, both ways by sums of trapezoids, as its readers do.

use crate::error::wrong;
use crate::interchange::Checked;

/// Slices of rows x columns, normalised, with their sums. Slice index = phi_i index x theta_i nodes + theta_i index.
pub(crate) struct Warp {
    rows: usize,
    columns: usize,
    /// Density at the nodes.
    density: Vec<f32>,
    /// Running sums along each row, from 0.
    along: Vec<f32>,
    /// Running sums of the rows' totals, from 0 to 1.
    down: Vec<f32>,
}

/// Slices and their weights: interpolation between angles of the light.
pub(crate) type Slices = [(usize, f64); 4];

impl Warp {
    pub fn new(rows: usize, columns: usize, mut density: Vec<f32>) -> Checked<Self> {
        if rows < 2 || columns < 2 || !density.len().is_multiple_of(rows * columns) {
            return Err(wrong!("slices of {rows} x {columns} nodes, at least 2 x 2 needed"));
        }
        let slices = density.len() / (rows * columns);
        let (mut along, mut down) = (vec![0.0; density.len()], vec![0.0; slices * rows]);
        for slice in 0..slices {
            let range = slice * rows * columns..(slice + 1) * rows * columns;
            let (nodes, sums) = (&mut density[range.clone()], &mut along[range]);
            if nodes.iter().any(|&value| value < 0.0) {
                return Err("a density is negative".into());
            }
            let down = &mut down[slice * rows..(slice + 1) * rows];
            let (mut total, mut before) = (0.0f64, 0.0);
            for row in 0..rows {
                let (values, sums) =
                    (&nodes[row * columns..][..columns], &mut sums[row * columns..][..columns]);
                let mut sum = 0.0;
                for column in 1..columns {
                    sum += 0.5 * (f64::from(values[column - 1]) + f64::from(values[column]));
                    sums[column] = sum as f32;
                }
                total += if row > 0 { 0.5 * (before + sum) } else { 0.0 };
                (before, down[row]) = (sum, total as f32);
            }
            if !(total.is_finite() && total > 0.0) {
                return Err("a slice's density is 0 throughout".into());
            }
            let scale = (1.0 / total) as f32;
            nodes.iter_mut().chain(sums).chain(down).for_each(|value| *value *= scale);
        }
        Ok(Warp { rows, columns, density, along, down })
    }

    fn node(&self, slices: &Slices, values: &[f32], size: usize, at: usize) -> f64 {
        slices.iter().filter(|s| s.1 != 0.0).map(|&(slice, w)| w * f64::from(values[slice * size + at])).sum()
    }

    fn density_at(&self, slices: &Slices, row: usize, column: usize) -> f64 {
        self.node(slices, &self.density, self.rows * self.columns, row * self.columns + column)
    }

    fn along_at(&self, slices: &Slices, row: usize, column: usize) -> f64 {
        self.node(slices, &self.along, self.rows * self.columns, row * self.columns + column)
    }

    fn down_at(&self, slices: &Slices, row: usize) -> f64 {
        self.node(slices, &self.down, self.rows, row)
    }

    fn total(&self, slices: &Slices, row: usize) -> f64 {
        self.along_at(slices, row, self.columns - 1)
    }

    /// (x, y) of a uniform sample.
    pub fn forward(&self, slices: &Slices, [sx, sy]: [f64; 2]) -> [f64; 2] {
        let row = bracket(self.rows, |row| self.down_at(slices, row) <= sy);
        let y = within(self.total(slices, row), self.total(slices, row + 1), sy - self.down_at(slices, row));
        let lerp = |a: f64, b: f64| (1.0 - y) * a + y * b;
        let sum = |column| lerp(self.along_at(slices, row, column), self.along_at(slices, row + 1, column));
        let sx = sx * sum(self.columns - 1);
        let column = bracket(self.columns, |column| sum(column) <= sx);
        let density =
            |column| lerp(self.density_at(slices, row, column), self.density_at(slices, row + 1, column));
        let x = within(density(column), density(column + 1), sx - sum(column));
        [(column as f64 + x) / (self.columns - 1) as f64, (row as f64 + y) / (self.rows - 1) as f64]
    }

    /// The uniform sample of (x, y).
    pub fn inverse(&self, slices: &Slices, [x, y]: [f64; 2]) -> [f64; 2] {
        let (column, x) = cell(x, self.columns);
        let (row, y) = cell(y, self.rows);
        let lerp = |a: f64, b: f64| (1.0 - y) * a + y * b;
        let sum = |column| lerp(self.along_at(slices, row, column), self.along_at(slices, row + 1, column));
        let density =
            |column| lerp(self.density_at(slices, row, column), self.density_at(slices, row + 1, column));
        let (c0, c1) = (density(column), density(column + 1));
        let total = sum(self.columns - 1);
        let sx = if total > 0.0 { (sum(column) + x * (c0 + 0.5 * x * (c1 - c0))) / total } else { 0.0 };
        let (r0, r1) = (self.total(slices, row), self.total(slices, row + 1));
        [sx, self.down_at(slices, row) + y * (r0 + 0.5 * y * (r1 - r0))]
    }
}

/// The last k < n - 1 for which `holds`, which is true up to some k.
fn bracket(n: usize, holds: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, n - 1);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if holds(middle) { low = middle } else { high = middle }
    }
    low
}

/// Node and fraction of a coordinate in [0, 1].
pub(crate) fn cell(x: f64, nodes: usize) -> (usize, f64) {
    let at = x.clamp(0.0, 1.0) * (nodes - 1) as f64;
    let node = (at as usize).min(nodes - 2);
    (node, at - node as f64)
}

/// Where in a cell with a linear density from a to b the area up to it is `area`.
fn within(a: f64, b: f64, area: f64) -> f64 {
    let x = if (a - b).abs() < 1e-4 * (a + b) {
        2.0 * area / (a + b)
    } else {
        (a - (a * a - 2.0 * area * (a - b)).max(0.0).sqrt()) / (a - b)
    };
    if x.is_finite() { x.clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_undoes_the_warp() {
        let density: Vec<f32> = (0..7 * 9).map(|k| 0.1 + (k as f32 * 0.7).sin().abs()).collect();
        let warp = Warp::new(7, 9, density).expect("positive");
        let slices = [(0, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)];
        for k in 0..400 {
            let s = [(0.5 + f64::from(k % 20)) / 20.0, (0.5 + f64::from(k / 20)) / 20.0];
            let back = warp.inverse(&slices, warp.forward(&slices, s));
            // Sums in f32: a few 2^-24. A nearly even density is taken as even, at most 1e-4/4 of a cell off.
            assert!((back[0] - s[0]).abs() < 1e-5 && (back[1] - s[1]).abs() < 1e-5, "{s:?} {back:?}");
        }
    }
}
