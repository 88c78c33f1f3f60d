//! Samples without data: told from heights, and filled by a harmonic surface.
//!
//! A filled height is the mean of its neighbours, weighted by the inverse squares of their distances (Laplace's equation on
//! the grid), with the measured heights round the gap as its border; at an open edge of the map the slope across the edge
//! is 0. It overshoots no height of its border, and adds no form of its own: across a gap a plane stays a plane.

use super::MapGrid;
use crate::error::Checked;
use crate::files::memory;

/// How far a filled height may be from the mean of its neighbours, relative to the range of the heights.
const CONVERGED: f64 = 1e-9;
/// Conjugate gradients that this many steps do not end are stuck: a gap of a million samples takes a few thousand.
const MOST_STEPS: usize = 100_000;
/// Bytes for each sample of a gap: its place, four vectors, and its index among all.
const NEEDED: u64 = 8 + 4 * 8;

/// Fills the samples that are NaN; there must be others. Returns how many there were.
pub fn fill(heights: &mut [f64], grid: &MapGrid) -> Checked<usize> {
    let places: Vec<usize> = (0..heights.len()).filter(|at| heights[*at].is_nan()).collect();
    if places.is_empty() {
        return Ok(0);
    }
    memory::check(places.len() as u64 * NEEDED + 4 * heights.len() as u64)?;
    let mut index = vec![u32::MAX; heights.len()];
    for (k, at) in places.iter().enumerate() {
        index[*at] = k as u32;
    }
    let system = System { heights, grid, places: &places, index: &index };
    let filled = system.solve()?;
    for (at, height) in places.iter().zip(filled) {
        heights[*at] = height;
    }
    Ok(places.len())
}

/// Laplace's equation for the samples of the gaps: sum over neighbours of w (h - h') = 0.
struct System<'a> {
    heights: &'a [f64],
    grid: &'a MapGrid,
    places: &'a [usize],
    /// Of a sample of the map the number of its unknown.
    index: &'a [u32],
}

impl System<'_> {
    /// Conjugate gradients, each unknown in proportion to its own weight (Jacobi), from the mean of all heights.
    fn solve(&self) -> Checked<Vec<f64>> {
        let known = self.heights.iter().filter(|height| !height.is_nan());
        let (mut low, mut high, mut sum, mut count) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0);
        for &height in known {
            (low, high, sum, count) = (low.min(height), high.max(height), sum + height, count + 1.0);
        }
        let mean = sum / count;
        let near_enough = CONVERGED * (high - low);
        let unknowns = self.places.len();
        let mut found = vec![mean; unknowns];
        let (mut rest, weights): (Vec<f64>, Vec<f64>) =
            (0..unknowns).map(|k| self.row(k, |j| found[j], true)).unzip();
        rest.iter_mut().for_each(|rest| *rest = -*rest);
        let mut along: Vec<f64> = rest.iter().zip(&weights).map(|(rest, weight)| rest / weight).collect();
        let mut size: f64 = rest.iter().zip(&along).map(|(a, b)| a * b).sum();
        for _ in 0..MOST_STEPS {
            let off =
                rest.iter().zip(&weights).map(|(rest, weight)| (rest / weight).abs()).fold(0.0, f64::max);
            if off <= near_enough {
                return Ok(found);
            }
            let turned: Vec<f64> = (0..unknowns).map(|k| self.row(k, |j| along[j], false).0).collect();
            let step = size / along.iter().zip(&turned).map(|(a, b)| a * b).sum::<f64>();
            found.iter_mut().zip(&along).for_each(|(found, along)| *found += step * along);
            rest.iter_mut().zip(&turned).for_each(|(rest, turned)| *rest -= step * turned);
            let next: f64 = rest.iter().zip(&weights).map(|(rest, weight)| rest * rest / weight).sum();
            let kept = next / size;
            size = next;
            for ((along, rest), weight) in along.iter_mut().zip(&rest).zip(&weights) {
                *along = rest / weight + kept * *along;
            }
        }
        Err("the gaps could not be filled: cut the map to where there are data".into())
    }

    /// Of unknown `k` the sum of w (h - h'), and that of w; heights of the border count where `border` says so.
    fn row(&self, k: usize, value: impl Fn(usize) -> f64, border: bool) -> (f64, f64) {
        let MapGrid { columns, pitch, periodic } = *self.grid;
        let rows = self.grid.rows(self.heights);
        let (x, y) = (self.places[k] % columns, self.places[k] / columns);
        let here = value(k);
        let (mut sum, mut weights) = (0.0, 0.0);
        let mut add = |at: usize, weight: f64| {
            let other = match self.index[at] {
                u32::MAX if border => self.heights[at],
                u32::MAX => 0.0,
                unknown => value(unknown as usize),
            };
            sum += weight * (here - other);
            weights += weight;
        };
        let beside = |at: usize, count: usize| {
            let before = if at > 0 { Some(at - 1) } else { periodic.then_some(count - 1) };
            let after = if at + 1 < count { Some(at + 1) } else { periodic.then_some(0) };
            [before, after].into_iter().flatten()
        };
        // Relative to x, so that no unit is too small or too large.
        let across = (pitch[0] / pitch[1]).powi(2);
        beside(x, columns).for_each(|x| add(y * columns + x, 1.0));
        beside(y, rows).for_each(|y| add(y * columns + x, across));
        (sum, weights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(pitch: [f64; 2], periodic: bool) -> MapGrid {
        MapGrid { columns: 40, pitch, periodic }
    }

    /// A disc of radius 9 and two single samples, as gaps of a map of 40 x 30 samples.
    fn holed(height: impl Fn(f64, f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let at = |k: usize| height((k % 40) as f64, (k / 40) as f64);
        let whole: Vec<f64> = (0..40 * 30).map(at).collect();
        let mut holed = whole.clone();
        for (k, height) in holed.iter_mut().enumerate() {
            let (x, y) = ((k % 40) as f64 - 17.0, (k / 40) as f64 - 14.0);
            if x.hypot(y) < 9.0 || k == 4 * 40 + 33 || k == 25 * 40 + 36 {
                *height = f64::NAN;
            }
        }
        (whole, holed)
    }

    /// Second differences of a quadratic are exact: X^2 - Y^2, X Y and X are harmonic on the grid, too.
    #[test]
    fn a_harmonic_surface_comes_back_whatever_the_pitches() {
        for pitch in [[1.0f64, 1.0f64], [1.0, 3.0], [2e-7, 1e-7]] {
            let [px, py] = pitch;
            let scale = px.max(py) * px.max(py);
            let height = |x: f64, y: f64| {
                let (x, y) = (px * (x - 20.0), py * (y - 11.0));
                (x * x - y * y + 0.7 * x * y) / scale + 3.0 * x / px
            };
            let (whole, mut heights) = holed(height);
            let range = whole.iter().fold(0.0f64, |most, h| most.max(h.abs())) * 2.0;
            let count = fill(&mut heights, &grid(pitch, false)).expect("fills");
            assert!(count > 240, "{count}");
            for (found, wanted) in heights.iter().zip(&whole) {
                // 1e-9 of the range at each sample; the sum over a disc of radius r gains r^2/4 = 20 of it at most, along the
                // closer axis nine times as many samples.
                assert!((found - wanted).abs() < 200.0 * CONVERGED * range, "{pitch:?}: {found} {wanted}");
            }
        }
    }

    #[test]
    fn a_gap_at_an_edge_is_level_across_it_and_a_periodic_one_goes_round() {
        // cos(pi k (y + 1/2)/30) is level at both ends, and h(x) = cosh(c (x + 1/2)) at x = 0, where 2 cosh c - 2 is what its second
        // difference along y takes away.
        let (turn, columns) = (2.0 * std::f64::consts::PI / 30.0, 3);
        let along = |y: usize| (turn * (y as f64 + 0.5)).cos();
        let across = |x: usize| ((2.0 - turn.cos()).acosh() * (x as f64 + 0.5)).cosh();
        let mut heights: Vec<f64> = (0..40 * 30).map(|k| along(k / 40) * across(columns)).collect();
        (0..30).for_each(|y| heights[y * 40..y * 40 + columns].fill(f64::NAN));
        fill(&mut heights, &grid([1.0, 1.0], false)).expect("fills");
        let near = |x: usize, y: usize| (heights[y * 40 + x] - along(y) * across(x)).abs() < 1e-7;
        assert!((0..30).all(|y| (0..columns).all(|x| near(x, y))));
        // Round the seam, between 1 and 5: in equal steps.
        let mut ring: Vec<f64> = (0..40 * 30).map(|k| if k % 40 < 20 { 5.0 } else { 1.0 }).collect();
        (0..30).for_each(|y| [39, 0, 1].iter().for_each(|x| ring[y * 40 + x] = f64::NAN));
        fill(&mut ring, &grid([1.0, 1.0], true)).expect("fills");
        assert!(
            [(39, 2.0), (0, 3.0), (1, 4.0)].iter().all(|(x, h)| (ring[7 * 40 + x] - h).abs() < 1e-6),
            "{ring:?}"
        );
    }

    #[test]
    fn a_filled_height_lies_between_those_of_its_border() {
        let (_, mut heights) = holed(|x, y| ((x * 12.9898 + y * 78.233).sin() * 43758.5453).fract());
        let (low, high) = heights
            .iter()
            .filter(|h| !h.is_nan())
            .fold((9.0f64, -9.0f64), |(l, u), h| (l.min(*h), u.max(*h)));
        fill(&mut heights, &grid([1.0, 1.0], false)).expect("fills");
        assert!(heights.iter().all(|h| (low..=high).contains(h)));
    }
}
