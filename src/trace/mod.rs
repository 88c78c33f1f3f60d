//! 4. Light on the surface: where paths start, what they hit, and where they leave.

pub mod image;
pub mod path;
pub mod starts;
pub mod walk;

pub use image::Image;
pub use path::{Bounce, Ending, Sample};
pub use starts::{BLOCK, Starts, Window};
pub use walk::{Facet, Outcome, Place, Walker};
