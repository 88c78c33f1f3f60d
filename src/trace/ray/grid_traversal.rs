//! The plain cell walk in f64: exact order, watertight, no epsilon. The reference for every faster kernel.
//!
//! A ray is followed from cell to cell. In a cell it crosses at most two facets, and which ones follows from the
//! edges by which it enters and leaves, without arithmetic. The clearance (ray height minus surface height) is
//! linear over a facet, so a facet is hit if and only if the clearance is negative where the ray leaves it; the
//! clearance on an edge is computed once and counts for both sides, so that no ray slips through a seam.
//! Coordinates are relative to the present cell; cells are integers.

use glam::DVec3;

use super::ray_state::RayState;
use super::tile_peaks::TilePeaks;
use super::tile_traversal;
use crate::surface::Heightfield;

/// One facet of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Facet {
    /// Column of the cell.
    pub x: usize,
    /// Row of the cell.
    pub y: usize,
    /// The facet with corner (x+1, y+1), else the one with corner (x, y).
    pub upper: bool,
}

/// A point on a facet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// The facet, never tested by rays that start here: a plane cannot be hit twice.
    pub facet: Facet,
    /// Along x inside the cell, [0, 1].
    pub u: f64,
    /// Along y inside the cell, [0, 1].
    pub v: f64,
    /// Height.
    pub z: f64,
}

impl SurfacePoint {
    /// The point (u, v) of a facet, its height from the facet's plane.
    pub fn on(field: &Heightfield, facet: Facet, u: f64, v: f64) -> Self {
        let c = field.corners(facet.x, facet.y);
        let z = if facet.upper {
            c.h11 + (1.0 - u) * (c.h01 - c.h11) + (1.0 - v) * (c.h10 - c.h11)
        } else {
            c.h00 + u * (c.h10 - c.h00) + v * (c.h01 - c.h00)
        };
        SurfacePoint { facet, u, v, z }
    }
}

/// Where a ray ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome {
    /// Above every height: it hits nothing any more.
    Escaped,
    /// On a facet, from above.
    Hit(SurfacePoint),
    /// Over the edge of a field that does not continue itself.
    LeftMap,
    /// After more steps than its slope allows: a fault of the program, counted and reported.
    Lost,
}

/// Walks rays over one field.
#[derive(Debug, Clone, Copy)]
pub struct GridTraversal<'a> {
    field: &'a Heightfield,
    lowest: f64,
    highest: f64,
    peaks: Option<&'a TilePeaks>,
}

/// Cells that a ray is followed through one by one before whole tiles are asked for: most rays end within them.
const NEAR: u64 = 64;

impl<'a> GridTraversal<'a> {
    /// A traversal over `field`.
    pub fn new(field: &'a Heightfield) -> Self {
        let (lowest, highest) = field.range();
        GridTraversal { field, lowest, highest, peaks: None }
    }

    /// One that takes long rays over whole tiles, of which `peaks` of the same field knows the heights: the same hits,
    /// sooner.
    pub fn with_peaks(self, peaks: &'a TilePeaks) -> Self {
        GridTraversal { peaks: Some(peaks), ..self }
    }

    /// The field.
    pub fn field(&self) -> &'a Heightfield {
        self.field
    }

    /// Lowest and highest height.
    pub fn range(&self) -> (f64, f64) {
        (self.lowest, self.highest)
    }

    /// Follows the ray from `start` along `d` (any length, field coordinates) to its end.
    ///
    /// Held by: `tests/it/trace/watertight.rs` against a loop over all facets.
    pub fn traverse(&self, start: &SurfacePoint, d: DVec3) -> Outcome {
        self.traverse_counted(start, d, &mut 0)
    }

    /// As `walk`, and adds the cells that the ray is followed through one by one, the first one included, to `cells`:
    /// all that it meets, where there are no peaks.
    ///
    /// Held by: `a_ray_crosses_as_many_cells_as_its_rise_over_the_patch_says`.
    #[inline]
    pub fn traverse_counted(&self, start: &SurfacePoint, d: DVec3, cells: &mut u64) -> Outcome {
        let mut way = RayState::new(self, start, d);
        let limit = self.step_limit(start.z, d);
        let one_by_one = if self.peaks.is_some() { limit.min(NEAR) } else { limit };
        for _ in 0..one_by_one {
            *cells += 1;
            if let Some(outcome) = way.cross(self.field) {
                return outcome;
            }
        }
        self.peaks.map_or(Outcome::Lost, |peaks| tile_traversal::go_on(self, peaks, start, way))
    }

    /// Ray parameter from which the ray is above every height.
    pub(crate) fn clear_at(&self, z: f64, dz: f64) -> f64 {
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
