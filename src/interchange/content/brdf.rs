//! A BRDF as a function of two directions: what a foreign file is that has no incidences and bins of its own.

use glam::DVec3;

/// Values of one pair of directions by colour; a table of one colour uses the first.
pub type Colour = [f64; 3];

/// A BRDF that answers for any pair of directions.
pub trait Brdf: Sync {
    /// 1 or 3.
    fn colours(&self) -> usize;

    /// f(wi, wo) in 1/sr without cosine, unit vectors above the horizon of the sample's frame.
    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour;
}
