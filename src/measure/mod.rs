//! 5. The measurement: surface, instrument and trace put together, block by block.

pub mod arms;
pub mod assemble;
pub mod bands;
mod block;
pub mod cost;
mod estimate;
mod memory_limit;
pub mod optics;
pub mod patches;
pub mod plan;
pub mod record;
mod rounds;
pub mod run;
pub mod skips;
pub mod slopes;
mod stage;
pub mod stopping;
pub mod tally;
mod ways;
pub mod weighing;

pub use assemble::{Measured, StopResult};
pub use cost::Cost;
pub use memory_limit::memory_limit;
pub use patches::{Patch, Patches, Specimen};
pub use plan::{Plan, plan, plan_within};
pub use run::measure;
pub use skips::Skip;
pub use stopping::StoppedBy;
