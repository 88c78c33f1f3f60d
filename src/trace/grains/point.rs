//! Points of the surface of grains, or of pits.

use glam::{DVec2, DVec3};

use crate::surface::grains::GrainField;

/// A point of the surface of grains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrainPoint {
    /// Place on the patch, radii.
    pub at: DVec2,
    /// Height, radii; of pits below 0.
    pub z: f64,
    /// Canonical normal, a unit vector: from a grain's centre to the point, from the point to a pit's, or up.
    pub normal: DVec3,
    /// The grain; `None` on the bare plane.
    pub grain: Option<u32>,
}

impl GrainPoint {
    /// The point of a grain with this canonical normal.
    pub fn on_grain(field: &GrainField, grain: u32, normal: DVec3) -> Self {
        let from_centre = field.up() * normal;
        let at = field.on_patch(field.centres()[grain as usize] + from_centre.truncate());
        GrainPoint { at, z: from_centre.z, normal, grain: Some(grain) }
    }

    /// A point of the bare plane.
    pub fn on_plane(at: DVec2) -> Self {
        GrainPoint { at, z: 0.0, normal: DVec3::Z, grain: None }
    }

    /// The same point seen from the other side of the surface, in its frame.
    pub fn upside_down(&self) -> Self {
        let normal =
            if self.grain.is_some() { (-self.normal.truncate()).extend(self.normal.z) } else { self.normal };
        GrainPoint { z: -self.z, normal, ..*self }
    }

    /// Whether a grain lies over it.
    pub fn is_buried(&self, field: &GrainField) -> bool {
        field.buries(self.at, self.z, self.grain)
    }
}
