//! The plain cell traversal in f64: exact order, watertight, no epsilon. The reference for every faster kernel.
//!
//! A ray is followed from cell to cell. In a cell it crosses at most two facets, and which ones follows from the
//! edges by which it enters and leaves, without arithmetic. The clearance (ray height minus surface height) is
//! linear over a facet, so a facet is hit if and only if the clearance is negative where the ray leaves it; the
//! clearance on an edge is computed once and counts for both sides, so that no ray slips through a seam.
//! Coordinates are relative to the present cell; cells are integers.

use glam::DVec3;

use super::field_range::FieldRange;
use super::ray_state::RayState;
use super::surface_point::{Outcome, SurfacePoint};
use super::tile_peaks::TilePeaks;
use super::tile_traversal;
use crate::surface::Heightfield;

/// Traverses one field.
#[derive(Debug, Clone, Copy)]
pub struct GridTraversal<'a> {
    pub(crate) over: FieldRange<'a>,
    peaks: Option<&'a TilePeaks>,
}

/// Cells that a ray is followed through one by one before whole tiles are asked for: most rays end within them.
const NEAR: u64 = 64;

impl<'a> GridTraversal<'a> {
    /// A traversal over `field`.
    pub fn new(field: &'a Heightfield) -> Self {
        GridTraversal { over: FieldRange::new(field), peaks: None }
    }

    /// One that takes long rays over whole tiles, of which `peaks` of the same field knows the heights: the same hits,
    /// sooner.
    pub fn with_peaks(self, peaks: &'a TilePeaks) -> Self {
        GridTraversal { peaks: Some(peaks), ..self }
    }

    /// The field.
    pub fn field(&self) -> &'a Heightfield {
        self.over.field
    }

    /// Lowest and highest height.
    pub fn range(&self) -> (f64, f64) {
        (self.over.lowest, self.over.highest)
    }

    /// Largest number of cells that a ray from height `z` along `d` can cross between the highest and the lowest
    /// height; a level ray is bounded by the field.
    pub fn step_limit(&self, z: f64, d: DVec3) -> u64 {
        self.over.step_limit(z, d)
    }

    /// Follows the ray from `start` along `d` (any length, field coordinates) to its end.
    // Tested by `tests/it/trace/watertight.rs` against a loop over all facets.
    pub fn traverse(&self, start: &SurfacePoint, d: DVec3) -> Outcome {
        self.traverse_counted(start, d, &mut 0)
    }

    /// As `traverse`, and adds the cells that the ray is followed through one by one, the first one included, to `cells`:
    /// all that it meets, where there are no peaks.
    // Tested by `a_ray_crosses_as_many_cells_as_its_rise_over_the_patch_says`.
    #[inline]
    pub fn traverse_counted(&self, start: &SurfacePoint, d: DVec3, cells: &mut u64) -> Outcome {
        let mut way = RayState::new(&self.over, start, d);
        let limit = self.over.step_limit(start.z, d);
        let one_by_one = if self.peaks.is_some() { limit.min(NEAR) } else { limit };
        for _ in 0..one_by_one {
            *cells += 1;
            if let Some(outcome) = way.cross(self.over.field) {
                return outcome;
            }
        }
        self.peaks.map_or(Outcome::Lost, |peaks| tile_traversal::traverse_rest(&self.over, peaks, start, way))
    }
}
