//! 5. The measurement: surface, instrument and trace put together, block by block.

pub mod arms;
pub mod assemble;
mod block;
mod blocks;
mod checkpoint;
pub mod cost;
mod estimate;
mod ledger;
mod memory_limit;
pub mod optics;
mod pass;
pub mod patches;
pub mod plan;
pub mod record;
mod rounds;
pub mod run;
mod session;
pub mod shards;
pub mod skips;
pub mod slopes;
mod stage;
pub mod stopping;
pub mod tally;
mod ways;
pub mod weighing;

pub use assemble::{Measured, StopResult};
pub use checkpoint::{Checkpoint, Found};
pub use cost::Cost;
pub use ledger::{Kept, Ledger};
pub use patches::{Patch, Patches, Specimen};
pub use plan::{Plan, plan, plan_of};
pub use run::{go_on, measure, tables};
pub use session::Session;
pub use shards::{Shard, Shards};
pub use skips::Skip;
pub use stopping::StoppedBy;
