//! 4. Light on the surface: where paths start, what they hit, and where they leave.

pub mod image;
pub mod path;
pub mod smith_walk;
pub mod starts;
pub mod sweep;
pub mod walk;

pub use image::Image;
pub use path::{Bounce, Ending, Sample};
pub use smith_walk::SmithWalk;
pub use starts::{BLOCK, Starts, Window};
pub use sweep::{Layout, Sweep};
pub use walk::{Facet, Outcome, Place, Walker};
