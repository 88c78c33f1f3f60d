//! 5. The measurement: surface, instrument and trace put together, block by block.

pub mod arms;
pub mod assemble;
mod block;
pub mod cost;
mod estimate;
pub mod optics;
pub mod patches;
pub mod plan;
mod rounds;
pub mod run;
pub mod skips;
pub mod slopes;
mod stage;
pub mod stopping;
pub mod tally;
mod ways;

pub use assemble::{Measured, StopResult};
pub use cost::Cost;
pub use patches::{Patch, Patches, Specimen};
pub use plan::{Plan, plan};
pub use run::measure;
pub use skips::Skip;
pub use stopping::StoppedBy;
