//! What a facet reflects: Fresnel's formulae. Input: the angle at the facet and the material's constants.
//! Output: reflectance in [0, 1]. Shared by the measuring side and by the theory, and tested by itself.

pub mod fresnel;
pub mod parts;
pub mod reflectance;

pub use fresnel::{FacetAngle, Fresnel, Polarised};
