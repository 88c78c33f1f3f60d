//! The square real FFT in two dimensions and filters on it.
//!
//! `realfft` and `rustfft` transform lines; the second dimension is a transposition away, done while the lines of a few
//! rows are in the cache. Fields are f32, as the finished patch is.

use std::f64::consts::TAU;
use std::sync::Arc;

use realfft::num_complex::Complex32;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

use rustfft::{Fft, FftPlanner};

/// Transforms of n x n real fields, planned once.
pub struct SquareFft {
    side: usize,
    forward_rows: Arc<dyn RealToComplex<f32>>,
    inverse_rows: Arc<dyn ComplexToReal<f32>>,
    forward_columns: Arc<dyn Fft<f32>>,
    inverse_columns: Arc<dyn Fft<f32>>,
}

/// What every mode of a field's spectrum is multiplied by.
pub struct Filter {
    /// Column by column of the half spectrum, the transforms' own factor n^2 taken off.
    gains: Vec<f32>,
}

/// Room for the spectra of one field, used again from filter to filter.
pub struct Spectra {
    /// Of `ROWS` rows.
    rows: Vec<Complex32>,
    columns: Vec<Complex32>,
    scratch: Vec<Complex32>,
}

/// Rows that are transformed together: their parts of a column are two lines of the cache.
const ROWS: usize = 16;

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

    /// The filter of `gain(kx, ky)`, wave numbers in radians per cell, kx in [0, pi], ky in (-pi, pi]. The gain of
    /// (0, 0) is applied as well: return 0 there to take the mean off.
    pub fn filter(&self, gain: impl Fn(f64, f64) -> f64) -> Filter {
        // The two inverse transforms together multiply by n^2.
        let norm = 1.0 / (self.side * self.side) as f64;
        let column = |ix: usize| (0..self.side).map(move |iy| (ix, iy));
        let modes = (0..self.half()).flat_map(column);
        let at = |(ix, iy)| (norm * gain(self.wave_number(ix), self.wave_number(iy))) as f32;
        Filter { gains: modes.map(at).collect() }
    }

    /// Room for `apply`.
    pub fn spectra(&self) -> Spectra {
        let room = |length: usize| vec![Complex32::default(); length];
        let scratch = [
            self.forward_rows.get_scratch_len(),
            self.inverse_rows.get_scratch_len(),
            self.forward_columns.get_inplace_scratch_len(),
            self.inverse_columns.get_inplace_scratch_len(),
        ];
        let longest = scratch.into_iter().max().unwrap_or(0);
        let (rows, columns) = (room(ROWS * self.half()), room(self.side * self.half()));
        Spectra { rows, columns, scratch: room(longest) }
    }

    /// Multiplies the spectrum of `field` by the filter's gains.
    pub fn apply(&self, filter: &Filter, field: &mut [f32], room: &mut Spectra) {
        let (n, half) = (self.side, self.half());
        let Spectra { rows, columns, scratch } = room;
        for (group, lines) in field.chunks_mut(ROWS * n).enumerate() {
            for (line, out) in lines.chunks_exact_mut(n).zip(rows.chunks_exact_mut(half)) {
                self.forward_rows.process_with_scratch(line, out, scratch).expect("the plan's own sizes");
            }
            let count = lines.len() / n;
            for (x, column) in columns.chunks_exact_mut(n).enumerate() {
                let part = &mut column[group * ROWS..][..count];
                part.iter_mut().enumerate().for_each(|(row, mode)| *mode = rows[row * half + x]);
            }
        }
        for (column, gains) in columns.chunks_exact_mut(n).zip(filter.gains.chunks_exact(n)) {
            self.forward_columns.process_with_scratch(column, scratch);
            column.iter_mut().zip(gains).for_each(|(mode, gain)| *mode *= gain);
            self.inverse_columns.process_with_scratch(column, scratch);
        }
        for (group, lines) in field.chunks_mut(ROWS * n).enumerate() {
            let count = lines.len() / n;
            for (x, column) in columns.chunks_exact(n).enumerate() {
                let part = &column[group * ROWS..][..count];
                part.iter().enumerate().for_each(|(row, mode)| rows[row * half + x] = *mode);
            }
            for (line, spectrum) in lines.chunks_exact_mut(n).zip(rows.chunks_exact_mut(half)) {
                // A real field's spectrum is real at k = 0 and at the Nyquist line; rounding leaves a trace.
                spectrum[0].im = 0.0;
                if n.is_multiple_of(2) {
                    spectrum[half - 1].im = 0.0;
                }
                self.inverse_rows
                    .process_with_scratch(spectrum, line, scratch)
                    .expect("the plan's own sizes");
            }
        }
    }

    /// Sum over all n^2 modes of `f(kx, ky)`.
    pub fn sum_over_modes(&self, f: impl Fn(f64, f64) -> f64) -> f64 {
        let row =
            |iy: usize| (0..self.side).map(|ix| f(self.wave_number(ix), self.wave_number(iy))).sum::<f64>();
        (0..self.side).map(row).sum()
    }

    /// Modes kept of each row: the rest are their conjugates.
    fn half(&self) -> usize {
        self.side / 2 + 1
    }

    fn wave_number(&self, index: usize) -> f64 {
        let signed = if index > self.side / 2 { index as f64 - self.side as f64 } else { index as f64 };
        TAU * signed / self.side as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filtered(side: usize, mut field: Vec<f32>, gain: impl Fn(f64, f64) -> f64) -> Vec<f32> {
        let fft = SquareFft::new(side);
        fft.apply(&fft.filter(gain), &mut field, &mut fft.spectra());
        field
    }

    #[test]
    fn a_gain_of_one_changes_nothing() {
        for side in [8, 15, 64] {
            let field: Vec<f32> = (0..side * side).map(|i| ((i * 7919) % 101) as f32).collect();
            let copy = filtered(side, field.clone(), |_, _| 1.0);
            let worst = field.iter().zip(&copy).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            // log2(n^2) butterflies of values up to 101, each rounding once.
            assert!(worst < 101.0 * 16.0 * f32::EPSILON * 4.0, "{side}: {worst}");
        }
    }

    #[test]
    fn a_plane_wave_is_scaled_by_the_gain_of_its_own_wave_number() {
        let side = 32;
        let (mx, my) = (3.0, -5.0);
        let wave = |i: usize| (TAU / 32.0 * (mx * (i % side) as f64 + my * (i / side) as f64)).cos() as f32;
        let field = filtered(side, (0..side * side).map(wave).collect(), |kx, ky| {
            let own = ((kx / TAU * 32.0).round() == mx && (ky / TAU * 32.0).round() == my)
                || ((kx / TAU * 32.0).round() == -mx && (ky / TAU * 32.0).round() == -my);
            if own { 2.0 } else { 1000.0 }
        });
        for (i, value) in field.iter().enumerate() {
            // 1000 times the rounding (6e-8) left in 1024 other modes.
            assert!((value - 2.0 * wave(i)).abs() < 1e-3, "{i}");
        }
    }
}
