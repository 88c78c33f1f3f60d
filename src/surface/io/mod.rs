//! Height maps as files: measured ones read, refined and checked, patches written.

pub(crate) mod checks;
pub mod export;
pub(crate) mod gsf;
pub mod import;
pub mod map_file;
pub mod outliers;
pub mod refine;
pub mod samples;
pub(crate) mod spline;
pub(crate) mod text;
pub(crate) mod units;
