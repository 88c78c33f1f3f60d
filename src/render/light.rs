//! What lights the sphere.

use std::f64::consts::PI;

use glam::DVec3;

use super::sky::Sky;
use crate::interchange::Colour;
use crate::sphere;

/// Irradiance of a facet that faces the lamp: a white Lambert facet then shines with 1.
pub const LAMP: Colour = [PI; 3];
/// Polar angle and azimuth of the lamp and of the sky's bright place, degrees, where none are asked for.
pub const TOWARDS_DEG: [f64; 2] = [45.0, 0.0];

/// What is switched on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Light {
    /// The soft sky.
    Sky,
    /// The lamp alone.
    Lamp,
    /// Both.
    Both,
}

/// The light of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Lighting {
    /// Unit vector to the lamp.
    pub towards: DVec3,
    /// All directions.
    pub sky: Option<Sky>,
    /// The irradiance of a lamp far away.
    pub lamp: Option<Colour>,
}

impl Lighting {
    /// The light from polar angle and azimuth, degrees.
    pub fn new(light: Light, [theta_deg, phi_deg]: [f64; 2]) -> Self {
        let towards = sphere::direction_deg(theta_deg, phi_deg);
        Lighting {
            towards,
            sky: (light != Light::Lamp).then(|| Sky::soft(towards)),
            lamp: (light != Light::Sky).then_some(LAMP),
        }
    }

    /// What the eye sees beside the sphere: the sky, or the dark.
    pub fn behind(&self, w: DVec3) -> Colour {
        self.sky.as_ref().map_or([0.0; 3], |sky| sky.radiance(w))
    }
}
