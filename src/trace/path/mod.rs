//! Paths: from a surface sample over their bounces to their end.

pub mod scatter;
pub mod single;
pub mod smith_walk;
pub mod wavefront;
