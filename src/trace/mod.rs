//! 4. Light on the surface: where paths start, what they hit, and where they leave.

pub mod path;
pub mod ray;
pub mod sampling;
pub mod simd;
pub mod symmetry;

pub use path::single::{Bounce, Ending, Sample};
pub use path::smith_walk::{SmithWalk, WalkLaw};
pub use path::wavefront::{PathWaves, View, Wave};
pub use ray::grid_traversal::{Facet, Outcome, Place, Walker};
pub use ray::tile_peaks::Peaks;
pub use sampling::areas::{BLOCK, Starts, Window};
pub use sampling::cones::Selection;
pub use sampling::slope_index::FacetIndex;
pub use sampling::slope_order::{BySlope, Together};
pub use simd::batch::LaneRays;
pub use simd::kernel::{Answers, Fate, LONGEST, LaneHit};
pub use simd::lanes::Kernel;
pub use simd::max_pyramid::LaneField;
pub use simd::traversal::{LaneWalker, Waves};
pub use symmetry::Image;
