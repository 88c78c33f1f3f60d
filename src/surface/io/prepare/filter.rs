//! The Gaussian areal filter of ISO 16610-61.
//!
//! Weight s(x, y) = exp(-pi (x^2 + y^2)/(a lc)^2)/(a lc)^2, a = sqrt(ln 2/pi): a wave of the cut-off lc passes by half. It is
//! the product of one along x and one along y. At the edge of an open map the weights that are left are made 1 again.

use std::f64::consts::{LN_2, PI};

use rayon::prelude::*;

use super::MapGrid;
use crate::surface::transpose::transpose;

/// Where weights end, in cut-offs: they are below 7e-7 of the largest.
const REACH: f64 = 1.0;

/// The heights as the filter of this cut-off (in the unit of the heights) lets them pass.
pub fn low_pass(heights: &[f64], grid: &MapGrid, cut_off: f64) -> Vec<f64> {
    let rows = grid.rows(heights);
    let along_x = along(heights, grid.columns, &weights(cut_off / grid.pitch[0]), grid.periodic);
    let mut turned = vec![0.0; heights.len()];
    transpose(&along_x, grid.columns, &mut turned);
    let along_y = along(&turned, rows, &weights(cut_off / grid.pitch[1]), grid.periodic);
    let mut found = vec![0.0; heights.len()];
    transpose(&along_y, rows, &mut found);
    found
}

/// Weights of the sample itself and of those after it; `cut_off` in samples.
fn weights(cut_off: f64) -> Vec<f64> {
    let width = (LN_2 / PI).sqrt() * cut_off;
    let reach = (REACH * cut_off).floor() as usize;
    (0..=reach).map(|k| (-PI * (k as f64 / width).powi(2)).exp()).collect()
}

/// Each row of `width` heights as the weights let it pass.
fn along(heights: &[f64], width: usize, weights: &[f64], periodic: bool) -> Vec<f64> {
    let reach = weights.len() as isize - 1;
    let count = width as isize;
    let of_row = |row: &[f64], into: &mut [f64]| {
        for (at, into) in into.iter_mut().enumerate() {
            let at = at as isize;
            let (first, last) = if periodic {
                (at - reach, at + reach)
            } else {
                (0.max(at - reach), (count - 1).min(at + reach))
            };
            let (mut sum, mut all) = (0.0, 0.0);
            for k in first..=last {
                let weight = weights[(k - at).unsigned_abs()];
                let k = if periodic { k.rem_euclid(count) } else { k };
                sum += weight * row[k as usize];
                all += weight;
            }
            *into = sum / all;
        }
    };
    let mut found = vec![0.0; heights.len()];
    found.par_chunks_mut(width).zip(heights.par_chunks(width)).for_each(|(into, row)| of_row(row, into));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn wave(columns: usize, rows: usize, waves: [f64; 2]) -> Vec<f64> {
        let at = |k: usize| {
            let turn = waves[0] * (k % columns) as f64 / columns as f64
                + waves[1] * (k / columns) as f64 / rows as f64;
            (TAU * turn).cos()
        };
        (0..columns * rows).map(at).collect()
    }

    /// A wave of length l passes by exp(-pi (a lc/l)^2): 1/2 at the cut-off.
    #[test]
    fn a_wave_passes_by_the_filters_formula() {
        let grid = MapGrid { columns: 128, pitch: [0.5, 2.0], periodic: true };
        for (waves, length) in
            [([8.0, 0.0], 8.0), ([4.0, 0.0], 16.0), ([0.0, 4.0], 32.0), ([8.0, 8.0], 16.0 / 5f64.sqrt())]
        {
            let heights = wave(128, 64, waves);
            let cut_off = 8.0;
            let found = low_pass(&heights, &grid, cut_off);
            let passes = 0.5f64.powf((cut_off / length).powi(2));
            for (found, height) in found.iter().zip(&heights) {
                // Four samples a cut-off along y: the wave of 1/8 a sample aliases by exp(-pi (4 a 7/8)^2) = 2e-4.
                assert!(
                    (found - passes * height).abs() < 3e-4 * passes,
                    "{waves:?}: {found} {}",
                    passes * height
                );
            }
        }
    }

    #[test]
    fn a_level_map_stays_level_to_its_edge() {
        let grid = MapGrid { columns: 40, pitch: [1.0, 1.0], periodic: false };
        let found = low_pass(&[3.5; 40 * 30], &grid, 25.0);
        assert!(found.iter().all(|height| (height - 3.5).abs() < 1e-14));
        // In the middle of a slope, too; at its edge the mean is of one side.
        let slope: Vec<f64> = (0..40 * 30).map(|k| (k % 40) as f64).collect();
        let found = low_pass(&slope, &grid, 10.0);
        assert!((found[15 * 40 + 20] - 20.0).abs() < 1e-12 && found[15 * 40] > 0.5);
    }
}
