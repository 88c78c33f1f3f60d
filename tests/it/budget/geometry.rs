//! Promise: errors of angles and tilts move the arms in the sample's frame by exact geometry.

use gonio::budget::positions::Position;

const AT: Position = Position { theta_i_deg: 30.0, phi_i_deg: 0.0, theta_r_deg: 50.0, phi_r_deg: 180.0 };

/// Differences of a few roundings of angles in degrees.
const ROUNDING: f64 = 1e-12;

#[track_caller]
fn near(found: [f64; 4], wanted: [f64; 4], within: f64) {
    assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= within), "{found:?} {wanted:?}");
}

#[test]
fn a_move_and_its_inverse_agree() {
    // Along theta a great circle is theta itself.
    let moved = AT.moved([2.0, 0.0, -3.0, 0.0]);
    near(
        [moved.theta_i_deg, moved.phi_i_deg, moved.theta_r_deg, moved.phi_r_deg],
        [32.0, 0.0, 47.0, 180.0],
        1e-12,
    );
    // Errors that lead to where a move leads are that move, in any direction, at the normal too.
    let places = [AT, Position { theta_i_deg: 0.0, theta_r_deg: -20.0, phi_r_deg: 35.0, ..AT }];
    for at in places {
        for by in [[0.5, -0.25, 1.0, 2.0], [0.0, 3.0, 0.0, -1.0], [-2.0, 0.0, 0.125, 0.0]] {
            let moved = at.moved(by);
            let sign = if at.theta_r_deg < 0.0 { 180.0 } else { 0.0 };
            let errors = [
                moved.theta_i_deg - at.theta_i_deg,
                moved.phi_i_deg - at.phi_i_deg,
                // The far side is written as a negative angle of the nominal azimuth.
                if sign > 0.0 {
                    -moved.theta_r_deg - at.theta_r_deg
                } else {
                    moved.theta_r_deg - at.theta_r_deg
                },
                moved.phi_r_deg + sign - at.phi_r_deg,
                0.0,
                0.0,
            ];
            near(at.displacement(&errors), by, ROUNDING.max(1e-11));
        }
    }
}

/// A sample turned by t about +y sees light in the plane of x and z at theta - t on the side of +x, at theta + t on the
/// other; across, an azimuth counts sin(theta) of itself.
#[test]
fn tilts_turn_both_arms() {
    near(AT.displacement(&[0.0, 0.0, 0.0, 0.0, 0.0, 1.5]), [-1.5, 0.0, 1.5, 0.0], ROUNDING);
    near(AT.displacement_slope(5), [-1.0, 0.0, 1.0, 0.0], 1e-9);
    // Turned about +x by t the sample sees w.y grow by t w.z; across, the light's circle points to +y, the sensor's to -y.
    let (cos_i, cos_r) = (30f64.to_radians().cos(), 50f64.to_radians().cos());
    near(AT.displacement_slope(4), [0.0, cos_i, 0.0, -cos_r], 1e-7);
    let sin_i = 30f64.to_radians().sin();
    // Central differences of 1e-3 degrees: an error of about (1e-3 degrees)^2/6 = 5e-11.
    near(AT.displacement_slope(1), [0.0, sin_i, 0.0, 0.0], 1e-9);
    near(AT.displacement_slope(2), [0.0, 0.0, 1.0, 0.0], 1e-9);
}
