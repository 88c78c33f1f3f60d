//! What a bin covers: a part of the hemisphere at an incidence, the same for the tally (direction -> bin) and for the theory
//! (mean over the bin).

use glam::DVec3;

use super::grid::{Grid, GridKind};
use crate::sphere;

/// One sensor bin as a part of one hemisphere, in the stage's frame, radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Region {
    /// theta in [lower, upper), phi in [lower, upper); phi may start below 0 or end above 2 pi.
    Rectangle {
        /// Polar angle, [lower, upper].
        theta: [f64; 2],
        /// Azimuth, [lower, upper].
        phi: [f64; 2],
    },
    /// The cone of `half_angle` about `axis`, wholly above the horizon or below it.
    Cap {
        /// Unit vector.
        axis: DVec3,
        /// Half-angle.
        half_angle: f64,
    },
}

impl Region {
    /// Integral of |cos(theta)| over the region, sr.
    ///
    /// Rectangle: dphi |sin^2 t2 - sin^2 t1|/2 = dphi |sin(t2 + t1) sin(t2 - t1)|/2. Cap: pi sin^2(a) |axis.z|.
    /// Both forms are free of cancellation.
    // Tested by `projected_solid_angles_sum_to_pi`, `a_cap_is_a_projected_disc`.
    pub fn projected_solid_angle(&self) -> f64 {
        match *self {
            Region::Rectangle { theta: [t1, t2], phi: [p1, p2] } => {
                0.5 * (p2 - p1) * ((t2 + t1).sin() * (t2 - t1).sin()).abs()
            }
            Region::Cap { axis, half_angle } => {
                std::f64::consts::PI * half_angle.sin().powi(2) * axis.z.abs()
            }
        }
    }

    /// Whether it lies below the horizon: where light goes that has gone through the surface.
    pub fn is_below(&self) -> bool {
        match self {
            Region::Rectangle { theta: [t1, _], .. } => *t1 >= HORIZON,
            Region::Cap { axis, .. } => axis.z < 0.0,
        }
    }

    /// The direction in the middle, a unit vector.
    pub fn middle(&self) -> DVec3 {
        match *self {
            Region::Rectangle { theta, phi } => {
                sphere::direction(0.5 * (theta[0] + theta[1]), 0.5 * (phi[0] + phi[1]))
            }
            Region::Cap { axis, .. } => axis,
        }
    }
}

/// 90 degrees as edges of bins have it.
const HORIZON: f64 = std::f64::consts::FRAC_PI_2;

impl Grid {
    /// Projected solid angle of each bin at an incidence, sr.
    pub fn sizes(&self, incidence: usize) -> Vec<f64> {
        self.regions(incidence).iter().map(Region::projected_solid_angle).collect()
    }

    /// The bins as seen at an incidence, in the stage's frame.
    pub fn regions(&self, incidence: usize) -> Vec<Region> {
        let origin_deg = if self.phi_r_relative { self.incidence_deg(incidence).1 } else { 0.0 };
        match self.kind {
            GridKind::Hemisphere => self.rectangles(origin_deg),
            GridKind::Arm => {
                let positions =
                    self.theta_r_deg.iter().flat_map(|&t| self.phi_r_deg.iter().map(move |&p| [t, p]));
                self.caps(positions, origin_deg)
            }
            GridKind::Patches => self.patches(origin_deg),
            GridKind::Points => self.caps(self.points_deg.iter().copied(), origin_deg),
            GridKind::HalfDifference => {
                let cap = |bin| Region::Cap { axis: self.arms_of_half(incidence, bin).1, half_angle: 0.0 };
                (0..self.bins()).map(cap).collect()
            }
        }
    }

    fn patches(&self, origin_deg: f64) -> Vec<Region> {
        let region = |&[t1, t2, p1, p2]: &[f64; 4]| Region::Rectangle {
            theta: [t1.to_radians(), t2.to_radians()],
            phi: [(p1 + origin_deg).to_radians(), (p2 + origin_deg).to_radians()],
        };
        self.patches_deg.iter().map(region).collect()
    }

    fn rectangles(&self, origin_deg: f64) -> Vec<Region> {
        let radians =
            |pair: &[f64], shift: f64| [(pair[0] + shift).to_radians(), (pair[1] + shift).to_radians()];
        let columns = |theta: &[f64]| {
            let theta = radians(theta, 0.0);
            self.phi_r_edges_deg
                .windows(2)
                .map(move |phi| Region::Rectangle { theta, phi: radians(phi, origin_deg) })
                .collect::<Vec<_>>()
        };
        self.theta_r_edges_deg.windows(2).flat_map(columns).collect()
    }

    fn caps(&self, positions: impl Iterator<Item = [f64; 2]>, origin_deg: f64) -> Vec<Region> {
        let half_angle = self.aperture_deg.unwrap_or(0.0).to_radians();
        let cap = |[theta, phi]: [f64; 2]| Region::Cap {
            axis: sphere::direction_deg(theta, phi + origin_deg),
            half_angle,
        };
        positions.map(cap).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn projected_solid_angles_sum_to_pi() {
        let grid = Grid {
            kind: GridKind::Hemisphere,
            theta_i_deg: vec![0.0],
            phi_i_deg: vec![0.0],
            phi_r_relative: true,
            theta_r_edges_deg: vec![0.0, 2.5, 10.0, 60.0, 89.999, 90.0],
            phi_r_edges_deg: vec![-5.0, 5.0, 100.0, 355.0],
            ..Grid::default()
        };
        let sum: f64 = grid.regions(0).iter().map(Region::projected_solid_angle).sum();
        // 15 terms of size below pi, each right to a few ulp.
        assert!((sum - PI).abs() < 15.0 * 4.0 * f64::EPSILON, "{sum}");
    }

    #[test]
    fn a_cap_is_a_projected_disc() {
        let cap = Region::Cap { axis: DVec3::Z, half_angle: 0.3 };
        let ring = Region::Rectangle { theta: [0.0, 0.3], phi: [0.0, 2.0 * PI] };
        let (a, b) = (cap.projected_solid_angle(), ring.projected_solid_angle());
        assert!((a - b).abs() < 8.0 * f64::EPSILON, "{a} {b}");
    }
}
