//! What a shell and a packager need: completions, manual pages, the version in full.

pub mod completions;
pub mod man;
pub mod options;
pub mod version;
