//! Floats side by side: what the hot loops over rays and over cells are written in, once for vectors of every width.
//!
//! All widths give the same bits: every operation is the IEEE one of a single lane.

pub(crate) mod interleaved;
pub(crate) mod scalar;
pub(crate) mod vector;
#[cfg(target_arch = "x86_64")]
mod x86;

use scalar::One;
use vector::Lanes;

/// Which vectors carry the work. All give the same bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// 16 lanes.
    Avx512,
    /// 8 lanes.
    Avx2,
    /// One at a time.
    Scalar,
}

/// Work that is written over lanes of any number.
pub(crate) trait LaneWork {
    /// Does it; to be inlined, with all that it calls, into a function that has the vectors' features.
    fn run<L: Lanes>(self, lanes: L);
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

    /// Does the work; a kernel that the processor lacks is replaced by the scalar one.
    pub(crate) fn run(self, work: impl LaneWork) {
        #[cfg(target_arch = "x86_64")]
        let work = match self {
            Kernel::Avx512 => x86::run_avx512(work),
            Kernel::Avx2 => x86::run_avx2(work),
            Kernel::Scalar => Some(work),
        };
        #[cfg(not(target_arch = "x86_64"))]
        let work = Some(work);
        if let Some(work) = work {
            work.run(One);
        }
    }
}
