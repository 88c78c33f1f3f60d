//! A sphere of the measured material in a light, as a picture: what a table looks like.
//!
//! Input: a table, a light, a camera. Output: linear radiances, an sRGB picture, or the same scene for Mitsuba. The
//! sphere is convex and alone: what leaves it is one integral of the table's BRDF over the sky at every pixel, which is taken by a
//! rule of fixed directions. No random numbers, so no noise, and the same bytes on any number of threads.

pub mod camera;
mod colours;
pub mod direction_rule;
mod inside;
pub mod light;
pub mod material_sphere;
pub mod mitsuba;
pub mod picture;
pub mod sky;

pub use camera::Camera;
pub use colours::{in_shown_colours, shown_colours};
pub use light::{Light, Lighting};
pub use material_sphere::MaterialSphere;
pub use picture::{Picture, picture};
pub use sky::Sky;
