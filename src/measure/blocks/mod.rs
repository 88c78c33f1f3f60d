//! The blocks of one incidence on one patch: where the arms stand, where samples lie, how paths are followed and end.

pub mod arms;
mod block;
mod endings;
pub(super) mod polarimeter;
mod ray_counts;
pub(super) mod tracer;
mod waves;
