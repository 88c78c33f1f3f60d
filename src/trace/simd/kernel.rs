//! The ray kernel, written once over vectors of any width.
//!
//! A ray is traversed in its own frame: axes mirrored so that it runs towards +x and +y (a mirrored coordinate is
//! !x, which keeps tiles of 4^L cells whole), and its direction scaled to |dx| + |dy| = 1, so that its parameter counts
//! the edges it crosses. It skips a cell or a tile of 4 x 4, 16 x 16, ... cells wherever it stays above the highest
//! corner there; in a cell where it does not, its clearance is looked at where it leaves each facet (`CellCrossing`), as in
//! `GridTraversal`. What happens to a ray depends on that ray alone: lanes that want a facet test wait until enough do, and
//! lanes that are done are refilled from the batch.

use super::batch::{LANES, RayBatch};
use super::cell::CellCrossing;
use super::hit_buffer::{HitBuffer, LONGEST, LaneHit, RayOutcome};
use super::max_pyramid::MaxPyramid;
use super::queue::Queue;
use super::ray_lanes::{CellExit, RayLanes};
use crate::lanes::vector::Lanes;

/// Lanes that must be free before some are refilled, and that must wait before facets are tested, of each 16.
const REFILL: usize = 4;
const POSTPONE: usize = 6;

/// Traverses a batch; see `Kernel::run`.
#[inline(always)]
pub(crate) fn run<S: Lanes, const CLOSEST: bool>(
    s: S,
    field: &MaxPyramid,
    rays: &RayBatch,
    hits: &mut HitBuffer,
) {
    hits.outcomes.clear();
    hits.outcomes.resize(rays.len(), RayOutcome::Escaped);
    if CLOSEST {
        hits.hits.clear();
        hits.hits.resize(rays.len(), LaneHit::default());
    }
    let mut queue = Queue::new(rays);
    let mut walk = Walk::<S>::new(s, field);
    let all = u32::MAX >> (32 - S::WIDTH);
    loop {
        let free = all & !walk.live;
        if free.count_ones() as usize * 16 >= REFILL * S::WIDTH {
            queue.fill::<S, CLOSEST>(s, field, hits);
            if !queue.is_empty() {
                walk.refill(s, &mut queue, free);
            }
            if walk.live == 0 {
                return;
            }
        }
        walk.step(s, field, hits);
        let waiting = walk.waiting;
        let enough = waiting.count_ones() as usize * 16 >= POSTPONE * S::WIDTH || waiting == walk.live;
        if enough && waiting != 0 {
            walk.facets::<CLOSEST>(s, field, hits);
        }
    }
}

/// The lanes of one traversal.
struct Walk<S: Lanes> {
    rays: RayLanes<S>,
    /// 2 x level of the tile that each lane looks at.
    shift: S::I,
    live: u32,
    /// Lanes at a cell whose facets must be tested.
    waiting: u32,
    mask_x: S::I,
    mask_y: S::I,
    row: S::I,
    row_shift: S::I,
    zero: S::F,
    two: S::I,
    /// 2 x the highest level that the lanes look at.
    top: S::I,
    all_ones: S::I,
}

impl<S: Lanes> Walk<S> {
    #[inline(always)]
    fn new(s: S, field: &MaxPyramid) -> Self {
        let (zero, none) = (s.splat(0.0), s.splat_i(0));
        let rays = RayLanes {
            id: none,
            start_x: none,
            start_y: none,
            x: none,
            y: none,
            mirror_x: none,
            mirror_y: none,
            u: zero,
            v: zero,
            z: zero,
            dx: zero,
            dy: zero,
            dz: zero,
            inverse_x: zero,
            inverse_y: zero,
            t: zero,
            end: zero,
            by_x: s.mask(0),
        };
        Walk {
            rays,
            shift: none,
            live: 0,
            waiting: 0,
            mask_x: s.splat_i(field.cells_x as i32 - 1),
            mask_y: s.splat_i(field.cells_y as i32 - 1),
            row: s.splat_i(field.cells_y as i32),
            row_shift: s.splat_i(field.cells_x.trailing_zeros() as i32),
            zero,
            two: s.splat_i(2),
            top: s.splat_i(2 * field.level_of_lanes() as i32),
            all_ones: s.splat_i(-1),
        }
    }

    /// Puts rays of the queue into the `free` lanes.
    #[inline(always)]
    fn refill(&mut self, s: S, queue: &mut Queue, free: u32) {
        let taken = queue.take(&mut self.rays, s, free);
        self.live |= taken;
        self.shift = s.pick_i(s.mask(taken), s.splat_i(0), self.shift);
    }

    /// One step of every lane that does not wait: over a tile that it clears, down a level, or to wait.
    #[inline(always)]
    fn step(&mut self, s: S, field: &MaxPyramid, hits: &mut HitBuffer) {
        let rays = &self.rays;
        let tile = s.shl(self.all_ones, self.shift);
        let exit = rays.exit(s, tile);
        let lowest = s.pick(s.lt(rays.dz, self.zero), exit.t, rays.t);
        let column = s.shr(s.and_i(s.xor_i(rays.x, rays.mirror_x), self.mask_x), self.shift);
        let line = s.or_i(s.and_i(s.xor_i(rays.y, rays.mirror_y), self.mask_y), self.row);
        let index = s.add_i(s.shl(s.shr(line, self.shift), self.row_shift), column);
        let highest = s.gather(&field.maxima, index);
        let clear = s.lt(highest, rays.height(s, lowest));
        let moving = s.mask(self.live & !self.waiting);
        let skips = s.and(moving, clear);
        let blocked = s.without(moving, clear);
        let inner = s.nonzero(self.shift);
        self.waiting |= s.bits(s.without(blocked, inner));
        let down = s.and(blocked, inner);
        self.shift = s.pick_i(down, s.sub_i(self.shift, self.two), self.shift);
        let done = self.advance(s, skips, &exit, tile);
        self.retire_clear(s, done, hits);
    }

    /// Moves the lanes of `who` to `exit`, up a level where they leave a tile of the next; returns those at their end.
    #[inline(always)]
    fn advance(&mut self, s: S, who: S::M, exit: &CellExit<S>, tile: S::I) -> u32 {
        let rays = &mut self.rays;
        // Along the other axis a ray stays within the tile, and never goes back.
        let last_x = s.add_i(exit.x, self.all_ones);
        let last_y = s.add_i(exit.y, self.all_ones);
        let x = s.add_i(s.trunc(s.add(rays.u, s.mul(exit.t, rays.dx))), rays.start_x);
        let y = s.add_i(s.trunc(s.add(rays.v, s.mul(exit.t, rays.dy))), rays.start_y);
        let x = s.pick_i(exit.by_x, exit.x, s.min_i(s.max_i(x, rays.x), last_x));
        let y = s.pick_i(exit.by_x, s.min_i(s.max_i(y, rays.y), last_y), exit.y);
        let changed = s.or_i(s.xor_i(x, rays.x), s.xor_i(y, rays.y));
        let leaves = s.nonzero(s.and_i(changed, s.shl(tile, self.two)));
        let up = s.min_i(s.add_i(self.shift, self.two), self.top);
        self.shift = s.pick_i(s.and(who, leaves), up, self.shift);
        rays.x = s.pick_i(who, x, rays.x);
        rays.y = s.pick_i(who, y, rays.y);
        rays.t = s.pick(who, exit.t, rays.t);
        rays.by_x = s.or(s.and(who, exit.by_x), s.without(rays.by_x, who));
        s.bits(s.without(who, s.lt(exit.t, rays.end)))
    }

    /// Tests the facets of all waiting lanes' cells.
    #[inline(always)]
    fn facets<const CLOSEST: bool>(&mut self, s: S, field: &MaxPyramid, hits: &mut HitBuffer) {
        let cell = CellCrossing::cross(s, &self.rays, field);
        let waiting = s.mask(self.waiting);
        let hit = s.and(waiting, s.or(cell.hit_first, cell.hit_last));
        let bits = s.bits(hit);
        if bits != 0 {
            if CLOSEST {
                cell.record(s, &self.rays, bits, hits);
            }
            self.retire(s, bits, RayOutcome::Blocked, hits);
        }
        let on = s.without(waiting, hit);
        let done = self.advance(s, on, &cell.exit, self.all_ones);
        self.waiting = 0;
        self.retire_clear(s, done, hits);
    }

    /// Ends the lanes of `done`: above everything, or too long.
    #[inline(always)]
    fn retire_clear(&mut self, s: S, done: u32, hits: &mut HitBuffer) {
        // No branch on `done`: most steps end some lane, no pattern says which.
        let beyond = done & !s.bits(s.lt(self.rays.end, s.splat(LONGEST)));
        // Outcomes are `Escaped` unless said otherwise.
        if beyond != 0 {
            self.retire(s, beyond, RayOutcome::Beyond, hits);
        }
        self.live &= !done;
    }

    #[inline(always)]
    fn retire(&mut self, s: S, lanes: u32, outcome: RayOutcome, hits: &mut HitBuffer) {
        let mut ids = [0; LANES];
        s.store_i(&mut ids, self.rays.id);
        let mut left = lanes;
        while left != 0 {
            hits.outcomes[ids[left.trailing_zeros() as usize] as usize] = outcome;
            left &= left - 1;
        }
        self.live &= !lanes;
    }
}
