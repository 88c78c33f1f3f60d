//! The square real FFT in two dimensions and filters on it.
//!
//! `realfft` and `rustfft` transform lines; the second dimension is a transposition away.

use std::f64::consts::TAU;
use std::sync::Arc;

use realfft::num_complex::Complex64;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

use rustfft::{Fft, FftPlanner};

/// Transforms of n x n real fields, planned once.
pub struct SquareFft {
    side: usize,
    forward_rows: Arc<dyn RealToComplex<f64>>,
    inverse_rows: Arc<dyn ComplexToReal<f64>>,
    forward_columns: Arc<dyn Fft<f64>>,
    inverse_columns: Arc<dyn Fft<f64>>,
}

impl SquareFft {
    /// Plans the transforms of a `side` x `side` field.
    pub fn new(side: usize) -> Self {
        let mut real = RealFftPlanner::new();
        let mut complex = FftPlanner::new();
        SquareFft {
            side,
            forward_rows: real.plan_fft_forward(side),
            inverse_rows: real.plan_fft_inverse(side),
            forward_columns: complex.plan_fft_forward(side),
            inverse_columns: complex.plan_fft_inverse(side),
        }
    }

    /// Multiplies the spectrum of `field` by `gain(kx, ky)`, wave numbers in radians per cell, kx in [0, pi],
    /// ky in (-pi, pi]. The gain of (0, 0) is applied as well: return 0 there to take the mean off.
    pub fn filter(&self, field: &mut [f64], gain: impl Fn(f64, f64) -> f64) {
        let n = self.side;
        let half = n / 2 + 1;
        let mut rows = vec![Complex64::default(); n * half];
        for (line, out) in field.chunks_exact_mut(n).zip(rows.chunks_exact_mut(half)) {
            self.forward_rows.process(line, out).expect("the plan's own sizes");
        }
        let mut columns = transposed(&rows, half);
        self.forward_columns.process(&mut columns);
        // The two inverse transforms together multiply by n^2.
        let norm = 1.0 / (n * n) as f64;
        for (ix, column) in columns.chunks_exact_mut(n).enumerate() {
            let kx = self.wave_number(ix);
            for (iy, value) in column.iter_mut().enumerate() {
                *value *= norm * gain(kx, self.wave_number(iy));
            }
        }
        self.inverse_columns.process(&mut columns);
        let mut rows = transposed(&columns, n);
        for (line, spectrum) in field.chunks_exact_mut(n).zip(rows.chunks_exact_mut(half)) {
            // A real field's spectrum is real at k = 0 and at the Nyquist line; rounding leaves a trace.
            spectrum[0].im = 0.0;
            if n.is_multiple_of(2) {
                spectrum[half - 1].im = 0.0;
            }
            self.inverse_rows.process(spectrum, line).expect("the plan's own sizes");
        }
    }

    /// Sum over all n^2 modes of `f(kx, ky)`.
    pub fn sum_over_modes(&self, f: impl Fn(f64, f64) -> f64) -> f64 {
        let row =
            |iy: usize| (0..self.side).map(|ix| f(self.wave_number(ix), self.wave_number(iy))).sum::<f64>();
        (0..self.side).map(row).sum()
    }

    fn wave_number(&self, index: usize) -> f64 {
        let signed = if index > self.side / 2 { index as f64 - self.side as f64 } else { index as f64 };
        TAU * signed / self.side as f64
    }
}

/// The transpose of a matrix with rows of `width`, in tiles that stay in the cache.
fn transposed(matrix: &[Complex64], width: usize) -> Vec<Complex64> {
    const TILE: usize = 16;
    let height = matrix.len() / width;
    let mut out = vec![Complex64::default(); matrix.len()];
    for y0 in (0..height).step_by(TILE) {
        for x0 in (0..width).step_by(TILE) {
            for y in y0..(y0 + TILE).min(height) {
                for x in x0..(x0 + TILE).min(width) {
                    out[x * height + y] = matrix[y * width + x];
                }
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_of_one_changes_nothing() {
        for side in [8, 15, 64] {
            let field: Vec<f64> = (0..side * side).map(|i| ((i * 7919) % 101) as f64).collect();
            let mut copy = field.clone();
            SquareFft::new(side).filter(&mut copy, |_, _| 1.0);
            let worst = field.iter().zip(&copy).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // log2(n^2) butterflies of values up to 101, each rounding once.
            assert!(worst < 101.0 * 16.0 * f64::EPSILON * 4.0, "{side}: {worst}");
        }
    }

    #[test]
    fn a_plane_wave_is_scaled_by_the_gain_of_its_own_wave_number() {
        let side = 32;
        let (mx, my) = (3.0, -5.0);
        let wave = |i: usize| (TAU / 32.0 * (mx * (i % side) as f64 + my * (i / side) as f64)).cos();
        let mut field: Vec<f64> = (0..side * side).map(wave).collect();
        SquareFft::new(side).filter(&mut field, |kx, ky| {
            let own = ((kx / TAU * 32.0).round() == mx && (ky / TAU * 32.0).round() == my)
                || ((kx / TAU * 32.0).round() == -mx && (ky / TAU * 32.0).round() == -my);
            if own { 2.0 } else { 1000.0 }
        });
        for (i, value) in field.iter().enumerate() {
            // 1000 times the rounding left in 1024 other modes.
            assert!((value - 2.0 * wave(i)).abs() < 1e-9, "{i}");
        }
    }
}
