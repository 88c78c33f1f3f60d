//! Light on the surface: where paths begin, what they hit, and where they leave.

pub mod grains;
pub mod path;
pub mod ray;
pub mod sampling;
pub mod simd;
pub mod symmetry;

pub use crate::lanes::Kernel;
pub use grains::patch::TracedGrains;
pub use grains::point::GrainPoint;
pub use grains::starts::{GrainSampler, RaysFromAbove};
pub(crate) use path::scatter::upside_down_if;
pub use path::scatter::{Mirrors, Onward, PathEnd, Scatter, SplitEnd};
pub use path::single::{Traced, TracedPatch};
pub use path::smith_walk::SmithWalk;
pub use path::wavefront::{PathWaves, View, Wave};
pub use ray::grid_traversal::GridTraversal;
pub use ray::surface_point::{Facet, Outcome, SurfacePoint};
pub use ray::tile_peaks::TilePeaks;
pub use sampling::areas::{AreaSampler, BLOCK, Window};
pub use sampling::batched_starts::BatchedStarts;
pub use sampling::cones::ConeSampler;
pub use sampling::slope_index::SlopeIndex;
pub use sampling::slope_order::SlopeSampler;
pub use simd::batch::RayBatch;
pub use simd::hit_buffer::{HitBuffer, LONGEST, LaneHit, RayOutcome};
pub use simd::max_pyramid::MaxPyramid;
pub use simd::traversal::{SimdTraversal, Waves};
pub use symmetry::PatchSymmetry;
