//! The sensor: which bins a direction falls into, by comparison with the stored edges.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::grid::{Grid, GridKind};
use crate::sphere;

/// Finds bins; made once from a grid, shared by all threads. Directions are in the frame that the grid's phi_r
/// counts in: the stage's, or the light's when the azimuth is relative.
#[derive(Debug, Clone)]
pub enum Sensor {
    /// Every direction of the hemispheres that it covers falls into exactly one bin.
    Hemisphere {
        /// Edges of the rows.
        theta: Edges,
        /// Rows above the horizon; the others lie below it.
        above: usize,
        /// Edges of the columns.
        phi: Edges,
        /// Rows by the cosine of the polar angle.
        by_cosine: RowsByCosine,
    },
    /// A direction may fall into several apertures, or into none.
    Arm {
        /// The apertures, by increasing polar angle of the axis.
        caps: Vec<Cap>,
        /// Squared chord of the half-angle.
        chord2: f64,
        /// Half-angle with a margin for the rounding of angles, rad.
        reach: f64,
    },
    /// A list of `[theta_lo, theta_hi, phi_lo, phi_hi]` in degrees, half-open; a direction falls into those that
    /// hold it.
    Patches(Vec<[f64; 4]>),
}

/// One aperture of an arm.
#[derive(Debug, Clone, Copy)]
pub struct Cap {
    theta: f64,
    axis: DVec3,
    bin: usize,
}

/// Increasing edges of half-open intervals.
#[derive(Debug, Clone)]
pub struct Edges {
    edges: Vec<f64>,
    per_unit: f64,
}

impl Edges {
    fn new(edges: &[f64]) -> Self {
        let intervals = (edges.len() - 1) as f64;
        Edges { edges: edges.to_vec(), per_unit: intervals / (edges[edges.len() - 1] - edges[0]) }
    }

    fn len(&self) -> usize {
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
    fn find(&self, x: f64) -> usize {
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

impl Sensor {
    /// The sensor of a grid.
    pub fn new(grid: &Grid) -> Self {
        match grid.kind {
            GridKind::Hemisphere => Sensor::Hemisphere {
                theta: Edges::new(&grid.theta_r_edges_deg),
                above: grid.theta_r_edges_deg[1..].iter().filter(|&&edge| edge <= 90.0).count(),
                phi: Edges::new(&grid.phi_r_edges_deg),
                by_cosine: RowsByCosine::new(&grid.theta_r_edges_deg),
            },
            GridKind::Arm => {
                let phi = |&t: &f64| grid.phi_r_deg.iter().map(move |&p| (t, p)).collect::<Vec<_>>();
                Self::arm(grid, grid.theta_r_deg.iter().flat_map(phi))
            }
            GridKind::Points => Self::arm(grid, grid.points_deg.iter().map(|&[t, p]| (t, p))),
            GridKind::Patches => Sensor::Patches(grid.patches_deg.clone()),
            // The sensor moves with the light: no direction falls into a bin of its own.
            GridKind::HalfDifference => Sensor::Patches(vec![]),
        }
    }

    fn arm(grid: &Grid, positions: impl Iterator<Item = (f64, f64)>) -> Self {
        let half_angle = grid.aperture_deg.unwrap_or(0.0).to_radians();
        let mut caps: Vec<Cap> = positions
            .enumerate()
            .map(|(bin, (theta, phi))| Cap {
                theta: theta.abs().to_radians(),
                axis: sphere::direction_deg(theta, phi),
                bin,
            })
            .collect();
        caps.sort_by(|a, b| a.theta.total_cmp(&b.theta));
        let chord = 2.0 * (0.5 * half_angle).sin();
        Sensor::Arm { caps, chord2: chord * chord, reach: half_angle + 1e-12 }
    }

    /// The axes of the apertures and their half-angle (rad) with a margin for rounding; `None` for bins of
    /// another shape.
    pub fn cones(&self) -> Option<(impl Iterator<Item = DVec3>, f64)> {
        match self {
            Sensor::Hemisphere { .. } | Sensor::Patches(_) => None,
            Sensor::Arm { caps, reach, .. } => Some((caps.iter().map(|cap| cap.axis), *reach)),
        }
    }

    /// Whether any bin holds `wo`, a unit vector.
    pub fn sees(&self, wo: DVec3) -> bool {
        let mut seen = false;
        self.each_bin(wo, |_| seen = true);
        seen
    }

    /// Calls `visit(bin, false)` for every bin that holds `wo`, and `visit(bin, true)` for every one that holds its
    /// `image`, the mirror image about the plane at the azimuth of half `about_deg`, in [0, 720).
    // Tested by `images_fall_where_they_fall_alone`.
    pub fn each_bin_of_both(
        &self,
        wo: DVec3,
        image: DVec3,
        about_deg: f64,
        mut visit: impl FnMut(usize, bool),
    ) {
        if let Sensor::Hemisphere { theta, above, phi, by_cosine } = self {
            let Some(row) = row(wo, theta, *above, by_cosine) else { return };
            let (first, azimuth) = (row * phi.len(), quick_atan2_deg(wo.y, wo.x));
            let turned = about_deg - azimuth;
            let mirrored = if turned < 0.0 { turned + 360.0 } else { turned % 360.0 };
            visit(first + column(wo, azimuth, phi), false);
            visit(first + column(image, mirrored, phi), true);
        } else {
            self.each_bin(wo, |bin| visit(bin, false));
            self.each_bin(image, |bin| visit(bin, true));
        }
    }

    /// Calls `visit(bin)` for every bin that holds `wo`, a unit vector.
    pub fn each_bin(&self, wo: DVec3, mut visit: impl FnMut(usize)) {
        match self {
            Sensor::Hemisphere { theta, above, phi, by_cosine } => {
                let Some(row) = row(wo, theta, *above, by_cosine) else { return };
                let azimuth = quick_atan2_deg(wo.y, wo.x);
                visit(row * phi.len() + column(wo, azimuth, phi));
            }
            Sensor::Arm { caps, chord2, reach } => {
                // Which caps come into question; the chord decides.
                let (polar, reach) = (near_polar_deg(wo).to_radians(), reach + QUICK_ERROR.to_radians());
                let first = caps.partition_point(|cap| cap.theta < polar - reach);
                for cap in caps[first..].iter().take_while(|cap| cap.theta <= polar + reach) {
                    if cap.axis.distance_squared(wo) <= *chord2 {
                        visit(cap.bin);
                    }
                }
            }
            Sensor::Patches(patches) => {
                // An angle of 90 degrees is the rounding of one just off it, on the side that wo.z says; the pole below
                // belongs to the patches that end there.
                let theta = sphere::theta(wo).to_degrees();
                let theta = if wo.z > 0.0 {
                    theta.min(90.0f64.next_down())
                } else {
                    theta.clamp(90.0, 180.0f64.next_down())
                };
                let phi = sphere::phi(wo).to_degrees();
                let holds = |&[t1, t2, p1, p2]: &[f64; 4]| {
                    let phi = p1 + (phi - p1).rem_euclid(360.0);
                    t1 <= theta && theta < t2 && phi < p2
                };
                patches.iter().enumerate().filter(|(_, patch)| holds(patch)).for_each(|(bin, _)| visit(bin));
            }
        }
    }
}

/// Which row holds directions of a cosine, where one row holds all of about that cosine.
#[derive(Debug, Clone)]
pub struct RowsByCosine(Vec<u16>);

/// Ranges of equal width that the cosines above the horizon are parted into, and those below.
const COSINES: usize = 2048;
/// No row holds all of a range.
const SEVERAL: u16 = u16::MAX;
/// What the angle of a vector, of unit length to 1e-11, and the arc cosine of its z are apart at most where ranges end, in
/// degrees: 1e-11 cot(theta), and theta >= acos(1 - 1/2048) there but at the poles, where no edge is near.
const COSINE_ERROR: f64 = 1e-6;

impl RowsByCosine {
    fn new(edges: &[f64]) -> Self {
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
fn near_polar_deg(wo: DVec3) -> f64 {
    quick_atan2_deg((wo.x * wo.x + wo.y * wo.y).sqrt(), wo.z)
}

/// The row that holds `wo`, of which `above` lie above the horizon; `None` where those of its hemisphere are none.
fn row(wo: DVec3, theta: &Edges, above: usize, by_cosine: &RowsByCosine) -> Option<usize> {
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

/// The column of a hemisphere that holds `wo`, whose azimuth is about `near`, in [0, 360) degrees.
fn column(wo: DVec3, near: f64, phi: &Edges) -> usize {
    phi.find_quickly(reduced(near, phi), || reduced(sphere::phi(wo).to_degrees(), phi))
}

/// Bound on the error of `quick_atan2_deg`, degrees.
const QUICK_ERROR: f64 = 2e-3;

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
fn reduced(phi: f64, edges: &Edges) -> f64 {
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

    fn centred() -> Grid {
        Grid {
            kind: GridKind::Hemisphere,
            theta_i_deg: vec![0.0],
            phi_i_deg: vec![0.0],
            phi_r_relative: true,
            theta_r_edges_deg: vec![0.0, 2.5, 7.5, 85.0, 90.0],
            phi_r_edges_deg: (0..=36).map(|k| 10.0 * f64::from(k) - 5.0).collect(),
            ..Grid::default()
        }
    }

    fn bins(sensor: &Sensor, theta_deg: f64, phi_deg: f64) -> Vec<usize> {
        let mut found = vec![];
        sensor.each_bin(sphere::direction_deg(theta_deg, phi_deg), |bin| found.push(bin));
        found
    }

    #[test]
    fn every_direction_falls_between_the_edges_of_its_bin() {
        let sensor = Sensor::new(&centred());
        assert_eq!(bins(&sensor, 0.0, 0.0), [0]);
        assert_eq!(bins(&sensor, 5.0, 356.0), [36]);
        assert_eq!(bins(&sensor, 5.0, 354.0), [36 + 35]);
        assert_eq!(bins(&sensor, 5.0, 180.0), [36 + 18]);
        assert_eq!(bins(&sensor, 89.999_999, 4.0), [3 * 36]);
    }

    #[test]
    fn each_hemisphere_has_rows_of_its_own() {
        let with = |edges: &[f64]| Sensor::new(&Grid { theta_r_edges_deg: edges.to_vec(), ..centred() });
        let both = with(&[0.0, 45.0, 90.0, 135.0, 180.0]);
        let rows =
            |sensor: &Sensor, theta| bins(sensor, theta, 0.0).iter().map(|bin| bin / 36).collect::<Vec<_>>();
        for (theta, row) in
            [(1.0, 0), (89.999_999_999, 1), (90.000_000_001, 2), (134.0, 2), (135.1, 3), (180.0, 3)]
        {
            assert_eq!(rows(&both, theta), [row], "{theta}");
        }
        // Angles that round to 90 degrees: the sign of z decides.
        for (z, row) in [(1e-300, 1), (-1e-300, 2)] {
            let mut found = vec![];
            both.each_bin(DVec3::new(1.0, 0.0, z), |bin| found.push(bin / 36));
            assert_eq!(found, [row]);
        }
        assert!(rows(&with(&[0.0, 45.0, 90.0]), 120.0).is_empty());
        assert!(rows(&with(&[90.0, 135.0, 180.0]), 60.0).is_empty());
        assert_eq!(rows(&with(&[90.0, 135.0, 180.0]), 100.0), [0]);
    }

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
    fn images_fall_where_they_fall_alone() {
        for grid in [centred(), Grid { phi_r_edges_deg: vec![-180.0, -90.0, 10.0, 180.0], ..centred() }] {
            let sensor = Sensor::new(&grid);
            for (k, azimuth_i) in (0..4000).map(|k| (k, f64::from(k % 25) * 15.0)) {
                let wo = sphere::direction_deg(f64::from(k) * 0.0223 + 0.01, f64::from(k) * 17.31);
                let mirrored =
                    sphere::turned(DVec3::new(wo.x, -wo.y, wo.z), sphere::sin_cos_deg(2.0 * azimuth_i));
                let (mut both, mut alone) = (vec![], vec![]);
                let about_deg = 2.0 * sphere::reduced_deg(azimuth_i);
                sensor.each_bin_of_both(wo, mirrored, about_deg, |bin, _| both.push(bin));
                [wo, mirrored].into_iter().for_each(|wo| sensor.each_bin(wo, |bin| alone.push(bin)));
                assert_eq!(both, alone, "{wo} under {azimuth_i}");
            }
        }
    }

    #[test]
    fn the_quick_way_finds_the_bins_of_the_exact_angles() {
        let sensor = Sensor::new(&centred());
        let Sensor::Hemisphere { theta, phi, .. } = &sensor else { panic!("a hemisphere") };
        // Directions on edges, a rounding beside them, and between them.
        let edges = [0.0, 2.5, 7.5, 85.0, 90.0 - 1e-9, 1.0, 33.3];
        let azimuths = (0..720).map(|k| f64::from(k) * 0.5);
        for (polar, azimuth) in edges.into_iter().flat_map(|p| azimuths.clone().map(move |a| (p, a))) {
            for nudge in [-1e-3, -1e-12, 0.0, 1e-12, 1e-3] {
                let wo = sphere::direction_deg(polar, azimuth + nudge);
                let row = theta.find(sphere::theta(wo).to_degrees());
                let column = phi.find(reduced(sphere::phi(wo).to_degrees(), phi));
                let mut found = vec![];
                sensor.each_bin(wo, |bin| found.push(bin));
                assert_eq!(found, [row * phi.len() + column], "{polar} {azimuth} {nudge}");
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

    #[test]
    fn apertures_may_overlap_and_may_miss() {
        let arm = Grid {
            kind: GridKind::Arm,
            theta_r_edges_deg: vec![],
            phi_r_edges_deg: vec![],
            theta_r_deg: vec![-30.0, 0.0, 30.0, 32.0],
            phi_r_deg: vec![180.0],
            aperture_deg: Some(1.5),
            ..centred()
        };
        let sensor = Sensor::new(&arm);
        assert_eq!(bins(&sensor, 31.0, 180.0), [2, 3]);
        assert_eq!(bins(&sensor, 30.0, 0.0), [0]);
        assert_eq!(bins(&sensor, 0.5, 77.0), [1]);
        assert!(bins(&sensor, 60.0, 180.0).is_empty());
    }
}
