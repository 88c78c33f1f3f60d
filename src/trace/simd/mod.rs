//! Many rays at once, in the f32 lanes of a vector.

pub mod batch;
pub(crate) mod cell;
pub mod dispatch;
pub mod hit_buffer;
pub(crate) mod kernel;
pub mod max_pyramid;
pub(crate) mod queue;
pub(crate) mod ray_lanes;
pub mod traversal;
