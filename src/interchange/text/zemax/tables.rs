//! The tables of a Zemax file as a function of two directions.

use glam::DVec3;

use crate::interchange::radiance::colour;
use crate::interchange::resample::interval::{around, interval};
use crate::interchange::{Brdf, Colour};
use crate::sphere;

/// The mirror direction of light at `theta` in the plane of x and z, the direction towards the normal, and across.
pub(crate) fn frame(theta: f64) -> [DVec3; 3] {
    let (sin, cos) = theta.sin_cos();
    [DVec3::new(-sin, 0.0, cos), DVec3::new(cos, 0.0, sin), DVec3::Y]
}

/// The direction at these angles, degrees, about a frame.
pub(crate) fn about([mirror, up, across]: [DVec3; 3], azimuth: f64, radial: f64) -> DVec3 {
    let ((sin_a, cos_a), (sin_r, cos_r)) = (sphere::sin_cos_deg(azimuth), sphere::sin_cos_deg(radial));
    cos_r * mirror + sin_r * (cos_a * up + sin_a * across)
}

/// The rotation of the sample that brings light at this azimuth to 0, and the other way round.
pub(crate) fn rotation_deg(phi_deg: f64) -> f64 {
    sphere::reduced_deg(-phi_deg)
}

/// The tables of a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Zemax {
    /// Of light that has gone through: directions are those that a mirror in the horizon shows.
    pub through: bool,
    /// The plane of incidence is a mirror: azimuths from 0 to 180, beyond as before.
    pub symmetric: bool,
    /// Increasing in [0, 360), as all that follow.
    pub rotations: Vec<f64>,
    /// Polar angles of the light.
    pub light: Vec<f64>,
    /// What is added at each of them to the polar angle of the mirror direction; empty for nothing. SSDD's, in Zemax
    /// files there is none.
    pub offsets: Vec<f64>,
    /// Angles about the mirror direction; where they are no mirror's, they go round.
    pub azimuths: Vec<f64>,
    /// Angles from the mirror direction.
    pub radials: Vec<f64>,
    /// Luminance, or X, Y and Z: \[rotation\]\[incidence\]\[azimuth\]\[radial\].
    pub values: Vec<Vec<f32>>,
    /// TIS by channel, \[rotation\]\[incidence\].
    pub tis: Vec<Vec<f64>>,
}

impl Zemax {
    /// Azimuths of the light, degrees; none where the file has one rotation.
    pub fn phi_i_deg(&self) -> Vec<f64> {
        if self.rotations.len() == 1 {
            return vec![];
        }
        let mut phi: Vec<f64> = self.rotations.iter().map(|&rotation| rotation_deg(rotation)).collect();
        phi.sort_by(f64::total_cmp);
        phi
    }

    /// R, G, B of a channel's values, and whether a part was negative.
    pub(crate) fn colour_of(&self, value: impl Fn(usize) -> f64) -> (Colour, bool) {
        if self.values.len() == 1 {
            return ([value(0); 3], false);
        }
        let xyz = [value(0), value(1), value(2)];
        (colour::rgb(xyz), colour::is_outside(xyz))
    }

    /// The value of a channel, linear between the file's angles, at a direction about the mirror direction.
    ///
    /// A zero at a node on or below the horizon is no value: a straight line towards it would darken what is above.
    /// Along the radial the last value above is held.
    // Tested by `a_lambertian_file_of_few_radials_is_lambertian` (tests/it/interchange/interchange_zemax.rs).
    pub(crate) fn value(
        &self,
        channels: &[Vec<f32>],
        light: ([usize; 2], f64),
        turn: ([usize; 2], f64),
        azimuth: f64,
        radial: f64,
    ) -> Colour {
        // Where the plane of incidence is a mirror, azimuths beyond half a turn are those before it.
        let azimuth = match self.symmetric {
            true => interval(&self.azimuths, if azimuth > 180.0 { 360.0 - azimuth } else { azimuth }),
            false => around(&self.azimuths, azimuth, 360.0),
        };
        let (axes, ([inner, outer], share)) = ([light, azimuth, turn], interval(&self.radials, radial));
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for corner in 0..8 {
            let side = |axis: usize| corner >> axis & 1;
            let part = |axis: usize| if side(axis) == 1 { axes[axis].1 } else { 1.0 - axes[axis].1 };
            let weight = part(0) * part(1) * part(2);
            if weight == 0.0 {
                continue;
            }
            let [l, a, t] = [0, 1, 2].map(|axis: usize| axes[axis].0[side(axis)]);
            let row = ((t * self.light.len() + l) * self.azimuths.len() + a) * self.radials.len();
            let none =
                |r: usize| channels.iter().all(|values| values[row + r] == 0.0) && !self.is_above(l, a, r);
            let share = match [none(inner), none(outer)] {
                [true, true] => continue,
                [false, true] => 0.0,
                [true, false] => 1.0,
                [false, false] => share,
            };
            for (s, values) in sum.iter_mut().zip(channels) {
                let [low, high] = [inner, outer].map(|r| f64::from(values[row + r]));
                *s += weight * ((1.0 - share) * low + share * high);
            }
            weights += weight;
        }
        if weights > 0.0 { sum.map(|s| s / weights) } else { sum }
    }

    /// The channels at a pair of directions.
    pub(crate) fn at(&self, channels: &[Vec<f32>], wi: DVec3, wo: DVec3) -> Colour {
        let (theta, phi) = (sphere::theta(wi), sphere::phi(wi));
        let light = interval(&self.light, theta.to_degrees());
        let [mirror, up, across] = frame(theta + self.offset(light).to_radians());
        let out = sphere::turned(wo, (-phi.sin(), phi.cos()));
        let local = DVec3::new(out.dot(up), out.dot(across), out.dot(mirror));
        let turn = around(&self.rotations, rotation_deg(phi.to_degrees()), 360.0);
        let (azimuth, radial) = (sphere::phi(local).to_degrees(), sphere::theta(local).to_degrees());
        self.value(channels, light, turn, azimuth, radial)
    }

    /// What is added to the polar angle of the mirror direction, degrees.
    fn offset(&self, ([low, high], share): ([usize; 2], f64)) -> f64 {
        let of = |light: usize| self.offsets.get(light).copied().unwrap_or(0.0);
        (1.0 - share) * of(low) + share * of(high)
    }

    /// Whether a node lies above the horizon, by more than rounding.
    fn is_above(&self, light: usize, azimuth: usize, radial: usize) -> bool {
        let (sin_i, cos_i) = sphere::sin_cos_deg(self.light[light] + self.offset(([light; 2], 0.0)));
        let (sin_r, cos_r) = sphere::sin_cos_deg(self.radials[radial]);
        cos_r * cos_i + sin_r * sphere::sin_cos_deg(self.azimuths[azimuth]).1 * sin_i > 1e-9
    }
}

impl Brdf for Zemax {
    fn colours(&self) -> usize {
        self.values.len()
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let found = self.at(&self.values, wi, wo);
        self.colour_of(|channel| found[channel]).0
    }
}
