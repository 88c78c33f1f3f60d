//! Grains as they lie on the stage.

use glam::{DVec2, DVec3};

use super::point::GrainPoint;
use super::ray::traverse;
use crate::surface::grains::GrainField;
use crate::trace::path::single::Traced;
use crate::trace::ray::surface_point::Outcome;
use crate::trace::symmetry::PatchSymmetry;

/// A patch of grains, its slope scales and which image of it lies there. World directions are in the sample's frame.
#[derive(Debug, Clone, Copy)]
pub struct TracedGrains<'a> {
    /// The grains.
    pub field: &'a GrainField,
    /// World slope per canonical slope.
    pub alpha: DVec2,
    /// Which mirror image of the field lies there.
    pub image: PatchSymmetry,
    /// Whether the plane between the grains is as the grains are; else light ends there.
    pub mirror_base: bool,
}

impl Traced for TracedGrains<'_> {
    type Point = GrainPoint;

    fn to_field(&self, w: DVec3) -> DVec3 {
        self.image.to_field(self.alpha * w.truncate()).extend(w.z)
    }

    fn slope(&self, place: &GrainPoint) -> DVec2 {
        -place.normal.truncate() / place.normal.z
    }

    fn normal(&self, place: &GrainPoint, _: bool) -> Option<DVec3> {
        if place.grain.is_none() && !self.mirror_base {
            return None;
        }
        let across = self.alpha * self.image.from_field(place.normal.truncate());
        Some(across.extend(place.normal.z))
    }

    fn other_side(&self, place: &GrainPoint) -> GrainPoint {
        place.upside_down()
    }

    fn traverse(&self, from: &GrainPoint, w: DVec3, below: bool) -> Outcome<GrainPoint> {
        // Grains seen from inside are pits, and pits are grains.
        let up = if below { -self.field.up() } else { self.field.up() };
        traverse(self.field, up, from, self.to_field(w))
    }
}
