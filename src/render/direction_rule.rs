//! What a table sends to the eye, as a rule of fixed directions.
//!
//! The table's light and the eye change places: by Helmholtz's reciprocity the radiance that the eye at `e` sees is the
//! integral of f(e, w) L(w) cos over the directions `w` of the light, of light that goes through with L/n^2 in place of
//! L. The rule's directions are those of a `Pattern`: mirror images (or refractions) of `e` at fixed normals, and even
//! ones. Their weights, f cos over the density, change slowly with `e`, as the lobe moves with the eye: they are found at nodes
//! and interpolated, while every direction is that of the eye itself.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use rayon::prelude::*;

use crate::interchange::resample::sampling::Pattern;
use crate::interchange::{Brdf, Colour, Lookup};
use crate::sphere;

/// Directions of each of the three kinds.
const COUNT: usize = 192;
/// Steps of the eye's polar angle, and of its azimuth where azimuths differ.
const POLAR: usize = 60;
const AROUND: usize = 72;
/// The last polar angle of the eye, rad: at the horizon it sees no area.
const LAST: f64 = 89.5 * PI / 180.0;

/// The rule.
pub struct DirectionRule<'a> {
    lookup: &'a Lookup,
    pattern: Pattern,
    /// Nodes of the azimuth: 1 where all are alike.
    around: usize,
    /// [polar][azimuth][direction]; the last of four is that of f = 1.
    weights: Vec<[f32; 4]>,
}

impl<'a> DirectionRule<'a> {
    /// The rule of a table, or of the light that has gone through it. `exchange`: whether both arms may change places, as light
    /// that comes back lets them.
    pub fn new(lookup: &'a Lookup, exchange: bool) -> Self {
        let pattern = Pattern::new(lookup.guide().lobe(), COUNT);
        let around = if lookup.is_isotropic() { 1 } else { AROUND };
        let weights = (0..(POLAR + 1) * around).into_par_iter().flat_map_iter(|node| {
            let theta = (FRAC_PI_2 * (node / around) as f64 / POLAR as f64).min(LAST);
            let eye = sphere::direction(theta, TAU * (node % around) as f64 / around as f64);
            of_eye(lookup, exchange, &pattern, eye)
        });
        DirectionRule { lookup, around, weights: weights.collect(), pattern }
    }

    /// Whether every azimuth of the eye is alike: then it is 0 in the frame of [`Self::seen`].
    pub fn is_isotropic(&self) -> bool {
        self.around == 1
    }

    /// The table.
    pub fn lookup(&self) -> &Lookup {
        self.lookup
    }

    /// The sum over the rule for an eye above the horizon: `arriving` is the light from a direction above it (as the table
    /// has it: of light that has gone through, in the mirror).
    // Tested by `a_lambert_sphere_in_an_even_light_is_as_bright_as_its_albedo` and its neighbours (tests/it/render.rs).
    pub fn seen(&self, eye: DVec3, arriving: impl Fn(DVec3) -> Colour) -> Colour {
        let (row, t) = place(sphere::theta(eye) / FRAC_PI_2 * POLAR as f64, POLAR - 1);
        let turn = if self.is_isotropic() { 0.0 } else { sphere::phi(eye) / TAU * self.around as f64 };
        let (column, s) = place(turn, self.around - 1);
        let count = self.pattern.len();
        let node = |r: usize, c: usize| {
            let first = ((row + r) * self.around + (column + c) % self.around) * count;
            &self.weights[first..first + count]
        };
        let corners = [
            (node(0, 0), (1.0 - t) * (1.0 - s)),
            (node(0, 1), (1.0 - t) * s),
            (node(1, 0), t * (1.0 - s)),
            (node(1, 1), t * s),
        ];
        let (mut sum, mut whole) = ([0.0; 3], 0.0);
        for k in 0..count {
            let Some(w) = self.pattern.onward(eye, k) else { continue };
            let light = arriving(w);
            let weight =
                |c: usize| corners.iter().map(|(node, share)| share * f64::from(node[k][c])).sum::<f64>();
            sum.iter_mut().enumerate().for_each(|(c, sum)| *sum += weight(c) * light[c]);
            whole += weight(3);
        }
        // The cosine itself is integrated exactly, so that an even BRDF in an even light is.
        sum.map(|sum| PI / whole * sum)
    }
}

/// The node below a place and how far it is from there; not beyond the node `last`.
fn place(at: f64, last: usize) -> (usize, f64) {
    let low = (at as usize).min(last);
    (low, (at - low as f64).min(1.0))
}

/// f cos over the density of every direction.
fn of_eye(lookup: &Lookup, exchange: bool, pattern: &Pattern, eye: DVec3) -> Vec<[f32; 4]> {
    let grey = lookup.colours() == 1;
    let weights = |k: usize| {
        let Some(w) = pattern.onward(eye, k) else { return [0.0; 4] };
        let f = if exchange { of_pair(lookup, eye, w) } else { lookup.brdf(eye, w) };
        let weight = pattern.weight(eye, w);
        [f[0], f[if grey { 0 } else { 1 }], f[if grey { 0 } else { 2 }], 1.0].map(|f| (weight * f) as f32)
    };
    (0..pattern.len()).map(weights).collect()
}

/// f of an eye and a light that comes back. Where the eye is beyond the table's last incidence and lower than the light, both
/// change places again.
pub fn of_pair(lookup: &Lookup, eye: DVec3, light: DVec3) -> Colour {
    let last = lookup.theta_i().last().copied().unwrap_or(0.0);
    if sphere::theta(eye) > last && light.z > eye.z {
        lookup.brdf(light, eye)
    } else {
        lookup.brdf(eye, light)
    }
}
