//! The analytic answer: microfacet theory on paper, sharing no code with the measuring side.
//!
//! Input: roughness and a pair of directions. Output: D, Lambda, G1, G2 and the BRDF in 1/sr, without cosine.
//! Of clear surfaces also the BTDF, of matt facets their BRDF of order 1.
//! Papers: Walter et al. 2007 (D, BTDF), Heitz 2014 (masking), Heitz et al. 2016 (masking of opposite sides), Torrance
//! and Sparrow 1967 (grooves); the classical models that `fit` holds against them in `empirical` and `cavities`.

pub mod beta;
pub mod cavities;
pub mod diffuse;
pub mod empirical;
pub mod gauss_legendre;
pub mod grains;
pub mod lambda;
pub mod microfacet;
pub mod ndf;
pub mod smith;
pub mod student;
pub mod transmission;
pub mod v_cavity;

pub use microfacet::Microfacet;
pub use ndf::Ndf;
pub use smith::{ArmSide, Masking};
pub use v_cavity::{GrooveLobe, v_groove_lobes};
