//! The measurement: surface, instrument and trace put together, block by block.

pub mod accumulate;
mod block;
pub mod block_arms;
mod block_tracer;
pub mod cost;
pub mod driver;
pub mod optics;
mod pass;
pub mod patches;
pub mod persist;
pub mod plan;
mod prepared_patch;
mod rounds;
mod session;
pub mod stopping;

pub use crate::files::memory::memory_limit;
pub use accumulate::assemble::{Measured, StopResult};
pub use cost::Cost;
pub use driver::{go_on, measure, tables};
pub use patches::{Patch, Patches, Specimen};
pub use persist::band_files::BandFiles;
pub use persist::band_run::{BandRun, FinishedBands};
pub use persist::checkpoint::{Checkpoint, FoundCheckpoint};
pub use persist::header::RunHeader;
pub use persist::merge::Merge;
pub use persist::run_state::{RunState, StoredRun};
pub use persist::shard::{Shard, Shards};
pub use plan::bands::{Band, plan_in_bands};
pub use plan::disk::Disk;
pub use plan::savings::Saving;
pub use plan::start_sampler::StartSampler;
pub use plan::{Plan, plan, plan_of, plan_within, stops};
pub use prepared_patch::CELLS_PER_START;
pub use session::{Pace, ProcessEnd, Session};
pub use stopping::StoppedBy;
