//! Batches of rays, traced in the lanes of a kernel.

use super::batch::RayBatch;
use super::hit_buffer::HitBuffer;
use super::kernel;
use super::max_pyramid::MaxPyramid;
use crate::lanes::interleaved::Interleaved;
use crate::lanes::vector::Lanes;
use crate::lanes::{Kernel, LaneWork};

impl Kernel {
    /// Whether anything blocks each ray.
    // Tested by `every_kernel_gives_the_same_bits` and against the f64 traversal (tests/it/trace/lanes.rs).
    pub fn any_hit(self, field: &MaxPyramid, rays: &RayBatch, hits: &mut HitBuffer) {
        self.run(Batch::<false> { field, rays, hits });
    }

    /// What each ray meets first.
    // Tested by `every_kernel_gives_the_same_bits` and against the f64 traversal (tests/it/trace/lanes.rs).
    pub fn closest_hit(self, field: &MaxPyramid, rays: &RayBatch, hits: &mut HitBuffer) {
        self.run(Batch::<true> { field, rays, hits });
    }
}

/// One batch; with `CLOSEST`, `hits` gets what the rays hit as well.
struct Batch<'a, const CLOSEST: bool> {
    field: &'a MaxPyramid,
    rays: &'a RayBatch,
    hits: &'a mut HitBuffer,
}

impl<const CLOSEST: bool> LaneWork for Batch<'_, CLOSEST> {
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        if const { L::WIDTH == 1 } {
            kernel::run::<L, CLOSEST>(lanes, self.field, self.rays, self.hits);
        } else {
            kernel::run::<Interleaved<L>, CLOSEST>(Interleaved(lanes), self.field, self.rays, self.hits);
        }
    }
}
