//! The table against theory and against laws. The only place where the two sides meet.

pub mod common_grid;
pub mod compare;
pub(crate) mod counted_bins;
pub mod error_measures;
pub mod expect;
pub mod geometric;
pub mod judgement;
pub mod laws;
pub mod model_distance;
pub mod pairs;
pub mod parts;
pub mod prediction;
mod seen;
pub mod two_tables;
pub mod verdict;
pub mod words;

pub use geometric::GeometricOptics;
pub use judgement::{Judgement, Ruling};
pub use parts::Parts;
pub use prediction::Prediction;
pub use prediction::bin_mean::{BinMean, BinMeans, Estimate, albedo, source_nodes};
pub use prediction::bin_mean_diffuse::diffuse_means;
pub use prediction::bin_mean_through::{ThroughMean, transmittance};
pub use verdict::{Examination, Verdict, examine, examine_against, examine_rows};
