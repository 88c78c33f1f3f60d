//! The rays that are in the lanes of a vector.

use crate::lanes::vector::Lanes;

/// The rays in the lanes.
pub(crate) struct RayLanes<S: Lanes> {
    /// Place in the batch.
    pub id: S::I,
    /// Cell of the start, and present cell, mirrored and unwrapped.
    pub start_x: S::I,
    pub start_y: S::I,
    pub x: S::I,
    pub y: S::I,
    /// -1 where an axis is mirrored, else 0.
    pub mirror_x: S::I,
    pub mirror_y: S::I,
    /// Start inside its cell, mirrored.
    pub u: S::F,
    pub v: S::F,
    pub z: S::F,
    /// Direction, mirrored: dx, dy >= 0, dx + dy = 1.
    pub dx: S::F,
    pub dy: S::F,
    pub dz: S::F,
    /// 1/dx and 1/dy, finite.
    pub inverse_x: S::F,
    pub inverse_y: S::F,
    /// Ray parameter now, and where the ray is clear of everything (or too long).
    pub t: S::F,
    pub end: S::F,
    /// Whether the present cell was entered by an edge across x.
    pub by_x: S::M,
}

/// Where a ray leaves a cell or tile.
pub(crate) struct CellExit<S: Lanes> {
    /// First cell beyond, along each axis.
    pub x: S::I,
    pub y: S::I,
    pub t: S::F,
    /// Whether it leaves by an edge across x.
    pub by_x: S::M,
}

impl<S: Lanes> RayLanes<S> {
    /// The exit from the tile of 2^shift x 2^shift cells that the ray is in; `tile` is -1 << shift.
    #[inline(always)]
    pub fn exit(&self, s: S, tile: S::I) -> CellExit<S> {
        let x = s.sub_i(s.and_i(self.x, tile), tile);
        let y = s.sub_i(s.and_i(self.y, tile), tile);
        let tx = s.mul(s.sub(s.to_f(s.sub_i(x, self.start_x)), self.u), self.inverse_x);
        let ty = s.mul(s.sub(s.to_f(s.sub_i(y, self.start_y)), self.v), self.inverse_y);
        CellExit { x, y, t: s.min(tx, ty), by_x: s.lt(tx, ty) }
    }

    /// The ray's height at `t`.
    #[inline(always)]
    pub fn height(&self, s: S, t: S::F) -> S::F {
        s.add(self.z, s.mul(self.dz, t))
    }
}
