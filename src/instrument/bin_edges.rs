//! Edges of a hemisphere's bins: the row and the column that hold a direction, by comparison with the stored edges. Tables
//! of directions, and quick estimates of the angles, decide wherever no edge is near.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use crate::sphere;

/// Increasing edges of half-open intervals.
#[derive(Debug, Clone)]
pub struct Edges {
    edges: Vec<f64>,
    per_unit: f64,
}

impl Edges {
    pub(super) fn new(edges: &[f64]) -> Self {
        let intervals = (edges.len() - 1) as f64;
        Edges { edges: edges.to_vec(), per_unit: intervals / (edges[edges.len() - 1] - edges[0]) }
    }

    pub(super) fn len(&self) -> usize {
        self.edges.len() - 1
    }

    /// The interval that holds `angle()`, an angle of which `near` is a quick estimate. Only near an edge is the
    /// angle itself needed to decide.
    fn find_quickly(&self, near: f64, angle: impl FnOnce() -> f64) -> usize {
        let guess = self.find(near);
        let inside = near - self.edges[guess] > QUICK_ERROR && self.edges[guess + 1] - near > QUICK_ERROR;
        if inside { guess } else { self.find(angle()) }
    }

    /// The interval [lower, upper) that holds `x`, which must not lie below the first edge. At or above the last
    /// edge it is the last interval: an angle of 90 degrees is the rounding of one just below.
    pub(super) fn find(&self, x: f64) -> usize {
        let guess = ((x - self.edges[0]) * self.per_unit) as usize;
        let mut k = guess.min(self.len() - 1);
        while k > 0 && x < self.edges[k] {
            k -= 1;
        }
        while k + 1 < self.len() && x >= self.edges[k + 1] {
            k += 1;
        }
        k
    }
}

/// Which row holds directions of a cosine, where one row holds all of about that cosine.
#[derive(Debug, Clone)]
pub struct RowsByCosine(Vec<u16>);

/// Ranges of equal width that the cosines above the horizon are parted into, and those below.
const COSINES: usize = 2048;
/// No row, or no column, holds all of a range.
const SEVERAL: u16 = u16::MAX;
/// What the angle of a vector, of unit length to 1e-11, and the arc cosine of its z are apart at most where ranges end, in
/// degrees: 1e-11 cot(theta), and theta >= acos(1 - 1/2048) there but at the poles, where no edge is near.
const COSINE_ERROR: f64 = 1e-6;

impl RowsByCosine {
    pub(super) fn new(edges: &[f64]) -> Self {
        let angle = |range: usize| (1.0 - range as f64 / COSINES as f64).acos().to_degrees();
        let row_of = |range: usize| {
            // From the pole on; at the horizon the sign of the cosine decides.
            let (low, high) = (angle(range) - COSINE_ERROR, angle(range + 1) + COSINE_ERROR);
            let row = edges.partition_point(|&edge| edge <= low.max(0.0)).checked_sub(1)?;
            let holds = edges.get(row + 1).is_some_and(|&end| high < end || end == 180.0);
            let crosses = low < 90.0 && high > 90.0;
            u16::try_from(row).ok().filter(|_| holds && !crosses)
        };
        RowsByCosine((0..2 * COSINES).map(|range| row_of(range).unwrap_or(SEVERAL)).collect())
    }

    /// The row; `None` where the angle must be looked at.
    #[inline]
    fn row(&self, cosine: f64) -> Option<usize> {
        let range = ((1.0 - cosine) * COSINES as f64) as usize;
        self.0.get(range).filter(|&&row| row != SEVERAL).map(|&row| usize::from(row))
    }
}

/// The polar angle of `wo`, to `QUICK_ERROR`.
pub(super) fn near_polar_deg(wo: DVec3) -> f64 {
    quick_atan2_deg((wo.x * wo.x + wo.y * wo.y).sqrt(), wo.z)
}

/// The row that holds `wo`, of which `above` lie above the horizon; `None` where those of its hemisphere are none.
#[inline]
pub(super) fn row(wo: DVec3, theta: &Edges, above: usize, by_cosine: &RowsByCosine) -> Option<usize> {
    by_cosine.row(wo.z).or_else(|| row_by_angle(wo, theta, above))
}

/// The same, by the angle alone.
///
/// The sign of wo.z decides the hemisphere: an angle of 90 degrees is the rounding of one just off it.
fn row_by_angle(wo: DVec3, theta: &Edges, above: usize) -> Option<usize> {
    let rows = if wo.z > 0.0 { 0..above } else { above..theta.len() };
    let last = rows.end.checked_sub(1).filter(|last| rows.start <= *last)?;
    let found = theta.find_quickly(near_polar_deg(wo), || sphere::theta(wo).to_degrees());
    Some(found.clamp(rows.start, last))
}

/// Which column holds directions of an azimuth, where one column holds all of about that azimuth.
///
/// Azimuths are told apart by where they meet the square |x| + |y| = 1, without an arc tangent.
#[derive(Debug, Clone)]
pub struct ColumnsByAzimuth(Vec<u16>);

/// Ranges of equal length that each side of the square is parted into.
const RANGES: usize = 1024;
/// More than rounding makes of an azimuth, degrees.
const AZIMUTH_ERROR: f64 = 1e-9;

impl ColumnsByAzimuth {
    pub(super) fn new(phi: &Edges) -> Self {
        let angle = |range: usize| {
            let along = (range % RANGES) as f64 / RANGES as f64;
            90.0 * (range / RANGES) as f64 + along.atan2(1.0 - along).to_degrees()
        };
        let column_of = |range: usize| {
            let ends = [angle(range) - AZIMUTH_ERROR, angle(range + 1) + AZIMUTH_ERROR];
            let [first, last] = ends.map(|end| phi.find(reduced(end.rem_euclid(360.0), phi)));
            u16::try_from(first).ok().filter(|_| first == last)
        };
        ColumnsByAzimuth((0..4 * RANGES).map(|range| column_of(range).unwrap_or(SEVERAL)).collect())
    }

    /// The column; `None` where the angle must be looked at.
    #[inline]
    fn column(&self, wo: DVec3) -> Option<usize> {
        let along = wo.y / (wo.x.abs() + wo.y.abs());
        let begin = if wo.y < 0.0 { 4.0 } else { 0.0 };
        let along = if wo.x < 0.0 { 2.0 - along } else { begin + along };
        let range = (along * RANGES as f64) as usize;
        self.0.get(range).filter(|&&column| column != SEVERAL).map(|&column| usize::from(column))
    }
}

/// The column of a hemisphere that holds `wo`.
#[inline]
pub(super) fn column(wo: DVec3, phi: &Edges, by_azimuth: &ColumnsByAzimuth) -> usize {
    by_azimuth.column(wo).unwrap_or_else(|| column_by_angle(wo, phi))
}

/// The same, by the angle alone.
#[cold]
fn column_by_angle(wo: DVec3, phi: &Edges) -> usize {
    let near = reduced(quick_atan2_deg(wo.y, wo.x), phi);
    phi.find_quickly(near, || reduced(sphere::phi(wo).to_degrees(), phi))
}

/// Bound on the error of `quick_atan2_deg`, degrees.
pub(super) const QUICK_ERROR: f64 = 2e-3;

/// atan2(y, x) in [0, 360) degrees to 2e-3 of a degree, without a library call; NaN at the origin.
///
/// Source: Hastings 1955, "Approximations for digital computers": the odd polynomial of degree 11.
// Tested by `the_quick_angle_keeps_its_bound`.
fn quick_atan2_deg(y: f64, x: f64) -> f64 {
    let (a, b) = (x.abs(), y.abs());
    let t = a.min(b) / a.max(b);
    let t2 = t * t;
    let inner = -0.116_432_87 + t2 * (0.052_653_32 - t2 * 0.011_721_20);
    let angle = t * (0.999_977_26 + t2 * (-0.332_623_47 + t2 * (0.193_543_46 + t2 * inner)));
    let first = if b > a { FRAC_PI_2 - angle } else { angle };
    let half = if x < 0.0 { PI - first } else { first };
    (if y < 0.0 { TAU - half } else { half }).to_degrees()
}

/// `phi` in [0, 360) moved by a full turn into the range of the edges, where it lies outside.
pub(super) fn reduced(phi: f64, edges: &Edges) -> f64 {
    let (first, last) = (edges.edges[0], edges.edges[edges.len()]);
    if phi < first {
        phi + 360.0
    } else if phi >= last {
        phi - 360.0
    } else {
        phi
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quick_angle_keeps_its_bound() {
        for step in 0..1_000_000 {
            let (sin, cos) = (f64::from(step) * TAU / 1e6).sin_cos();
            let exact = sphere::phi(DVec3::new(cos, sin, 0.0)).to_degrees();
            let off = (quick_atan2_deg(sin, cos) - exact).abs();
            assert!(off.min(360.0 - off) < QUICK_ERROR, "{exact}: {off}");
        }
    }

    #[test]
    fn columns_by_azimuth_are_those_of_the_angles() {
        let fine: Vec<f64> = (0..=360).map(f64::from).collect();
        for edges in [&[0.0, 360.0][..], &[-5.0, 5.0, 180.0, 355.0], &[10.0, 45.0, 90.0, 370.0], &fine] {
            let phi = Edges::new(edges);
            let by_azimuth = ColumnsByAzimuth::new(&phi);
            let mut found = 0;
            // About every edge, where ranges end, and in between.
            let near = edges.iter().flat_map(|edge| [-1e-7, -1e-13, 0.0, 1e-13, 1e-7].map(|off| edge + off));
            let sides =
                (0..4).flat_map(|side| (0..RANGES).map(move |range| (side, range as f64 / RANGES as f64)));
            let ends =
                sides.map(|(side, along)| 90.0 * f64::from(side) + along.atan2(1.0 - along).to_degrees());
            let between = (0..100_000).map(|k| f64::from(k) * 360e-5);
            for azimuth in near.chain(ends).chain(between) {
                let wo = sphere::direction_deg(40.0, azimuth);
                if let Some(quick) = by_azimuth.column(wo) {
                    assert_eq!(quick, column_by_angle(wo, &phi), "{azimuth}");
                    found += 1;
                }
            }
            // Nearly all: 1 degree is at least 11 ranges, of which an edge takes at most two.
            assert!(found > 80_000, "{found}");
            for pole in [DVec3::Z, DVec3::new(-0.0, 0.0, 1.0), DVec3::new(-1.0, -0.0, 0.0)] {
                assert_eq!(column(pole, &phi, &by_azimuth), column_by_angle(pole, &phi));
            }
        }
    }

    #[test]
    fn rows_by_cosine_are_those_of_the_angles() {
        let fine: Vec<f64> = (0..=180).map(f64::from).collect();
        for edges in [&[0.0, 2.5, 7.5, 85.0, 90.0][..], &[90.0, 120.0, 180.0], &fine] {
            let (theta, by_cosine) = (Edges::new(edges), RowsByCosine::new(edges));
            let above = edges[1..].iter().filter(|&&edge| edge <= 90.0).count();
            let mut found = 0;
            // About every edge, where ranges of the cosine end, and in between.
            let near = edges.iter().flat_map(|edge| [-1e-7, -1e-13, 0.0, 1e-13, 1e-7].map(|off| edge + off));
            let ranges = (0..=2 * COSINES).map(|range| 1.0 - range as f64 / COSINES as f64);
            let between = (0..100_000).map(|k| f64::from(k) * 180e-5);
            for polar in near.chain(ranges.map(|cosine| cosine.acos().to_degrees())).chain(between) {
                let wo = sphere::direction_deg(polar.clamp(0.0, 180.0), 33.0);
                if let Some(quick) = by_cosine.row(wo.z) {
                    assert_eq!(Some(quick), row_by_angle(wo, &theta, above), "{polar}");
                    found += 1;
                }
            }
            // Nearly all of those that the rows hold: 1 degree is at least 36 ranges but near the poles.
            let held = (edges[edges.len() - 1] - edges[0]) / 180.0 * 100_000.0;
            assert!(f64::from(found) > 0.9 * held, "{found}");
        }
    }
}
