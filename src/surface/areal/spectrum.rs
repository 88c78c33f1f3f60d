//! The areal power spectral density of a map, by spatial frequency.
//!
//! PSD(f) = pitch_x pitch_y/(N w2) |sum w h exp(-2 pi i f.x)|^2, so that its integral over all f is the variance of the heights. A
//! map that ends is weighted by a Hann window w along x and y, else by 1; w2 is the mean of w^2.

use super::fourier::Plane;
use crate::error::Checked;
use crate::surface::io::prepare::MapGrid;

/// Frequency and mean density over all azimuths, in rings as wide as the coarser step of frequency, up to half of one over the
/// wider pitch.
pub fn radial(heights: &[f64], grid: &MapGrid) -> Checked<Vec<[f64; 2]>> {
    let (columns, rows) = (grid.columns, grid.rows(heights));
    let [px, py] = grid.pitch;
    let mut plane = Plane::zeros(columns, rows)?;
    let hann = |at: usize, count: usize| match grid.periodic {
        true => 1.0,
        false => (std::f64::consts::PI * (at as f64 + 0.5) / count as f64).sin().powi(2),
    };
    let (along_x, along_y): (Vec<f64>, Vec<f64>) =
        ((0..columns).map(|x| hann(x, columns)).collect(), (0..rows).map(|y| hann(y, rows)).collect());
    let weight = |k: usize| along_x[k % columns] * along_y[k / columns];
    let mean = heights.iter().sum::<f64>() / heights.len() as f64;
    let mut squares = 0.0;
    for (k, (value, height)) in plane.values.iter_mut().zip(heights).enumerate() {
        value.re = weight(k) * (height - mean);
        squares += weight(k).powi(2);
    }
    // Rows are frequencies along x.
    let power = plane.transformed(false);
    let steps = [1.0 / (columns as f64 * px), 1.0 / (rows as f64 * py)];
    let width = steps[0].max(steps[1]);
    let last = 0.5 / px.max(py);
    let rings = (last / width).floor() as usize;
    let mut sums = vec![(0.0, 0usize); rings + 1];
    let signed = |k: usize, count: usize| if 2 * k > count { k as f64 - count as f64 } else { k as f64 };
    for (k, value) in power.values.iter().enumerate() {
        let (x, y) = (signed(k / rows, columns) * steps[0], signed(k % rows, rows) * steps[1]);
        let ring = (x.hypot(y) / width).round() as usize;
        if let Some((sum, count)) = sums.get_mut(ring) {
            (*sum, *count) = (*sum + value.norm_sqr(), *count + 1);
        }
    }
    let density = px * py / squares;
    let ring = |(k, (sum, count)): (usize, &(f64, usize))| [k as f64 * width, density * sum / *count as f64];
    // Ring 0 is the mean, which is none.
    Ok(sums.iter().enumerate().skip(1).filter(|(_, (_, count))| *count > 0).map(ring).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A wave of height 1 along x: all of its variance 1/2 is in two places of the spectrum, each of df_x df_y.
    #[test]
    fn the_density_of_a_wave_integrates_to_its_variance() {
        let grid = MapGrid { columns: 64, pitch: [0.5, 0.5], periodic: true };
        let heights: Vec<f64> = (0..64 * 64).map(|k| (TAU * 8.0 * (k % 64) as f64 / 64.0).cos()).collect();
        let psd = radial(&heights, &grid).expect("room");
        let step = 1.0 / 32.0;
        let [peak, density] = psd[7];
        assert!((peak - 8.0 * step).abs() < 1e-12);
        // Places of ring 8: distances from 7.5 to 8.5.
        let distance = |k: i32, l: i32| f64::from(k).hypot(f64::from(l));
        let places =
            (-9..=9).flat_map(|k| (-9..=9).map(move |l| distance(k, l))).filter(|d| d.round() == 8.0).count();
        assert!((density * places as f64 * step * step - 0.5).abs() < 1e-12, "{density}");
        assert!(psd.iter().enumerate().all(|(k, [_, density])| k == 7 || *density < 1e-20));
    }

    /// White heights of variance 1: the density is pitch_x pitch_y everywhere, under a window too.
    #[test]
    fn white_heights_have_one_density() {
        let grid = MapGrid { columns: 256, pitch: [2.0, 3.0], periodic: false };
        let mut state = 9u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let heights: Vec<f64> = (0..256 * 256).map(|_| 12f64.sqrt() * uniform()).collect();
        let psd = radial(&heights, &grid).expect("room");
        let mean = psd.iter().map(|[_, density]| density).sum::<f64>() / psd.len() as f64;
        // 85 rings, the inner ones of few places: the mean is 6 within 10 %.
        assert!((mean / 6.0 - 1.0).abs() < 0.1, "{mean}");
    }
}
