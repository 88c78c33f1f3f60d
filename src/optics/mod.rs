//! What a facet does to light: Fresnel's formulae, refraction, Lambert's law. Input: the angle or the directions at the
//! facet and the material's constants. Output: reflectance in [0, 1], directions. Shared by the measuring side and by the theory, and tested by itself.

pub mod facet;
pub mod fresnel;
pub mod layered;
pub mod mueller;
pub mod parts;
pub mod reflectance;
pub mod wave_limits;

pub use facet::FacetKind;
pub use fresnel::{FacetAngle, Fresnel, Polarised};
