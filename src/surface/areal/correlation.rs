//! The autocorrelation of a map, and the lengths in which it falls to 0.2.
//!
//! At a lag the mean of h(x) h(x + lag) over the places that have both, over the mean of h^2. A map that ends is continued by
//! zeros for the transform, so that nothing goes round.

use super::fourier::{Plane, quick_length};
use crate::error::Checked;
use crate::surface::io::prepare::MapGrid;

/// Where the autocorrelation counts as fallen: s of ISO 25178-3.
const FALLEN: f64 = 0.2;
/// Steps of a sample in which a crossing is looked for.
const FINE: usize = 16;

/// Autocorrelation by lag; lag 0 is in the middle.
pub struct Autocorrelation {
    columns: usize,
    rows: usize,
    /// Column and row of lag 0.
    middle: [usize; 2],
    pitch: [f64; 2],
    values: Vec<f64>,
}

/// Of heights of mean zero.
pub fn autocorrelation(heights: &[f64], grid: &MapGrid) -> Checked<Autocorrelation> {
    let size = [grid.columns, grid.rows(heights)];
    let padded = if grid.periodic { size } else { size.map(|count| quick_length(2 * count - 1)) };
    let mut plane = Plane::zeros(padded[0], padded[1])?;
    let mean = heights.iter().sum::<f64>() / heights.len() as f64;
    for (k, height) in heights.iter().enumerate() {
        plane.values[k / size[0] * padded[0] + k % size[0]].re = height - mean;
    }
    let mut power = plane.transformed(false);
    power.values.iter_mut().for_each(|value| *value = value.norm_sqr().into());
    let raw = power.transformed(true);
    // Lags from -(n - 1) to n - 1, or of a periodic map half of it either way.
    let middle = size.map(|count| if grid.periodic { count / 2 } else { count - 1 });
    let lags = [0, 1].map(|axis| if grid.periodic { size[axis] } else { 2 * size[axis] - 1 });
    let variance = raw.values[0].re / heights.len() as f64;
    let at = |k: usize| {
        let lag = [(k % lags[0]) as isize - middle[0] as isize, (k / lags[0]) as isize - middle[1] as isize];
        let place = |axis: usize| lag[axis].rem_euclid(padded[axis] as isize) as usize;
        let both =
            |axis: usize| if grid.periodic { size[axis] } else { size[axis] - lag[axis].unsigned_abs() };
        let mean = raw.values[place(1) * padded[0] + place(0)].re / (both(0) * both(1)) as f64;
        if variance > 0.0 { mean / variance } else { 0.0 }
    };
    let values = (0..lags[0] * lags[1]).map(at).collect();
    Ok(Autocorrelation { columns: lags[0], rows: lags[1], middle, pitch: grid.pitch, values })
}

impl Autocorrelation {
    /// Lag and autocorrelation along x (0) or y (1), up to half of the map.
    pub fn along(&self, axis: usize) -> Vec<[f64; 2]> {
        let count = if axis == 0 { self.columns } else { self.rows };
        let last = (count - self.middle[axis]).div_ceil(2);
        let step = if axis == 0 { 1 } else { self.columns };
        let origin = self.middle[1] * self.columns + self.middle[0];
        (0..last).map(|k| [k as f64 * self.pitch[axis], self.values[origin + k * step]]).collect()
    }

    /// Sal and Str: the shortest distance from lag 0 to where the values have fallen to 0.2, and its ratio to the longest.
    /// Neither is defined where they fall nowhere, and Str where they do not fall before the end of the map.
    ///
    /// Looked for on lines from the middle to each place that bounds the values above 0.2 round it, between samples by
    /// polynomials of degree 5.
    pub fn decay_lengths(&self) -> [Option<f64>; 2] {
        let (bounds, is_whole) = self.bounds();
        let lengths = bounds.iter().filter_map(|bound| self.crossing(*bound));
        let (shortest, longest) =
            lengths.fold((f64::INFINITY, 0.0f64), |(low, high), length| (low.min(length), high.max(length)));
        if shortest.is_infinite() {
            return [None, None];
        }
        [Some(shortest), is_whole.then_some(shortest / longest)]
    }

    /// The places that bound those above 0.2 which are connected, along sides, to the middle; and whether these keep from the
    /// edge.
    fn bounds(&self) -> (Vec<[usize; 2]>, bool) {
        let mut seen = vec![false; self.values.len()];
        let (mut bounds, mut is_whole) = (Vec::new(), true);
        let mut open = vec![self.middle];
        while let Some([x, y]) = open.pop() {
            let at = y * self.columns + x;
            if std::mem::replace(&mut seen[at], true) {
                continue;
            }
            if self.values[at] <= FALLEN {
                bounds.push([x, y]);
                continue;
            }
            if x == 0 || y == 0 || x + 1 == self.columns || y + 1 == self.rows {
                is_whole = false;
                continue;
            }
            open.extend([[x - 1, y], [x + 1, y], [x, y - 1], [x, y + 1]]);
        }
        (bounds, is_whole)
    }

    /// Distance from the middle to where the values fall to 0.2 on the way to a bound: the last such place.
    fn crossing(&self, [x, y]: [usize; 2]) -> Option<f64> {
        let lag = [x as f64 - self.middle[0] as f64, y as f64 - self.middle[1] as f64];
        let distance = (lag[0] * self.pitch[0]).hypot(lag[1] * self.pitch[1]);
        let steps = (lag[0].hypot(lag[1]) * FINE as f64).ceil() as usize;
        let value = |step: usize| {
            let t = step as f64 / steps as f64;
            self.between(self.middle[0] as f64 + t * lag[0], self.middle[1] as f64 + t * lag[1])
        };
        let mut after = value(steps);
        for step in (0..steps).rev() {
            let here = value(step);
            if here > FALLEN {
                let part = (here - FALLEN) / (here - after.min(FALLEN));
                return Some(distance * (step as f64 + part) / steps as f64);
            }
            after = here;
        }
        None
    }

    /// The value between samples: the polynomial through six of them along x and along y, level beyond the edge.
    fn between(&self, x: f64, y: f64) -> f64 {
        let (first_x, first_y) = (x.floor(), y.floor());
        let (along_x, along_y) = (weights(x - first_x), weights(y - first_y));
        let place = |first: f64, k: usize, count: usize| {
            (first as isize + k as isize - 2).clamp(0, count as isize - 1) as usize
        };
        let row = |(j, weight): (usize, &f64)| {
            let start = place(first_y, j, self.rows) * self.columns;
            let across =
                |(k, weight): (usize, &f64)| weight * self.values[start + place(first_x, k, self.columns)];
            weight * along_x.iter().enumerate().map(across).sum::<f64>()
        };
        along_y.iter().enumerate().map(row).sum()
    }
}

/// Lagrange's weights of the samples at -2 to 3 for the place t in [0, 1).
fn weights(t: f64) -> [f64; 6] {
    std::array::from_fn(|k| {
        let node = k as f64 - 2.0;
        (0..6).filter(|j| *j != k).map(|j| j as f64 - 2.0).map(|other| (t - other) / (node - other)).product()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn waves(columns: usize, rows: usize, of: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        (0..columns * rows).map(|k| of((k % columns) as f64, (k / columns) as f64)).collect()
    }

    /// Of cos along x with length l the autocorrelation is cos(tau lag/l), along y 1: it falls to 0.2 at acos(0.2)/tau l.
    #[test]
    fn straight_waves_fall_at_their_arccosine_and_never_along_their_lay() {
        let grid = MapGrid { columns: 120, pitch: [0.5, 2.0], periodic: true };
        let heights = waves(120, 60, |x, _| (TAU * x / 24.0).cos());
        let acf = autocorrelation(&heights, &grid).expect("room");
        for [lag, value] in acf.along(0) {
            assert!((value - (TAU * lag / 12.0).cos()).abs() < 1e-12);
        }
        assert!(acf.along(1).iter().all(|[_, value]| (value - 1.0).abs() < 1e-12));
        let [sal, str_] = acf.decay_lengths();
        // Steps of 1/16 of a sample are taken for straight: (tau/24/16)^2/8 of the height, over a slope of 0.98 tau/24.
        let wanted = 0.2f64.acos() / TAU * 12.0;
        assert!((sal.expect("falls") / wanted - 1.0).abs() < 1e-4, "{sal:?} {wanted}");
        assert_eq!(str_, None);
    }

    /// Of crossed waves of lengths a and b, each of its share of the variance.
    #[test]
    fn crossed_waves_have_the_ratio_of_their_lengths() {
        let grid = MapGrid { columns: 160, pitch: [1.0, 1.0], periodic: true };
        let heights = waves(160, 160, |x, y| (TAU * x / 32.0).cos() * (TAU * y / 80.0).cos());
        let [sal, str_] = autocorrelation(&heights, &grid).expect("room").decay_lengths();
        // The product falls to 0.2 along x at 0.2 of cos, and along y likewise.
        let along = |length: f64| 0.2f64.acos() / TAU * length;
        assert!((sal.expect("falls") / along(32.0) - 1.0).abs() < 2e-3, "{sal:?}");
        assert!((str_.expect("falls") / (32.0 / 80.0) - 1.0).abs() < 3e-3, "{str_:?}");
    }

    #[test]
    fn an_open_map_does_not_go_round() {
        let grid = MapGrid { columns: 5, pitch: [1.0, 1.0], periodic: false };
        let heights = [1.0, -1.0, 2.0, 0.0, -2.0, 3.0, -3.0, 1.0, 0.0, -1.0];
        let acf = autocorrelation(&heights, &grid).expect("room");
        // By hand: products of the pairs three columns apart, over four pairs, over the variance 30/10.
        let wanted = (0.0 + 2.0 + 0.0 + 3.0) / 4.0 / 3.0;
        let found = acf.values[acf.middle[1] * acf.columns + acf.middle[0] + 3];
        assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        assert_eq!(acf.decay_lengths()[1].is_some(), acf.bounds().1);
    }
}
