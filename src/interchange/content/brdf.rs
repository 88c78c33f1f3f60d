//! A BRDF as a function of two directions: what a foreign file is that has no incidences and bins of its own; and of the
//! light that has gone through, which formats see in the horizon's mirror.

use glam::DVec3;

/// Values of one pair of directions by colour; a table of one colour uses the first.
pub type Colour = [f64; 3];

/// A BRDF that answers for any pair of directions.
pub trait Brdf: Sync {
    /// 1 or 3.
    fn colours(&self) -> usize;

    /// f(wi, wo) in 1/sr without cosine, unit vectors of the sample's frame: wi above the horizon, wo on one of `sides`.
    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour;

    /// Whether it knows the light that comes back, wo above the horizon; and that which has gone through, wo below.
    fn sides(&self) -> [bool; 2] {
        [true, false]
    }
}

/// What light does that stays on its side of the surface: in messages.
pub const COMES_BACK: &str = "comes back";
/// What light does that leaves it.
pub const GONE_THROUGH: &str = "has gone through the surface";

/// A direction as a mirror in the horizon shows it.
pub fn in_mirror(w: DVec3) -> DVec3 {
    DVec3 { z: -w.z, ..w }
}

/// Two functions of directions above the horizon: of light that comes back, and of light that has gone through, as a
/// mirror in the horizon shows it. One may be missing.
// Tested by `both_sides_are_put_together` (tests/it/interchange/through.rs).
pub struct TwoSided(pub [Option<Box<dyn Brdf>>; 2]);

impl Brdf for TwoSided {
    fn colours(&self) -> usize {
        self.0.iter().flatten().map(|half| half.colours()).max().unwrap_or(1)
    }

    fn brdf(&self, wi: DVec3, wo: DVec3) -> Colour {
        let (half, wo) = if wo.z < 0.0 { (&self.0[1], in_mirror(wo)) } else { (&self.0[0], wo) };
        half.as_ref().map_or([0.0; 3], |half| half.brdf(wi, wo))
    }

    fn sides(&self) -> [bool; 2] {
        self.0.each_ref().map(Option::is_some)
    }
}
