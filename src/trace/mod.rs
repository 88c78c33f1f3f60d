//! 4. Light on the surface: where paths start, what they hit, and where they leave.

pub mod by_slope;
pub mod facet_index;
pub mod from_above;
pub mod image;
mod lane_cell;
pub mod lane_field;
pub mod lane_kernel;
mod lane_pair;
mod lane_queue;
pub mod lane_rays;
pub mod lanes;
pub mod path;
pub mod selection;
pub mod smith_walk;
pub mod starts;
pub mod sweep;
mod vectors;
pub mod walk;
pub mod wave_paths;
pub mod waves;

pub use by_slope::BySlope;
pub use facet_index::FacetIndex;
pub use from_above::FromAbove;
pub use image::Image;
pub use lane_field::LaneField;
pub use lane_kernel::{Answers, Fate, LONGEST, LaneHit};
pub use lane_rays::LaneRays;
pub use lanes::Kernel;
pub use path::{Bounce, Ending, Sample};
pub use selection::Selection;
pub use smith_walk::{SmithWalk, WalkLaw};
pub use starts::{BLOCK, Starts, Window};
pub use sweep::{Layout, Sweep};
pub use walk::{Facet, Outcome, Place, Walker};
pub use wave_paths::{PathWaves, Wave};
pub use waves::{LaneWalker, Waves};
