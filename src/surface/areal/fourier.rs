//! Fourier transforms of two dimensions in f64.

use rayon::prelude::*;
use rustfft::FftPlannerScalar;
use rustfft::num_complex::Complex64;

use crate::error::Checked;
use crate::files::memory;
use crate::surface::transpose::transpose;

/// Bytes for each place: the values, and their transposition.
const NEEDED: u64 = 2 * 16;

/// Values row by row, `columns` in a row.
pub struct Plane {
    pub columns: usize,
    pub rows: usize,
    pub values: Vec<Complex64>,
}

impl Plane {
    /// `columns` x `rows` zeros, or why there is no room for them.
    pub fn zeros(columns: usize, rows: usize) -> Checked<Self> {
        memory::check((columns as u64).saturating_mul(rows as u64).saturating_mul(NEEDED))?;
        Ok(Plane { columns, rows, values: vec![Complex64::default(); columns * rows] })
    }

    /// The transform, not divided by anything; rows and columns of the result are exchanged.
    pub fn transformed(mut self, inverse: bool) -> Self {
        lines(&mut self.values, self.columns, inverse);
        let mut turned = vec![Complex64::default(); self.values.len()];
        transpose(&self.values, self.columns, &mut turned);
        lines(&mut turned, self.rows, inverse);
        Plane { columns: self.rows, rows: self.columns, values: turned }
    }
}

fn lines(values: &mut [Complex64], width: usize, inverse: bool) {
    // Quick enough for a map, and half of what the planner with AVX takes to compile.
    let mut planner = FftPlannerScalar::new();
    let transform = if inverse { planner.plan_fft_inverse(width) } else { planner.plan_fft_forward(width) };
    values.par_chunks_mut(width).for_each(|line| transform.process(line));
}

/// The smallest length from `least` on that has no other factors than 2, 3 and 5.
pub fn quick_length(least: usize) -> usize {
    let is_quick = |length: &usize| {
        let mut rest = *length;
        for factor in [2usize, 3, 5] {
            while rest.is_multiple_of(factor) {
                rest /= factor;
            }
        }
        rest == 1
    };
    (least.max(1)..).find(is_quick).unwrap_or(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_is_the_same_times_the_count() {
        let mut plane = Plane::zeros(6, 5).expect("room");
        for (k, value) in plane.values.iter_mut().enumerate() {
            *value = Complex64::new((k * k % 7) as f64, 0.0);
        }
        let wanted = plane.values.clone();
        let back = plane.transformed(false).transformed(true);
        assert_eq!((back.columns, back.rows), (6, 5));
        assert!(back.values.iter().zip(&wanted).all(|(a, b)| (a / 30.0 - b).norm() < 1e-13));
        assert_eq!([7, 11, 121].map(quick_length), [8, 12, 125]);
    }
}
