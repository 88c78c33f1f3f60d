//! The soft sky: a smooth environment by formula, with a ground, a horizon and one bright place.
//!
//! # Formula
//!
//! L(w) = base + sum over steps of colour/(1 + exp((centre - w.axis)/width)), linear RGB, w a unit vector, z up. White is 1.
//! A step is a cap about `axis` whose edge lies at the cosine `centre` and is soft by `width`. The page is given these
//! numbers as they are, and a scene for another program a map of the values.

use glam::DVec3;
use serde::Serialize;

use crate::interchange::Colour;

/// A cap of the sphere with a soft edge.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SoftStep {
    /// Unit vector to its middle.
    pub axis: [f64; 3],
    /// Cosine at its edge, where half of the colour is left.
    pub centre: f64,
    /// Softness of the edge, in the cosine, > 0.
    pub width: f64,
    /// What it adds; below 0 where it takes away.
    pub colour: Colour,
}

/// An environment: radiances of all directions.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sky {
    /// Everywhere.
    pub base: Colour,
    /// What is added.
    pub steps: Vec<SoftStep>,
}

/// The ground, and what horizon and zenith add to the step before.
const GROUND: Colour = [0.11, 0.095, 0.08];
const HORIZON: SoftStep =
    SoftStep { axis: [0.0, 0.0, 1.0], centre: 0.0, width: 0.02, colour: [0.75, 0.765, 0.78] };
const ZENITH: SoftStep =
    SoftStep { axis: [0.0, 0.0, 1.0], centre: 0.45, width: 0.16, colour: [-0.62, -0.49, -0.18] };
/// The bright place: about 17 degrees wide to its edge.
const BRIGHT: SoftStep =
    SoftStep { axis: [0.0, 0.0, 1.0], centre: 0.955, width: 0.012, colour: [3.8, 3.5, 3.0] };

impl Sky {
    /// The soft sky with its bright place about the unit vector `towards`.
    pub fn soft(towards: DVec3) -> Self {
        let bright = SoftStep { axis: towards.to_array(), ..BRIGHT };
        Sky { base: GROUND, steps: vec![HORIZON, ZENITH, bright] }
    }

    /// The same radiance everywhere.
    pub fn even(base: Colour) -> Self {
        Sky { base, steps: vec![] }
    }

    /// The radiance from the direction of the unit vector `w`.
    // Tested by `every_direction_of_the_soft_sky_shines`, `a_step_is_half_at_its_edge`.
    pub fn radiance(&self, w: DVec3) -> Colour {
        self.steps.iter().fold(self.base, |mut sum, step| {
            let share =
                1.0 / (1.0 + ((step.centre - w.dot(DVec3::from_array(step.axis))) / step.width).exp());
            sum.iter_mut().zip(step.colour).for_each(|(sum, colour)| *sum += share * colour);
            sum
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::direction_deg;

    #[test]
    fn every_direction_of_the_soft_sky_shines() {
        let sky = Sky::soft(direction_deg(45.0, 0.0));
        for theta in 0..=60 {
            for phi in 0..24 {
                let w = direction_deg(3.0 * f64::from(theta), 15.0 * f64::from(phi));
                assert!(sky.radiance(w).into_iter().all(|radiance| radiance > 0.05), "{w}");
            }
        }
    }

    #[test]
    fn a_step_is_half_at_its_edge() {
        let step = SoftStep { axis: [0.0, 0.0, 1.0], centre: 0.5, width: 0.01, colour: [2.0, 4.0, 6.0] };
        let sky = Sky { base: [1.0; 3], steps: vec![step] };
        let at = |theta: f64| sky.radiance(direction_deg(theta, 30.0));
        // cos 60 is 0.5 to an ulp, which a width of 0.01 makes 1e-14 of the colour.
        assert!(at(60.0).iter().zip([2.0, 3.0, 4.0]).all(|(found, half)| (found - half).abs() < 1e-12));
        // exp(-50) on either side.
        assert!((at(0.0)[0] - 3.0).abs() < 1e-15 && (at(90.0)[0] - 1.0).abs() < 1e-15);
    }
}
