//! A batch of rays, field by field, as the lanes load them.

use glam::DVec3;

use crate::trace::ray::surface_point::SurfacePoint;

/// Lanes of the widest vector.
pub(crate) const LANES: usize = 32;

/// As many rays as the widest vector has lanes, field by field.
#[derive(Debug, Clone, Default)]
pub(crate) struct BatchPart {
    pub cell_x: [i32; LANES],
    pub cell_y: [i32; LANES],
    /// 0 or -1: the start's facet is the upper one.
    pub upper: [i32; LANES],
    pub u: [f32; LANES],
    pub v: [f32; LANES],
    pub z: [f32; LANES],
    pub dx: [f32; LANES],
    pub dy: [f32; LANES],
    pub dz: [f32; LANES],
}

/// Rays in f32: where each starts, and its direction of any length.
///
/// Answers come in the order of the pushes. Coordinates are relative to the start's cell.
#[derive(Debug, Default)]
pub struct RayBatch {
    len: usize,
    parts: Vec<BatchPart>,
}

impl RayBatch {
    /// Number of rays.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Drops the rays and keeps the memory.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds a ray from `start` along `d` (field coordinates, any length).
    #[inline(always)]
    pub fn push(&mut self, start: &SurfacePoint, d: DVec3) {
        let (part, at) = (self.len / LANES, self.len % LANES);
        if part == self.parts.len() {
            self.parts.push(BatchPart::default());
        }
        let part = &mut self.parts[part];
        part.cell_x[at] = start.facet.x as i32;
        part.cell_y[at] = start.facet.y as i32;
        part.upper[at] = -i32::from(start.facet.upper);
        part.u[at] = start.u as f32;
        part.v[at] = start.v as f32;
        part.z[at] = start.z as f32;
        part.dx[at] = d.x as f32;
        part.dy[at] = d.y as f32;
        part.dz[at] = d.z as f32;
        self.len += 1;
    }

    /// The part that holds ray `index`.
    pub(crate) fn part(&self, index: usize) -> &BatchPart {
        &self.parts[index / LANES]
    }
}
