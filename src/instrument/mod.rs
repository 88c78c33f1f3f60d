//! 3. The goniometer: where the light stands, and which sensor bin a direction belongs to.

pub mod grid;

pub use grid::{Grid, GridKind, Region};
