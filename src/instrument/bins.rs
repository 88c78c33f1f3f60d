//! The sensor: which bins a direction falls into.

use glam::DVec3;

use super::bin_edges::{ColumnsByAzimuth, Edges, QUICK_ERROR, RowsByCosine, column, near_polar_deg, row};
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
        /// Columns by the azimuth.
        by_azimuth: ColumnsByAzimuth,
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

impl Sensor {
    /// The sensor of a grid.
    pub fn new(grid: &Grid) -> Self {
        match grid.kind {
            GridKind::Hemisphere => {
                let phi = Edges::new(&grid.phi_r_edges_deg);
                Sensor::Hemisphere {
                    theta: Edges::new(&grid.theta_r_edges_deg),
                    above: grid.theta_r_edges_deg[1..].iter().filter(|&&edge| edge <= 90.0).count(),
                    by_cosine: RowsByCosine::new(&grid.theta_r_edges_deg),
                    by_azimuth: ColumnsByAzimuth::new(&phi),
                    phi,
                }
            }
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
    /// `image`, the mirror image about an upright plane.
    // Tested by `images_fall_where_they_fall_alone`.
    pub fn each_bin_of_both(&self, wo: DVec3, image: DVec3, mut visit: impl FnMut(usize, bool)) {
        if let Sensor::Hemisphere { theta, above, phi, by_cosine, by_azimuth } = self {
            let Some(row) = row(wo, theta, *above, by_cosine) else { return };
            let first = row * phi.len();
            visit(first + column(wo, phi, by_azimuth), false);
            visit(first + column(image, phi, by_azimuth), true);
        } else {
            self.each_bin(wo, |bin| visit(bin, false));
            self.each_bin(image, |bin| visit(bin, true));
        }
    }

    /// Calls `visit(bin)` for every bin that holds `wo`, a unit vector.
    pub fn each_bin(&self, wo: DVec3, mut visit: impl FnMut(usize)) {
        match self {
            Sensor::Hemisphere { theta, above, phi, by_cosine, by_azimuth } => {
                let Some(row) = row(wo, theta, *above, by_cosine) else { return };
                visit(row * phi.len() + column(wo, phi, by_azimuth));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instrument::bin_edges::reduced;

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
    fn images_fall_where_they_fall_alone() {
        for grid in [centred(), Grid { phi_r_edges_deg: vec![-180.0, -90.0, 10.0, 180.0], ..centred() }] {
            let sensor = Sensor::new(&grid);
            for (k, azimuth_i) in (0..4000).map(|k| (k, f64::from(k % 25) * 15.0)) {
                let wo = sphere::direction_deg(f64::from(k) * 0.0223 + 0.01, f64::from(k) * 17.31);
                let mirrored =
                    sphere::turned(DVec3::new(wo.x, -wo.y, wo.z), sphere::sin_cos_deg(2.0 * azimuth_i));
                let (mut both, mut alone) = (vec![], vec![]);
                sensor.each_bin_of_both(wo, mirrored, |bin, _| both.push(bin));
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
