//! Runs on disk: checkpoints, shards, and their merge.

pub(crate) mod band_files;
pub(crate) mod band_run;
pub(crate) mod checkpoint;
pub(crate) mod finished_blocks;
pub(crate) mod header;
pub(crate) mod merge;
pub(crate) mod run_state;
pub mod shard;
