//! 2. The explicit microgeometry: heights, facets, the wanted slope law and what a patch really has.

pub mod certificate;
pub mod export;
mod feedback;
pub mod heightfield;
pub mod import;
pub mod map_file;
mod map_gsf;
mod map_matrix;
mod map_text;
mod map_xyz;
pub mod outliers;
mod ranks;
pub mod refine;
mod remap;
pub mod slope_law;
mod spectrum;
pub mod synthesis;
mod units;

pub use certificate::{Certificate, SlopeCounts};
pub use heightfield::Heightfield;
pub use slope_law::SlopeLaw;
pub use synthesis::{Spectrum, Synthesiser};
