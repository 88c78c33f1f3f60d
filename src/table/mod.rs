//! The result: the BRDF table, its file and its digest.

pub mod brdf_table;
mod channels;
mod content_digest;
pub mod gaps;
mod grid_attribute;
mod halves;
pub mod header;
pub mod realisations;
pub mod recolour;
pub mod rows;
pub mod store;
#[cfg(test)]
mod test_tables;
pub mod writer;

pub use brdf_table::{BrdfTable, ColourChannels, RealisationPart, Realisations, SchlickSums};
pub use channels::MUELLER_ELEMENTS;
pub(crate) use channels::{Plane, planes};
pub use grid_attribute::check_grid;
pub use rows::TableRows;
pub use writer::TableWriter;
