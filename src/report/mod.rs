//! 9. What a measurement says to its reader.

pub mod summary;
