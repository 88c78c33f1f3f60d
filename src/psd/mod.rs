//! Power spectral densities of rough surfaces: what is asked for, and what a periodic patch of cells can hold of it.
//!
//! Input: a model with its numbers, cells and pitch. Output: the density at a spatial frequency, um^4, and the moments that
//! the patches made from it have in the mean.
//!
//! Convention: S(f) is the areal density over all spatial frequencies of both signs (waves for each um, not radians),
//! isotropic, so that the variance of the heights is the integral of S over the plane, 2 pi times that of f S(f). A profile
//! has the one-sided density S1(f), f >= 0, whose integral is the same variance.

pub mod model;
pub mod moments;
pub mod table;

pub use model::{Psd, PsdModel};
pub use moments::PsdMoments;
pub use table::{PsdKind, PsdTable};
