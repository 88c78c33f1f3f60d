//! 6. The result: the BRDF table, its file and its digest.

pub mod brdf_table;
mod channels;
pub mod realisations;
pub mod store;
#[cfg(test)]
mod test_tables;

pub use brdf_table::{BrdfTable, ColourChannels, RealisationPart, Realisations};
pub use channels::check_grid;
