//! 6. The result: the BRDF table, its file and its digest.

pub mod brdf_table;
mod channels;
pub mod realisations;
pub mod recolour;
pub mod store;
#[cfg(test)]
mod test_tables;

pub use brdf_table::{BrdfTable, ColourChannels, RealisationPart, Realisations, SchlickSums};
pub use channels::check_grid;
