//! The explicit microgeometry: heights, facets, the wanted slope law, and the measured properties of a patch.

pub mod areal;
pub mod certificate;
pub mod grains;
pub mod heightfield;
pub mod io;
pub mod lengths;
pub mod synthesis;
pub(crate) mod transpose;

pub use certificate::{Certificate, SlopeCounts};
pub use heightfield::Heightfield;
pub use lengths::SurfaceLengths;
pub use synthesis::Synthesiser;
pub use synthesis::slope_law::SlopeLaw;
