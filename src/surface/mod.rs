//! 2. The explicit microgeometry: heights, facets, the wanted slope law and what a patch really has.

pub mod export;
pub mod heightfield;
pub mod import;
pub mod map_file;

pub use heightfield::Heightfield;
