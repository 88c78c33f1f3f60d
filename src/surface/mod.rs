//! The explicit microgeometry: heights, facets, the wanted slope law and what a patch really has.

pub mod certificate;
pub mod heightfield;
pub mod io;
pub mod synthesis;

pub use certificate::{Certificate, SlopeCounts};
pub use heightfield::Heightfield;
pub use synthesis::slope_law::SlopeLaw;
pub use synthesis::{Spectrum, Synthesiser};
