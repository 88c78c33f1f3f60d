//! What a campaign needs, and what it skips: decided here, once, before anything is allocated.

mod decide;
mod decisions;
mod disk;
mod estimate;
mod savings;
mod start_sampler;

pub(crate) use decide::{KEPT_FRACTION, at_once, merged};
pub use decide::{incidences, plan, plan_at, plan_of, plan_within, resumed};
pub use decisions::{Plan, Saving};
pub use disk::Disk;
pub use start_sampler::{Apertures, StartSampler};
