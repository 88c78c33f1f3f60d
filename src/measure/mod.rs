//! The measurement: surface, instrument and trace put together, block by block.

pub mod accumulate;
pub mod blocks;
mod context;
pub mod cost;
pub mod driver;
mod gap_crossings;
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
pub use accumulate::assemble::{IncidenceResult, Measured};
pub use cost::Cost;
pub use driver::{measure, measure_missing, tables};
pub use patches::Patches;
pub use patches::specimen::{Patch, Specimen};
pub use persist::checkpoint::{Checkpoint, FoundCheckpoint};
pub use persist::header::RunHeader;
pub use persist::merge::Merge;
pub use persist::part::{Division, Part};
pub use persist::parts_run::{MeasuredRun, PartsRun};
pub use persist::run_files::{PartFile, ResumableRun, RunFiles};
pub use persist::run_state::{RunState, StoredRun};
pub use persist::shards::Shards;

pub use plan::{Disk, Plan, Saving, StartSampler, incidences, plan, plan_at, plan_of, plan_within, resumed};
pub use prepared_patch::CELLS_PER_START;
pub use session::{Pace, ProcessEnd, Session};
pub use stopping::StoppedBy;
