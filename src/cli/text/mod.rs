//! What the commands print.

pub(crate) mod certificate;
pub mod lobes;
pub(crate) mod optics;
pub(crate) mod output;
pub(crate) mod plan;
pub(crate) mod progress;
pub(crate) mod resolution;
pub(crate) mod study;
pub(crate) mod verdict;
