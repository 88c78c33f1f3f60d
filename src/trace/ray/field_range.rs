//! A field with its lowest and highest height: how far a ray can go before it is clear of everything.

use glam::DVec3;

use crate::surface::Heightfield;

/// A field and what bounds its rays.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FieldRange<'a> {
    pub field: &'a Heightfield,
    pub lowest: f64,
    pub highest: f64,
}

impl<'a> FieldRange<'a> {
    pub fn new(field: &'a Heightfield) -> Self {
        let (lowest, highest) = field.range();
        FieldRange { field, lowest, highest }
    }

    /// Ray parameter from which the ray is above every height.
    pub fn clear_at(&self, z: f64, dz: f64) -> f64 {
        if dz > 0.0 {
            (self.highest - z) / dz
        } else if dz == 0.0 && z >= self.highest {
            0.0
        } else {
            f64::INFINITY
        }
    }

    /// Largest number of cells that a ray from height `z` along `d` can cross between the highest and the lowest
    /// height; a level ray is bounded by the field.
    pub fn step_limit(&self, z: f64, d: DVec3) -> u64 {
        let height = if d.z >= 0.0 { self.highest - z } else { z - self.lowest };
        let crossed = height / d.z.abs() * (d.x.abs() + d.y.abs());
        // Rounding of the last edges: a handful of cells. Casts saturate. A level ray over a periodic field has met
        // every cell after cells x diagonal steps.
        let (nx, ny) = (self.field.cells_x() as u64, self.field.cells_y() as u64);
        if crossed.is_finite() { (crossed as u64).saturating_add(8) } else { nx * ny * (nx + ny) }
    }
}
