//! Rays against the two facets of the cells that they are in.

use super::batch::LANES;
use super::hit_buffer::{HitBuffer, LaneHit};
use super::max_pyramid::MaxPyramid;
use super::ray_lanes::{CellExit, RayLanes};
use crate::lanes::vector::Lanes;

/// How rays cross their cells.
///
/// In a ray's frame the diagonal runs across its way (from (1, 0) to (0, 1): it is always crossed) or, where one axis
/// is mirrored, along it (from (0, 0) to (1, 1): crossed where a ray enters and leaves by edges across the same axis).
pub(crate) struct CellCrossing<S: Lanes> {
    /// Where the rays leave the cell.
    pub exit: CellExit<S>,
    /// Below the surface at the diagonal: the facet by which the ray entered is hit.
    pub hit_first: S::M,
    /// Below the surface at the exit: the facet by which it leaves is hit.
    pub hit_last: S::M,
    /// Whether the diagonal runs across the way.
    across: S::M,
    /// Whether the diagonal is crossed, and where.
    crosses: S::M,
    diagonal: S::F,
}

impl<S: Lanes> CellCrossing<S> {
    /// The cells that `rays` are in, entered by their edges.
    #[inline(always)]
    pub fn cross(s: S, rays: &RayLanes<S>, field: &MaxPyramid) -> Self {
        let across = s.xor(s.mask(u32::MAX), s.negative(s.xor_i(rays.mirror_x, rays.mirror_y)));
        let exit = rays.exit(s, s.splat_i(-1));
        let crosses = s.or(across, s.xor(s.mask(u32::MAX), s.xor(rays.by_x, exit.by_x)));
        Self::clearances(s, rays, field, exit, across, crosses)
    }

    /// The cells that rays start in: `rays.by_x` says on which side of the diagonal. The own facet is not tested.
    #[inline(always)]
    pub fn leave(s: S, rays: &RayLanes<S>, field: &MaxPyramid) -> Self {
        let across = s.xor(s.mask(u32::MAX), s.negative(s.xor_i(rays.mirror_x, rays.mirror_y)));
        let exit = rays.exit(s, s.splat_i(-1));
        let along = s.xor(s.mask(u32::MAX), s.xor(rays.by_x, exit.by_x));
        let crosses = s.or(s.and(across, rays.by_x), s.without(along, across));
        let mut cell = Self::clearances(s, rays, field, exit, across, crosses);
        cell.hit_first = s.mask(0);
        cell.hit_last = s.and(cell.hit_last, crosses);
        cell
    }

    #[inline(always)]
    fn clearances(
        s: S,
        rays: &RayLanes<S>,
        field: &MaxPyramid,
        exit: CellExit<S>,
        across: S::M,
        crosses: S::M,
    ) -> Self {
        let (cx, cy) = (s.to_f(s.sub_i(rays.x, rays.start_x)), s.to_f(s.sub_i(rays.y, rays.start_y)));
        // Across its way the diagonal is u + v = 1, along it u = v.
        let one = s.splat(1.0);
        let over = s.pick(across, s.add(rays.u, rays.v), s.sub(rays.u, rays.v));
        let cells = s.pick(across, s.add(s.add(cx, cy), one), s.sub(cx, cy));
        let speed = s.pick(across, s.add(rays.dx, rays.dy), s.sub(rays.dx, rays.dy));
        let t = s.div(s.sub(cells, over), speed);
        // Rounding may put it a little outside, 0/0 nowhere: any point of the way through the cell will do.
        let diagonal = s.pick(s.lt(rays.t, t), s.min(t, exit.t), rays.t);
        let [near, side, far] = Self::corners(s, rays, field, &exit, across);
        // Position along the edge of the exit.
        let (p, d) = (s.pick(exit.by_x, rays.v, rays.u), s.pick(exit.by_x, rays.dy, rays.dx));
        let cell = s.pick(exit.by_x, cy, cx);
        let edge = s.add(p, s.sub(s.mul(exit.t, d), cell));
        let at_exit = s.add(near, s.mul(edge, s.sub(far, near)));
        let (low, high) = (s.pick(across, near, side), s.pick(across, side, far));
        let middle = s.add(p, s.sub(s.mul(diagonal, d), cell));
        let at_diagonal = s.add(low, s.mul(middle, s.sub(high, low)));
        let hit_first = s.and(crosses, s.lt(rays.height(s, diagonal), at_diagonal));
        let hit_last = s.lt(rays.height(s, exit.t), at_exit);
        CellCrossing { exit, hit_first, hit_last, across, crosses, diagonal }
    }

    /// Three corner heights: where the exit's edge begins, the diagonal's other end (across) or the corner behind
    /// (along), and the far corner, where the exit's edge ends.
    #[inline(always)]
    fn corners(s: S, rays: &RayLanes<S>, field: &MaxPyramid, exit: &CellExit<S>, across: S::M) -> [S::F; 3] {
        let row_shift = s.splat_i(field.cells_x.trailing_zeros() as i32);
        let (near_x, far_x) = ends(s, rays.x, rays.mirror_x, field.cells_x);
        let (near_y, far_y) = ends(s, rays.y, rays.mirror_y, field.cells_y);
        let (near_y, far_y) = (s.shl(near_y, row_shift), s.shl(far_y, row_shift));
        let near_at = s.add_i(s.pick_i(exit.by_x, near_y, far_y), s.pick_i(exit.by_x, far_x, near_x));
        let side_y = s.pick_i(s.and(across, exit.by_x), far_y, near_y);
        let side_x = s.pick_i(s.without(across, exit.by_x), far_x, near_x);
        let heights = &field.heights;
        let near = s.gather(heights, near_at);
        let side = s.gather(heights, s.add_i(side_y, side_x));
        [near, side, s.gather(heights, s.add_i(far_y, far_x))]
    }

    /// Notes what the rays of `lanes` hit.
    #[inline(always)]
    pub fn record(&self, s: S, rays: &RayLanes<S>, lanes: u32, hits: &mut HitBuffer) {
        let mirrored_x = s.negative(rays.mirror_x);
        // The side of the diagonal: where it runs across, the first facet is the near one; where it runs along, the
        // facet above it is the one entered across x, and left across y.
        let none = s.mask(0);
        let all = s.xor(none, s.mask(u32::MAX));
        let entered = s.and(self.hit_first, rays.by_x);
        let left = s.without(s.without(all, self.hit_first), self.exit.by_x);
        let near = s.and(self.across, self.hit_first);
        let side = s.or(near, s.without(s.or(entered, left), self.across));
        let upper = s.bits(s.xor(side, s.xor(s.mask(u32::MAX), mirrored_x)));
        let from = s.pick(s.without(self.crosses, self.hit_first), self.diagonal, rays.t);
        let to = s.pick(self.hit_first, self.diagonal, self.exit.t);
        let x = s.sub_i(s.xor_i(rays.x, rays.mirror_x), s.xor_i(rays.start_x, rays.mirror_x));
        let y = s.sub_i(s.xor_i(rays.y, rays.mirror_y), s.xor_i(rays.start_y, rays.mirror_y));
        let mut ints = [[0; LANES]; 3];
        s.store_i(&mut ints[0], rays.id);
        s.store_i(&mut ints[1], x);
        s.store_i(&mut ints[2], y);
        let mut floats = [[0.0; LANES]; 2];
        s.store(&mut floats[0], from);
        s.store(&mut floats[1], to);
        let mut left = lanes;
        while left != 0 {
            let k = left.trailing_zeros() as usize;
            left &= left - 1;
            hits.hits[ints[0][k] as usize] = LaneHit {
                cells_x: ints[1][k],
                cells_y: ints[2][k],
                upper: upper >> k & 1 != 0,
                from: floats[0][k],
                to: floats[1][k],
            };
        }
    }
}

/// The grid lines of a cell that a ray comes to first and last along one axis.
#[inline(always)]
fn ends<S: Lanes>(s: S, at: S::I, mirror: S::I, cells: usize) -> (S::I, S::I) {
    let (at, mask) = (s.xor_i(at, mirror), s.splat_i(cells as i32 - 1));
    let beyond = s.add_i(at, s.splat_i(1));
    (s.and_i(s.sub_i(at, mirror), mask), s.and_i(s.add_i(beyond, mirror), mask))
}
