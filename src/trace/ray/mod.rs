//! One ray at a time, in f64: cell by cell, tile by tile, and along the corridors of a periodic field.

pub(crate) mod corridor;
pub(crate) mod field_range;
pub mod grid_traversal;
pub(crate) mod ray_state;
pub mod surface_point;
pub mod tile_peaks;
pub(crate) mod tile_traversal;
