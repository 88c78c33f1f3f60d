//! 3. The goniometer: where the light stands, and which sensor bins a direction falls into.

pub mod angle_text;
pub mod arms;
pub mod bins;
pub mod grid;
pub mod klems;

pub use angle_text::{StopAngles, angle_decimals};
pub use arms::{direction_in_cone, grid_of};
pub use bins::Sensor;
pub use grid::{Grid, GridKind, Region};
