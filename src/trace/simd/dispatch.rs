//! Which vectors carry the rays: AVX-512, AVX2, or one ray at a time.

use super::batch::RayBatch;
use super::hit_buffer::HitBuffer;
use super::kernel;
use super::max_pyramid::MaxPyramid;
use super::scalar::One;
#[cfg(target_arch = "x86_64")]
use super::x86;

/// Which vectors carry the rays. All give the same hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// 16 lanes.
    Avx512,
    /// 8 lanes.
    Avx2,
    /// One ray at a time.
    Scalar,
}

impl Kernel {
    /// All kernels, the widest first.
    pub const ALL: [Kernel; 3] = [Kernel::Avx512, Kernel::Avx2, Kernel::Scalar];

    /// The widest kernel that this processor runs.
    pub fn widest() -> Self {
        Self::ALL.into_iter().find(|kernel| kernel.available()).unwrap_or(Kernel::Scalar)
    }

    /// Whether this processor runs it.
    pub fn available(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx512 => x86::has_avx512(),
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx2 => x86::has_avx2(),
            Kernel::Scalar => true,
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Kernel::Avx512 => "avx512",
            Kernel::Avx2 => "avx2",
            Kernel::Scalar => "scalar",
        }
    }

    /// Whether anything blocks each ray.
    // Tested by `every_kernel_gives_the_same_bits` and against the f64 traversal (tests/it/trace/lanes.rs).
    pub fn any_hit(self, field: &MaxPyramid, rays: &RayBatch, hits: &mut HitBuffer) {
        self.run::<false>(field, rays, hits);
    }

    /// What each ray meets first.
    // Tested by `every_kernel_gives_the_same_bits` and against the f64 traversal (tests/it/trace/lanes.rs).
    pub fn closest_hit(self, field: &MaxPyramid, rays: &RayBatch, hits: &mut HitBuffer) {
        self.run::<true>(field, rays, hits);
    }

    /// Runs the kernel over `rays`; with `CLOSEST`, `hits` gets what they hit as well. A kernel that the processor
    /// lacks is replaced by the scalar one.
    fn run<const CLOSEST: bool>(self, field: &MaxPyramid, rays: &RayBatch, hits: &mut HitBuffer) {
        #[cfg(target_arch = "x86_64")]
        match self {
            Kernel::Avx512 if x86::run_avx512::<CLOSEST>(field, rays, hits) => return,
            Kernel::Avx2 if x86::run_avx2::<CLOSEST>(field, rays, hits) => return,
            _ => {}
        }
        kernel::run::<One, CLOSEST>(One, field, rays, hits);
    }
}
