//! 2. The explicit microgeometry: heights, facets, the wanted slope law and what a patch really has.

pub mod heightfield;

pub use heightfield::Heightfield;
