//! 6. The result: the BRDF table, its file and its digest.

pub mod brdf_table;

pub use brdf_table::{BrdfTable, ColourChannels, RealisationPart, Realisations};
