//! Light on grains: exact hits on half-spheres of the canonical frame, and where paths begin.

pub mod patch;
mod pits;
pub mod point;
pub mod ray;
pub mod starts;
