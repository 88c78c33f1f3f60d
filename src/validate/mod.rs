//! 7. The table against theory and against laws. The only place where the two sides meet.

pub mod aperture;
pub mod bin_mean;
pub mod compare;
mod differences;
pub mod expect;
pub mod gauss_legendre;
pub mod judgement;
pub mod laws;
mod lines;
pub mod model;
pub mod model_distance;
pub mod pairs;
pub mod quadrature;
pub mod schlick_error;
mod seen;
pub mod two_tables;
pub mod verdict;

pub use bin_mean::{BinMean, BinMeans, albedo, source_nodes};
pub use judgement::{Judgement, Ruling};
pub use laws::Parts;
pub use verdict::{Examination, Prediction, Verdict, examine, examine_against, examine_laws, examine_rows};
