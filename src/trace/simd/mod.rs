//! Many rays at once, in the f32 lanes of a vector.

pub mod batch;
pub(crate) mod cell;
pub(crate) mod interleaved;
pub mod kernel;
pub mod lanes;
pub mod max_pyramid;
pub(crate) mod queue;
pub mod traversal;
pub(crate) mod vector;
