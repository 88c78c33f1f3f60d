//! Where both arms stand, and where errors of their angles and of the sample's tilt put them in the sample's frame.
//!
//! Directions near a nominal one are counted in degrees along the great circles that leave it (azimuthal equidistant):
//! along growing theta, and across. Unlike theta and phi these are regular at the normal.

use glam::{DQuat, DVec3};
use serde::Serialize;

use crate::campaign::{Azimuth, Campaign, SensorArm, Uncertainty};
use crate::instrument::grid_of;
use crate::sphere;

/// A pair of directions, degrees.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Position {
    /// Polar angle of the light.
    pub theta_i_deg: f64,
    /// Azimuth of the light on the stage; 0 where it is averaged.
    pub phi_i_deg: f64,
    /// Polar angle of the sensor, negative on the far side of its azimuth, beyond 90 below the surface.
    pub theta_r_deg: f64,
    /// Azimuth of the sensor on the stage; from the light where the light's is averaged.
    pub phi_r_deg: f64,
}

/// Errors of the light's theta and phi, of the sensor's, and of the sample's tilt about x and y; degrees.
pub type AngleErrors = [f64; 6];

/// A small move of the light along its theta and across, and of the sensor; degrees on great circles.
pub type Displacement = [f64; 4];

/// Size of the step of derivatives of exact geometry, degrees: the error of central differences is 1e-4^2/6 rad^2.
const GEOMETRY_STEP_DEG: f64 = 1e-3;

/// The pairs of directions of a budget.
pub fn positions(campaign: &Campaign, uncertainty: &Uncertainty) -> Vec<Position> {
    let averaged = campaign.light.azimuth == Azimuth::Relative;
    let SensorArm::Arm { theta_r_deg, phi_r_deg, .. } = &campaign.sensor else {
        let of = |&[theta_i_deg, phi_i, theta_r_deg, phi_r]: &[f64; 4]| {
            let phi_i_deg = if averaged { 0.0 } else { sphere::reduced_deg(phi_i) };
            let phi_r_deg = sphere::reduced_deg(if averaged { phi_r - phi_i } else { phi_r });
            Position { theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg }
        };
        return uncertainty.at_deg.iter().map(of).collect();
    };
    let grid = grid_of(campaign);
    let mut all = Vec::new();
    for incidence in 0..grid.incidences() {
        let (theta_i_deg, phi_i_deg) = grid.incidence_deg(incidence);
        let from = if grid.phi_r_relative { phi_i_deg } else { 0.0 };
        for &theta_r_deg in theta_r_deg {
            let of = |phi: &f64| Position { theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg: phi + from };
            all.extend(phi_r_deg.iter().map(of));
        }
    }
    all
}

impl Position {
    /// To the light, stage's frame.
    pub fn wi(&self) -> DVec3 {
        sphere::direction_deg(self.theta_i_deg, self.phi_i_deg)
    }

    /// To the sensor.
    pub fn wo(&self) -> DVec3 {
        sphere::direction_deg(self.theta_r_deg, self.phi_r_deg)
    }

    fn frames(&self) -> [[DVec3; 3]; 2] {
        [(self.theta_i_deg, self.phi_i_deg), (self.theta_r_deg, self.phi_r_deg)].map(frame)
    }

    /// The same, moved. What does not move keeps its angles to the last bit.
    // Tested by `a_move_and_its_inverse_agree` (tests/it/budget/geometry.rs).
    pub fn moved(&self, by: Displacement) -> Position {
        let [light, sensor] = self.frames();
        let angles = |w: DVec3| (sphere::theta(w).to_degrees(), sphere::phi(w).to_degrees());
        let mut moved = *self;
        if by[..2] != [0.0, 0.0] {
            (moved.theta_i_deg, moved.phi_i_deg) = angles(leave(light, [by[0], by[1]]));
        }
        if by[2..] != [0.0, 0.0] {
            (moved.theta_r_deg, moved.phi_r_deg) = angles(leave(sensor, [by[2], by[3]]));
        }
        moved
    }

    /// Where errors put the arms in the sample's frame: exact. A sample turned by t about an axis sees all directions
    /// turned by -t.
    pub fn displacement(&self, errors: &AngleErrors) -> Displacement {
        let [light_theta, light_phi, sensor_theta, sensor_phi, tilt_x, tilt_y] = *errors;
        let wi = sphere::direction_deg(self.theta_i_deg + light_theta, self.phi_i_deg + light_phi);
        let wo = sphere::direction_deg(self.theta_r_deg + sensor_theta, self.phi_r_deg + sensor_phi);
        let turn = DQuat::from_scaled_axis(-DVec3::new(tilt_x.to_radians(), tilt_y.to_radians(), 0.0));
        let [light, sensor] = self.frames();
        let ([a, b], [c, d]) = (seen_from(light, turn * wi), seen_from(sensor, turn * wo));
        [a, b, c, d]
    }

    /// d displacement/d error of the angle at `place` of [`AngleErrors`].
    pub fn displacement_slope(&self, place: usize) -> Displacement {
        let at = |size: f64| {
            let mut errors = [0.0; 6];
            errors[place] = size;
            self.displacement(&errors)
        };
        let (plus, minus) = (at(GEOMETRY_STEP_DEG), at(-GEOMETRY_STEP_DEG));
        std::array::from_fn(|k| (plus[k] - minus[k]) / (2.0 * GEOMETRY_STEP_DEG))
    }

    /// Degrees that both arms keep from the horizon, the half-angles of their cones taken off; negative beyond it.
    pub fn room_deg(&self, cone_deg: f64, aperture_deg: f64) -> f64 {
        let of = |theta: f64, half_angle: f64| (90.0 - theta.abs()).abs() - half_angle;
        of(self.theta_i_deg, cone_deg).min(of(self.theta_r_deg, aperture_deg))
    }

    /// Whether both arms are on the same sides of the horizon as those of `nominal`.
    pub fn same_sides(&self, nominal: &Position) -> bool {
        let side = |theta: f64| theta.abs() < 90.0;
        side(self.theta_i_deg) && side(self.theta_r_deg) == side(nominal.theta_r_deg)
    }
}

/// A direction, that of growing theta, and that across.
fn frame((theta_deg, phi_deg): (f64, f64)) -> [DVec3; 3] {
    let (sin_theta, cos_theta) = sphere::sin_cos_deg(theta_deg);
    let (sin_phi, cos_phi) = sphere::sin_cos_deg(phi_deg);
    let along = DVec3::new(cos_theta * cos_phi, cos_theta * sin_phi, -sin_theta);
    [sphere::direction_deg(theta_deg, phi_deg), along, DVec3::new(-sin_phi, cos_phi, 0.0)]
}

fn leave([axis, along, across]: [DVec3; 3], [x, y]: [f64; 2]) -> DVec3 {
    let angle = x.hypot(y);
    let (sin, cos) = angle.to_radians().sin_cos();
    cos * axis + sin / angle * (x * along + y * across)
}

fn seen_from([axis, along, across]: [DVec3; 3], w: DVec3) -> [f64; 2] {
    let (x, y) = (w.dot(along), w.dot(across));
    let sin = x.hypot(y);
    let scale = if sin == 0.0 { 1.0 } else { sin.atan2(w.dot(axis)).to_degrees() / sin };
    [scale * x, scale * y]
}
