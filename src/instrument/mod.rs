//! 3. The goniometer: where the light stands, and which sensor bins a direction falls into.

pub mod arms;
pub mod bins;
pub mod grid;
pub mod klems;

pub use arms::{direction_in_cone, grid_of};
pub use bins::Sensor;
pub use grid::{Grid, GridKind, Region};
