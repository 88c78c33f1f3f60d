//! Finer samples of a measured map: a cubic spline through its own, so fine that the slopes no longer depend on the
//! diagonal along which cells are split.
//!
//! Why: each cell is split along one diagonal, so that facets lean towards that diagonal by half of the cell's second
//! difference. On a scan with a lay this turns light out of the plane of incidence, and out of another plane on the
//! mirror image of the scan. Between samples the spline's second differences fall with the square of the pitch.
//! Input: heights, and the slope of one unit of height a cell. Output: heights on a grid of a power of two as many
//! cells along each side, which pass through the samples unchanged.

use glam::DVec2;

use super::spline::refined;
use crate::error::Checked;
use crate::files::memory;
use crate::surface::Heightfield;

/// Cells beyond which nothing is refined automatically: the patch of 4096 x 4096 that other surfaces have at most by
/// custom.
pub const AUTO_CELLS: usize = 1 << 24;
/// Cells beyond which nothing is refined at all: heights of 2 GiB, as for random patches.
pub const MOST_CELLS: usize = 1 << 28;
/// Finest steps between two samples.
pub const MOST_STEPS: usize = 64;
/// How well the slopes under both cuts must agree (`Cuts::disagreement`).
pub const AGREEMENT: f64 = 0.01;
/// Bytes for each cell of the finer grid at most: its height, the splines of half as many, and the grid before it.
const REFINING: u64 = 32;
/// Slopes below which a map is a mirror whatever its cells do: single precision knows no smaller ones.
const MIRROR: f64 = 1e-6;
/// The slopes of a map under both ways to split a cell into two facets. Slopes are ratios of lengths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cuts {
    /// Covariances xx, yy, xy of the slopes: mean over both cuts. The first two are the same under either.
    pub covariance: [f64; 3],
    /// How much larger xy is under the cut (x+1, y)-(x, y+1): half of the mean squared second difference.
    pub difference: f64,
    /// Root mean square slope, Sdq of ISO 25178.
    pub sdq: f64,
}

impl Cuts {
    /// Examines a map; `alpha`: slope of one unit of height a cell, along x and y.
    pub fn of(field: &Heightfield, alpha: DVec2) -> Self {
        let mut sums = [0.0; 6];
        for y in 0..field.cells_y() {
            // Row by row, so that a large map loses no digits.
            let mut row = [0.0; 6];
            for x in 0..field.cells_x() {
                let corners = field.corners(x, y);
                let (lower, upper) = (corners.lower_slope() * alpha, corners.upper_slope() * alpha);
                let (both, twist) = (lower + upper, upper - lower);
                let terms = [
                    both.x,
                    both.y,
                    lower.x * lower.x + upper.x * upper.x,
                    lower.y * lower.y + upper.y * upper.y,
                    0.5 * both.x * both.y,
                    twist.x * twist.y,
                ];
                row.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
            }
            sums.iter_mut().zip(row).for_each(|(sum, term)| *sum += term);
        }
        let facets = 2.0 * (field.cells_x() * field.cells_y()) as f64;
        let [x, y, xx, yy, xy, difference] = sums.map(|sum| sum / facets);
        Cuts { covariance: [xx - x * x, yy - y * y, xy - x * y], difference, sdq: (xx + yy).sqrt() }
    }

    /// How far slopes under the two cuts disagree: their variance in the direction where it is least (relative), or
    /// their standard deviation, relative to the rms slope across the lay, whichever is the smaller. 0: not at all.
    ///
    /// The second is for a lay so straight that there is next to no variance along it.
    pub fn disagreement(&self) -> f64 {
        if self.difference == 0.0 {
            return 0.0;
        }
        let [xx, yy, xy] = self.covariance;
        let (middle, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
        let (least, most) = (middle - half, middle + half);
        let of_deviation = (self.difference / most).sqrt();
        if least > 0.0 { of_deviation.min(self.difference / least) } else { of_deviation }
    }

    /// Whether the slopes no longer depend on the diagonal.
    pub fn agree(&self) -> bool {
        self.disagreement() <= AGREEMENT || self.sdq < MIRROR
    }
}

/// A map on its finer grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined {
    /// The heights.
    pub field: Heightfield,
    /// Cells for each of the map's own along a side.
    pub steps: usize,
    /// The map as it was sampled.
    pub before: Cuts,
    /// The map as it is now.
    pub after: Cuts,
}

/// Refines by `steps`, a power of two, or as far as the cuts ask for and `AUTO_CELLS` allows.
// Tested by `a_map_and_its_mirror_image_have_mirrored_slopes`, `refinement_goes_as_far_as_the_cuts_ask`.
pub fn refine(field: Heightfield, alpha: DVec2, steps: Option<u32>) -> Checked<Refined> {
    let before = Cuts::of(&field, alpha);
    let cells = |steps: usize| (field.cells_x() * field.cells_y()).saturating_mul(steps * steps);
    if let Some(steps) = steps.map(|steps| steps as usize) {
        if cells(steps) > MOST_CELLS {
            let most = MOST_CELLS >> 20;
            return Err(format!(
                "surface.file.refine = {steps} makes {} cells; at most {most} Mi are allowed: refine less",
                cells(steps)
            )
            .into());
        }
        memory::check(REFINING * cells(steps) as u64)?;
        let fine = refined(&field, steps);
        let after = Cuts::of(&fine, alpha * steps as f64);
        return Ok(Refined { field: fine, steps, before, after });
    }
    let (mut steps, mut after, mut fine) = (1, before, None);
    while !after.agree() && 2 * steps <= MOST_STEPS && cells(2 * steps) <= AUTO_CELLS {
        steps *= 2;
        // Refused, not refined less: what is measured must not depend on the machine.
        memory::check(REFINING * cells(steps) as u64)?;
        let next = fine.insert(refined(&field, steps));
        after = Cuts::of(next, alpha * steps as f64);
    }
    Ok(Refined { field: fine.unwrap_or(field), steps, before, after })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn field(side: usize, periodic: bool, height: impl Fn(f64, f64) -> f64) -> Heightfield {
        let samples = side + usize::from(!periodic);
        let at = |i: usize| height((i % samples) as f64, (i / samples) as f64);
        Heightfield::new(side, side, periodic, (0..samples * samples).map(at).collect())
    }

    #[test]
    fn an_open_map_that_is_a_cubic_along_x_and_y_is_refined_exactly() {
        let cubic = |x: f64, y: f64| 3.0 - x + 0.25 * x * x * y - 0.01 * (x * y).powi(3) + 0.5 * y * y * y;
        let coarse = field(9, false, cubic);
        for steps in [2, 4, 8] {
            let fine = refined(&coarse, steps);
            let samples = 9 * steps + 1;
            for (i, found) in fine.heights().iter().enumerate() {
                let (x, y) = ((i % samples) as f64 / steps as f64, (i / samples) as f64 / steps as f64);
                // Heights reach 0.01 x 81^3 = 5300; two solutions of condition 3 and some ten roundings.
                assert!((found - cubic(x, y)).abs() < 5300.0 * 64.0 * f64::EPSILON, "{steps}: {x} {y}");
            }
        }
    }

    #[test]
    fn samples_keep_their_bits_and_a_periodic_map_stays_one() {
        let coarse =
            field(24, true, |x, y| (TAU * (3.0 * x + 2.0 * y) / 24.0).sin() + 0.3 * (0.7 * x * y).sin());
        let fine = refined(&coarse, 4);
        for i in 0..24 * 24 {
            let found = fine.heights()[(i / 24) * 4 * 96 + (i % 24) * 4];
            assert_eq!(found.to_bits(), coarse.heights()[i].to_bits(), "{i}");
        }
        // Turned by some rows, it is refined to the same heights, turned: there is no seam.
        let rows = 7 * 24;
        let turned =
            Heightfield::new(24, 24, true, [&coarse.heights()[rows..], &coarse.heights()[..rows]].concat());
        let again = refined(&turned, 4);
        for (a, b) in again.heights().iter().zip(fine.heights()[4 * 7 * 96..].iter().chain(fine.heights())) {
            // Heights of about 1, and a solution that ends elsewhere.
            assert!((a - b).abs() < 32.0 * f64::EPSILON, "{a} {b}");
        }
    }

    /// A wave of 24 samples: the spline's error is (2 pi/24)^4/384 of its height at most, times a few at the ends of
    /// an open map, which the closed one has not.
    #[test]
    fn between_the_samples_of_a_sine_lies_the_sine() {
        let wave = |x: f64| (TAU * x / 24.0).sin();
        let fine = refined(&field(48, true, |x, y| wave(x) + wave(y)), 8);
        let bound = 2.0 * (TAU / 24.0_f64).powi(4) / 384.0 * 1.5;
        for (i, found) in fine.heights().iter().enumerate() {
            let exact = wave((i % 384) as f64 / 8.0) + wave((i / 384) as f64 / 8.0);
            assert!((found - exact).abs() < bound, "{i}: {found} {exact}");
        }
    }

    /// h = A sin(k x) sin(k y): variance of a slope A^2 k^2/4, mean square of the second difference of a cell of side
    /// 1 (4 A sin^2(k/2))^2/4, half of which is the difference of the cuts; a slope is a difference quotient, which
    /// sinc(k/2) dampens, and the edge that it is taken along has the whole variance of the other sine.
    #[test]
    fn the_cuts_differ_by_half_the_mean_square_of_the_second_difference() {
        let (a, k) = (0.3, TAU / 16.0);
        let cuts = Cuts::of(&field(64, true, |x, y| a * (k * x).sin() * (k * y).sin()), DVec2::ONE);
        let half = (0.5 * k).sin();
        approx::assert_relative_eq!(cuts.covariance[0], (a * half).powi(2), max_relative = 1e-12);
        approx::assert_relative_eq!(cuts.covariance[1], (a * half).powi(2), max_relative = 1e-12);
        approx::assert_relative_eq!(cuts.difference, 2.0 * a * a * half.powi(4), max_relative = 1e-12);
        // No preferred azimuth: 2 sin^2(k/2) of the variance.
        approx::assert_relative_eq!(cuts.disagreement(), 2.0 * half * half, max_relative = 1e-9);
    }

    #[test]
    fn refinement_goes_as_far_as_the_cuts_ask() {
        let (a, k) = (0.3, TAU / 16.0);
        let map = |shape: fn(f64, f64) -> f64| field(64, true, move |x, y| a * shape(k * x, k * y));
        let chosen = |shape| refine(map(shape), DVec2::ONE, None).expect("fits");
        // 2 sin^2(k/2) = 0.0761, and a quarter of it for each doubling: 0.0192, 0.0048.
        let bumps = chosen(|x, y| x.sin() * y.sin());
        assert_eq!((bumps.steps, bumps.field.cells_x()), (4, 256));
        assert!(bumps.before.disagreement() > 0.07 && bumps.after.disagreement() < 0.0050, "{bumps:?}");
        // Along an axis, or flat: no second difference, nothing to gain.
        assert_eq!(chosen(|x, _| x.sin()).steps, 1);
        assert_eq!(chosen(|_, _| 0.0).steps, 1);
        // A lay at 45 degrees, no variance along it: deviations of sin(k/2) = 0.195 at first, 0.012 after 16 steps.
        assert_eq!(chosen(|x, y| (x - y).sin()).steps, 32);
        assert!(refine(map(|x, y| x * y), DVec2::ONE, Some(1)).is_ok_and(|one| one.steps == 1));
        assert!(
            refine(field(1000, true, |_, _| 0.0), DVec2::ONE, Some(32))
                .expect_err("2^30")
                .to_string()
                .contains("refine less")
        );
    }

    /// The shared example in small: waves across grooves at 30 degrees, and their mirror image.
    #[test]
    fn a_map_and_its_mirror_image_have_mirrored_slopes() {
        let waves = |x: f64, y: f64| {
            let u = -0.5 * x + 0.75_f64.sqrt() * y;
            (0.2 * u).sin() + 0.3 * (0.55 * u + 1.0).sin()
        };
        let plus = field(64, false, waves);
        let minus = field(64, false, |x, y| waves(x, 64.0 - y));
        // Variance along the lay, which has none, over that across it, under the one cut that facets have.
        let along = |field: &Heightfield, sign: f64, alpha: f64| {
            let cells = (0..field.cells_y()).flat_map(|y| (0..field.cells_x()).map(move |x| (x, y)));
            let slopes = cells.flat_map(|(x, y)| {
                let corners = field.corners(x, y);
                [corners.lower_slope() * alpha, corners.upper_slope() * alpha]
            });
            let lay = DVec2::new(0.75_f64.sqrt(), sign * 0.5);
            let (mut lies, mut stands) = (0.0, 0.0);
            for slope in slopes {
                lies += slope.dot(lay).powi(2);
                stands += slope.perp_dot(lay).powi(2);
            }
            lies / stands
        };
        let coarse = [along(&plus, 1.0, 1.0), along(&minus, -1.0, 1.0)];
        assert!(coarse[0] > 5.0 * coarse[1] && coarse[0] > 0.01, "the old cut must show: {coarse:?}");
        let fine = [(&plus, 1.0), (&minus, -1.0)].map(|(field, sign)| {
            let refined = refine(field.clone(), DVec2::ONE, None).expect("fits");
            assert!(refined.after.agree(), "{:?}", refined.after);
            along(&refined.field, sign, refined.steps as f64)
        });
        // Deviations of 1 % of the slope are 1e-4 of the variance; the axes may share them by up to twice that.
        assert!(fine.iter().all(|share| *share < 2e-4), "{fine:?}");
    }
}
