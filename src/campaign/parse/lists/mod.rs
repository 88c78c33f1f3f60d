//! Lists of numbers, and which of them make a run each.

pub(crate) mod ranges;
pub(crate) mod run_lists;
