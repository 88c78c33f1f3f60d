//! Runs on disk: checkpoints, the files of finished parts, and their merge.

pub(crate) mod checkpoint;
pub(crate) mod finished_blocks;
pub mod header;
pub(crate) mod merge;
pub mod part;
pub(crate) mod parts_run;
pub(crate) mod run_files;
pub(crate) mod run_state;
pub mod shards;
