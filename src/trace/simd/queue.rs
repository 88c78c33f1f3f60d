//! Rays ready for the lanes: scaled, mirrored, and already out of the cell that they start in.
//!
//! All lanes are full here: the first cell, where the own facet is not tested, costs no waiting.

use super::batch::{BatchPart, LANES, RayBatch};
use super::cell::CellCrossing;
use super::hit_buffer::{HitBuffer, LONGEST, RayOutcome};
use super::max_pyramid::MaxPyramid;
use super::ray_lanes::RayLanes;
use crate::lanes::vector::Lanes;

/// Room of the queue: what may be left, what is added, and what a vector writes beyond.
const ROOM: usize = 5 * LANES;
/// |dz| above this many times |dx| + |dy| is not scaled in f32.
const MOST_VERTICAL: f32 = 1e18;

/// A stack of rays, field by field.
pub(crate) struct Queue<'a> {
    batch: &'a RayBatch,
    next: usize,
    len: usize,
    ints: [[i32; ROOM]; 4],
    floats: [[f32; ROOM]; 10],
}

impl<'a> Queue<'a> {
    pub fn new(batch: &'a RayBatch) -> Self {
        Queue { batch, next: 0, len: 0, ints: [[0; ROOM]; 4], floats: [[0.0; ROOM]; 10] }
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Prepares rays until a vector could be refilled twice, or none are left; some end already here.
    #[inline(always)]
    pub fn fill<S: Lanes, const CLOSEST: bool>(&mut self, s: S, field: &MaxPyramid, hits: &mut HitBuffer) {
        if self.len < S::WIDTH {
            while self.next < self.batch.len() && self.len < 3 * S::WIDTH {
                self.prepare::<S, CLOSEST>(s, field, hits);
            }
        }
    }

    /// Moves rays into the `free` lanes; returns the lanes that took one.
    #[inline(always)]
    pub fn take<S: Lanes>(&mut self, rays: &mut RayLanes<S>, s: S, free: u32) -> u32 {
        let mut lanes = free;
        while lanes.count_ones() as usize > self.len {
            lanes &= lanes - 1;
        }
        self.len -= lanes.count_ones() as usize;
        let at = self.len;
        let [ids, starts_x, starts_y, by_x] = &self.ints;
        rays.id = s.expand_i(rays.id, lanes, &ids[at..]);
        rays.start_x = s.expand_i(rays.start_x, lanes, &starts_x[at..]);
        rays.start_y = s.expand_i(rays.start_y, lanes, &starts_y[at..]);
        let by_x = s.expand_i(s.splat_i(0), lanes, &by_x[at..]);
        let [u, v, z, dx, dy, dz, inverse_x, inverse_y, t, end] = &self.floats;
        rays.u = s.expand(rays.u, lanes, &u[at..]);
        rays.v = s.expand(rays.v, lanes, &v[at..]);
        rays.z = s.expand(rays.z, lanes, &z[at..]);
        rays.dx = s.expand(rays.dx, lanes, &dx[at..]);
        rays.dy = s.expand(rays.dy, lanes, &dy[at..]);
        rays.dz = s.expand(rays.dz, lanes, &dz[at..]);
        rays.inverse_x = s.expand(rays.inverse_x, lanes, &inverse_x[at..]);
        rays.inverse_y = s.expand(rays.inverse_y, lanes, &inverse_y[at..]);
        rays.t = s.expand(rays.t, lanes, &t[at..]);
        rays.end = s.expand(rays.end, lanes, &end[at..]);
        let who = s.mask(lanes);
        // A mirrored start is negative; the ray stands one cell from it.
        rays.mirror_x = s.sign(rays.start_x);
        rays.mirror_y = s.sign(rays.start_y);
        rays.x = s.pick_i(who, s.sub_i(rays.start_x, by_x), rays.x);
        rays.y = s.pick_i(who, s.add_i(rays.start_y, s.add_i(by_x, s.splat_i(1))), rays.y);
        rays.by_x = s.or(s.and(who, s.negative(by_x)), s.without(rays.by_x, who));
        lanes
    }

    /// Scales and mirrors the next `WIDTH` rays of the batch and takes them through their first cell.
    #[inline(always)]
    fn prepare<S: Lanes, const CLOSEST: bool>(&mut self, s: S, field: &MaxPyramid, hits: &mut HitBuffer) {
        let (batch, at) = (self.batch, self.next);
        let part = batch.part(at);
        let within = at % LANES;
        let count = S::WIDTH.min(batch.len() - at);
        self.next += count;
        let present = u32::MAX >> (32 - count);
        let d = [s.load(&part.dx[within..]), s.load(&part.dy[within..]), s.load(&part.dz[within..])];
        let length = s.add(s.abs(d[0]), s.abs(d[1]));
        let rises = s.lt(s.mul(length, s.splat(field.steepest)), d[2]);
        let fits = s.lt(s.abs(d[2]), s.mul(length, s.splat(MOST_VERTICAL)));
        let rays = mirrored(s, part, at, d, length, field.highest);
        let cell = CellCrossing::leave(s, &rays, field);
        let walked = present & s.bits(fits) & !s.bits(rises);
        let hit = walked & s.bits(cell.hit_last);
        let ends = walked & !hit & !s.bits(s.lt(cell.exit.t, rays.end));
        // Outcomes are `Escaped` unless said otherwise. A first cell is never too long.
        each(hit, |k| hits.outcomes[at + k] = RayOutcome::Blocked);
        each(present & !s.bits(fits) & !s.bits(rises), |k| hits.outcomes[at + k] = RayOutcome::Beyond);
        if CLOSEST && hit != 0 {
            cell.record(s, &rays, hit, hits);
        }
        self.push(s, walked & !hit & !ends, &rays, &cell);
    }

    #[inline(always)]
    fn push<S: Lanes>(&mut self, s: S, lanes: u32, rays: &RayLanes<S>, cell: &CellCrossing<S>) {
        let at = self.len;
        let by_x = s.pick_i(cell.exit.by_x, s.splat_i(-1), s.splat_i(0));
        let [ids, starts_x, starts_y, entered] = &mut self.ints;
        s.compress_i(&mut ids[at..], lanes, rays.id);
        s.compress_i(&mut starts_x[at..], lanes, rays.start_x);
        s.compress_i(&mut starts_y[at..], lanes, rays.start_y);
        s.compress_i(&mut entered[at..], lanes, by_x);
        let [u, v, z, dx, dy, dz, inverse_x, inverse_y, t, end] = &mut self.floats;
        s.compress(&mut u[at..], lanes, rays.u);
        s.compress(&mut v[at..], lanes, rays.v);
        s.compress(&mut z[at..], lanes, rays.z);
        s.compress(&mut dx[at..], lanes, rays.dx);
        s.compress(&mut dy[at..], lanes, rays.dy);
        s.compress(&mut dz[at..], lanes, rays.dz);
        s.compress(&mut inverse_x[at..], lanes, rays.inverse_x);
        s.compress(&mut inverse_y[at..], lanes, rays.inverse_y);
        s.compress(&mut t[at..], lanes, cell.exit.t);
        s.compress(&mut end[at..], lanes, rays.end);
        self.len += lanes.count_ones() as usize;
    }
}

/// The rays of the batch from `at`, in their own frames, at their starts.
#[inline(always)]
fn mirrored<S: Lanes>(
    s: S,
    part: &BatchPart,
    at: usize,
    d: [S::F; 3],
    length: S::F,
    highest: f32,
) -> RayLanes<S> {
    let within = at % LANES;
    let (zero, one, none) = (s.splat(0.0), s.splat(1.0), s.splat_i(0));
    let all = s.splat_i(-1);
    let scale = s.div(one, length);
    let (backward_x, backward_y) = (s.lt(d[0], zero), s.lt(d[1], zero));
    let mirror_x = s.pick_i(backward_x, all, none);
    let mirror_y = s.pick_i(backward_y, all, none);
    let (u, v) = (s.load(&part.u[within..]), s.load(&part.v[within..]));
    let z = s.load(&part.z[within..]);
    let start_x = s.xor_i(s.load_i(&part.cell_x[within..]), mirror_x);
    let start_y = s.xor_i(s.load_i(&part.cell_y[within..]), mirror_y);
    let (dx, dy) = (s.mul(s.abs(d[0]), scale), s.mul(s.abs(d[1]), scale));
    let dz = s.mul(d[2], scale);
    // A ray along the other axis never crosses: any finite time will do.
    let slowest = s.splat(1e-30);
    let rise = s.sub(s.splat(highest), z);
    let never = s.splat(LONGEST);
    let above = s.pick(s.lt(rise, s.splat(f32::MIN_POSITIVE)), zero, never);
    let level = s.pick(s.lt(dz, zero), never, above);
    let end = s.pick(s.lt(zero, dz), s.min(s.div(rise, dz), never), level);
    let upper = s.negative(s.load_i(&part.upper[within..]));
    let mut ids = [0; LANES];
    for (k, id) in ids.iter_mut().enumerate() {
        *id = (at + k) as i32;
    }
    RayLanes {
        id: s.load_i(&ids),
        start_x,
        start_y,
        x: start_x,
        y: start_y,
        mirror_x,
        mirror_y,
        u: s.pick(backward_x, s.sub(one, u), u),
        v: s.pick(backward_y, s.sub(one, v), v),
        z,
        dx,
        dy,
        dz,
        inverse_x: s.div(one, s.max(slowest, dx)),
        inverse_y: s.div(one, s.max(slowest, dy)),
        t: zero,
        end,
        // Which side of the diagonal: the near or the upper left one in the ray's frame.
        by_x: s.xor(upper, s.xor(s.mask(u32::MAX), backward_x)),
    }
}

/// Calls `visit` for each lane of `lanes`.
#[inline(always)]
fn each(mut lanes: u32, mut visit: impl FnMut(usize)) {
    while lanes != 0 {
        visit(lanes.trailing_zeros() as usize);
        lanes &= lanes - 1;
    }
}
