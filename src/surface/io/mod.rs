//! Height maps as files: measured ones read, prepared and checked, patches written.

pub(crate) mod checks;
pub mod export;
pub mod glb;
pub mod import;
pub mod map_file;
pub mod prepare;
pub(crate) mod readers;
pub mod samples;
