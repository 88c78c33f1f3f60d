//! What an instrument's receptor collects: how much of the light in each direction.

use std::f64::consts::PI;

use glam::DVec3;

use crate::sphere;

/// The field of a receptor.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Field {
    /// A slit: tangents of half its angles, in the plane of incidence and across, and of half those of the source's image.
    Slit { half: [f64; 2], image: [f64; 2] },
    /// A cone; cosine of its half-angle.
    Cone { cos: f64 },
    /// All azimuths between two polar angles, radians.
    Ring { theta: [f64; 2] },
}

/// A receptor on its axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Receptor {
    axis: DVec3,
    /// Unit vectors in the plane of incidence, towards larger polar angles, and across.
    along: DVec3,
    across: DVec3,
    field: Field,
    /// Its full angles in the plane of incidence and across, degrees.
    size_deg: [f64; 2],
    /// Directions farther from the axis than this get nothing, radians.
    reach: f64,
    /// Steps in which the field is resolved, radians.
    step: f64,
}

impl Receptor {
    /// A rectangular field stop of these full angles (in the plane of incidence, across; degrees) about the direction at
    /// `theta_deg` in the plane at azimuth `phi_deg`, and a source whose mirror image there takes `image_deg`.
    ///
    /// Light of each point of the source makes its lobe about its own mirror direction: the field that one collimated beam
    /// sees is the field stop smeared by the image, 1 where the whole image would pass and 0 where nothing would. Both are rectangles
    /// of the plane that touches the sphere at the axis, as of a field stop in the focal plane of a lens.
    // Tested by `gloss_is_the_direct_quadrature_over_source_and_receptor` (tests/it/appearance/gloss.rs).
    pub fn slit([theta_deg, phi_deg]: [f64; 2], size_deg: [f64; 2], image_deg: [f64; 2]) -> Self {
        let tangents = |angles: [f64; 2]| angles.map(|full| (0.5 * full).to_radians().tan());
        let (half, image) = (tangents(size_deg), tangents(image_deg));
        let reach = (half[0] + image[0]).hypot(half[1] + image[1]).atan();
        let finest = |k: usize| (half[k] / 20.0).min(if image[k] > 0.0 { image[k] / 4.0 } else { half[k] });
        let step = finest(0).min(finest(1));
        Receptor { reach, step, ..Self::about([theta_deg, phi_deg], Field::Slit { half, image }, size_deg) }
    }

    /// A cone of this half-angle.
    pub fn cone(at_deg: [f64; 2], half_angle_deg: f64) -> Self {
        let reach = half_angle_deg.to_radians();
        let field = Field::Cone { cos: reach.cos() };
        Receptor { reach, step: reach / 40.0, ..Self::about(at_deg, field, [2.0 * half_angle_deg; 2]) }
    }

    /// A ring about the normal, `from_deg` to `to_deg` in polar angle.
    pub fn ring(from_deg: f64, to_deg: f64) -> Self {
        let theta = [from_deg.to_radians(), to_deg.to_radians()];
        let (size_deg, step) = ([to_deg - from_deg, 360.0], (theta[1] - theta[0]) / 40.0);
        Receptor { reach: PI, step, ..Self::about([0.0, 0.0], Field::Ring { theta }, size_deg) }
    }

    fn about([theta_deg, phi_deg]: [f64; 2], field: Field, size_deg: [f64; 2]) -> Self {
        Receptor {
            axis: sphere::direction_deg(theta_deg, phi_deg),
            along: sphere::direction_deg(theta_deg + 90.0, phi_deg),
            across: sphere::direction_deg(90.0, phi_deg + 90.0),
            field,
            size_deg,
            reach: 0.0,
            step: 0.0,
        }
    }

    /// The share of the light in a direction that is collected, [0, 1].
    pub fn share(&self, wo: DVec3) -> f64 {
        match self.field {
            Field::Slit { half, image } => {
                let ahead = wo.dot(self.axis);
                if ahead <= 0.0 {
                    return 0.0;
                }
                let [x, y] = [self.along, self.across].map(|side| wo.dot(side) / ahead);
                passed(x, half[0], image[0]) * passed(y, half[1], image[1])
            }
            Field::Cone { cos } => f64::from(u8::from(wo.dot(self.axis) >= cos)),
            Field::Ring { theta: [from, to] } => {
                let theta = sphere::theta(wo);
                f64::from(u8::from(from <= theta && theta <= to))
            }
        }
    }

    /// Its full angles in the plane of incidence and across, degrees.
    pub fn size_deg(&self) -> [f64; 2] {
        self.size_deg
    }

    /// The direction in its middle.
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// Whether it is a cone, about whose axis a single aperture may stand for it.
    pub fn is_cone(&self) -> bool {
        matches!(self.field, Field::Cone { .. })
    }

    /// Directions farther from the axis than this get nothing, radians.
    pub(super) fn reach(&self) -> f64 {
        self.reach
    }

    /// Directions at polar angles beyond these get nothing, radians.
    pub(super) fn polar_range(&self) -> [f64; 2] {
        let at = sphere::theta(self.axis);
        if let Field::Ring { theta } = self.field { theta } else { [at - self.reach, at + self.reach] }
    }

    /// Steps in which its field is resolved along the polar angle and the azimuth, radians: all azimuths of a ring are alike.
    pub(super) fn steps(&self) -> [f64; 2] {
        [self.step, if matches!(self.field, Field::Ring { .. }) { f64::INFINITY } else { self.step }]
    }
}

/// The part of an image of half-width `image` about `x` that passes a field stop of half-width `half`.
fn passed(x: f64, half: f64, image: f64) -> f64 {
    if image == 0.0 {
        return f64::from(u8::from(x.abs() <= half));
    }
    let common = (x + image).min(half) - (x - image).max(-half);
    (common / (2.0 * image)).max(0.0)
}
