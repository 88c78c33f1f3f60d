//! Surface samples on grains, in proportion to what each half-sphere and the plane show the light by themselves.
//!
//! All half-spheres are alike, so that the samples of a block go in equal steps from grain to grain while their normals
//! follow an even sequence: a bin, which is a range of normals, gets its share of them. Those that another grain buries
//! are no part of the surface.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use rand_pcg::Pcg64Dxsm;

use super::point::GrainPoint;
use super::ray::traverse;
use crate::rng::{PLASTIC, uniform};
use crate::surface::grains::GrainField;
use crate::trace::ray::surface_point::Outcome;
use crate::trace::sampling::half_sphere;
use crate::trace::sampling::systematic_steps::SystematicSteps;

/// The samples of a patch of grains towards one light.
pub struct GrainSampler<'a> {
    field: &'a GrainField,
    /// Canonical direction of the light in field coordinates.
    light: DVec3,
    /// What the plane, and one grain by itself, show the light.
    plane: f64,
    grain: f64,
}

impl<'a> GrainSampler<'a> {
    /// Of a half-sphere the light sees half of a disc and half of an ellipse: pi/2 (|light| + light.z).
    pub fn new(field: &'a GrainField, light: DVec3) -> Self {
        let (plane, grain) = (field.side().powi(2) * light.z, 0.5 * PI * (light.length() + light.z));
        GrainSampler { field, light, plane, grain }
    }

    fn total(&self) -> f64 {
        self.plane + self.grain * self.field.centres().len() as f64
    }

    /// The flux of one sample of a block of `count`, as a fraction of what falls on the patch.
    pub fn flux_fraction(&self, count: u64) -> f64 {
        self.total() / (self.plane * count as f64)
    }

    /// Calls `visit` with `count` samples of equal flux: the plane's first, then those of one grain after the other.
    // Tested by `samples_lie_on_grains_in_proportion_to_what_they_show`.
    pub fn each(&self, count: u64, rng: &mut Pcg64Dxsm, mut visit: impl FnMut(GrainPoint)) {
        let mut steps = SystematicSteps::new(count, self.total() / count as f64, uniform(rng));
        let mut next = even_points(rng);
        while steps.take(self.plane).is_some() {
            visit(GrainPoint::on_plane(next() * self.field.side()));
        }
        let light = self.light.normalize();
        for grain in 0..self.field.centres().len() {
            let last = grain + 1 == self.field.centres().len();
            // Rounding may leave a step beyond the sum: it belongs to the last grain.
            let end = if last { f64::INFINITY } else { self.plane + self.grain * (grain + 1) as f64 };
            while steps.take(end).is_some() {
                let normal = half_sphere::visible_normal(light, next().to_array());
                visit(GrainPoint::on_grain(self.field, grain as u32, normal));
            }
        }
        while steps.take(f64::INFINITY).is_some() {
            visit(GrainPoint::on_plane(next() * self.field.side()));
        }
    }
}

/// Points of the unit square, evenly, from a random first one.
fn even_points(rng: &mut Pcg64Dxsm) -> impl FnMut() -> DVec2 {
    let mut point = DVec2::new(uniform(rng), uniform(rng));
    move || {
        point = (point + DVec2::from_array(PLASTIC)).fract();
        point
    }
}

/// Rays of the light from the level of the tops, evenly over the patch: what they meet first is lit, each with the same
/// flux.
pub struct RaysFromAbove<'a> {
    /// The grains.
    pub field: &'a GrainField,
    /// Canonical direction of the light in field coordinates.
    pub light: DVec3,
}

impl RaysFromAbove<'_> {
    /// Calls `visit` with what each of `count` rays meets.
    pub fn each(&self, count: u64, rng: &mut Pcg64Dxsm, mut visit: impl FnMut(Outcome<GrainPoint>)) {
        let mut next = even_points(rng);
        for _ in 0..count {
            let at = self.field.on_patch(next() * self.field.side());
            let top = GrainPoint { z: self.field.up().max(0.0), ..GrainPoint::on_plane(at) };
            visit(traverse(self.field, self.field.up(), &top, -self.light));
        }
    }
}
